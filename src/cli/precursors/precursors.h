/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_PRECURSORS_PRECURSORS_H
#define LACUNA_CLI_PRECURSORS_PRECURSORS_H

#include "cli/precursors/series.h"
#include "data/json.h"
#include "fit/foresee.h"
#include "forecast/hindcast.h"
#include "precursor/precursor.h"
#include "store/store_file.h"

/// What precursors are looked for in: a monitoring file or a run.
typedef struct cli_watched {
    const char *path;
    bool run;                               ///< the file of a run
    bool dated;                             ///< times are seconds since 1970 UTC
    lac_series *series;                     ///< owned; NULL: a run
    double *time, *displacement, *velocity; ///< owned; of a run
    lac_readings readings;                  ///< up to --until
    double start;                           ///< of a run's clock on the series' [s]
    double failed_at;                       ///< [s]; NaN: not known; INFINITY: never
} cli_watched;

/// Reads it, and --until and --failed-at.
/// @return LAC_OK; LAC_EINPUT; LAC_EIO; LAC_ENOMEM
lac_status cli_watched_read(const cli_request *request, const lac_units *units, cli_watched *out,
                            lac_error *err);
void cli_watched_clear(cli_watched *watched);

/// A time of its clock: "2015-07-05 09:54", or a number in the unit that the file counts in, of a
/// run in the unit that reads best; "-" where there is none.
/// @return text
const char *cli_watched_time(const cli_watched *watched, double t, char *text, size_t size);

/// Whether the file is a run's, and no column is asked of it.
bool cli_watched_is_run(const cli_request *request);

/// The case that forecasts; all NULL: none was given.
typedef struct cli_foreseer {
    lac_case *source; ///< owned
    lac_fit_watch watch;
    lac_foresight how;
    lac_forecast_model model;
    cli_request named; ///< the request, columns that it does not name being the case's
    char *words[3];    ///< owned, of those
} cli_foreseer;

/// Reads --case, checks it, and names the series' columns where the options do not.
/// @return LAC_OK, also without --case; LAC_EINPUT; LAC_EIO; LAC_ENOMEM
lac_status cli_foreseer_read(const cli_request *request, cli_foreseer *out, lac_error *err);
void cli_foreseer_clear(cli_foreseer *foreseer);

/// The rest of what the options say.
typedef struct cli_forecast_plan {
    lac_forecast_def def;
    size_t issues;
    double horizon; ///< [s]
} cli_forecast_plan;
lac_status cli_forecast_plan_read(const cli_request *request, bool dated, const lac_units *units,
                                  cli_forecast_plan *plan, lac_error *err);

/// What was found.
typedef struct cli_precursors_result {
    const cli_watched *watched;
    const cli_forecast_plan *plan;
    const lac_outlook *outlook;
    size_t indicators;
    const lac_precursor *indicator;     ///< [indicators] at the last reading
    const lac_rolling *rolling;         ///< NULL: not asked for
    const lac_precursor_course *course; ///< at the same times; NULL as well
    const lac_skill *skill;             ///< [methods]; NULL: no time of failure
    const char *output;                 ///< NULL: none
} cli_precursors_result;

void cli_precursors_print(const cli_precursors_result *r, bool verbose);
void cli_precursors_json(const cli_precursors_result *r);

/// What a source holds besides its motion: of a run its events and cells.
typedef struct cli_cells {
    lac_stored_values event_time, event_duration, event_moment; ///< the second turns into ends
    lac_stored_values time, n_slip, n_tot, length, critical;
    lac_event_list events;
    lac_slip_history slip;
    lac_evidence evidence; ///< of the two above; points into this
} cli_cells;

/// Reads it. Where it ends is cut off at each time of issue.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status cli_cells_read(const cli_watched *watched, cli_cells *out, lac_error *err);
void cli_cells_clear(cli_cells *cells);

void cli_indicators_print(size_t count, const lac_precursor *indicator);
void cli_indicators_json(lac_json *json, size_t count, const lac_precursor *indicator);

/// One number of each indicator at each time of issue at which any has one.
void cli_course_print(const cli_precursors_result *r);

#endif
