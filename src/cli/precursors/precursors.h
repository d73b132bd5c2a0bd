/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_PRECURSORS_PRECURSORS_H
#define LACUNA_CLI_PRECURSORS_PRECURSORS_H

#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "fit/foresee.h"
#include "forecast/hindcast.h"
#include "precursor/precursor.h"

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
cli_text cli_watched_time(const cli_watched *watched, double t);

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

void cli_precursors_print(const lac_forecast_outcome *outcome, const cli_watched *watched,
                          bool verbose);

#endif
