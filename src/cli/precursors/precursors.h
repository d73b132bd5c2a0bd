/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "precursor/precursor.h"

/// What precursors are looked for in: a monitoring file or a run.
typedef struct cli_watched {
    lac_forecast_outcome of;                ///< as far as the input says it; its series is owned
    bool run;                               ///< the file of a run
    double *time, *displacement, *velocity; ///< owned; of a run
    lac_readings readings;                  ///< up to --until
    double start;                           ///< of a run's clock on the series' [s]
} cli_watched;

/// Reads it, and --until and --failed-at.
/// @param known  a case that names its columns where the options do not; NULL
/// @return LAC_OK; LAC_EINPUT; LAC_EIO; LAC_ENOMEM
lac_status cli_watched_read(const cli_request *request, const lac_case *known,
                            const lac_units *units, cli_watched *out, lac_error *err);
void cli_watched_clear(cli_watched *watched);

/// As lac_outcome_time has it; from one time to another.
cli_text cli_watched_time(const lac_forecast_outcome *of, double t);
cli_text cli_watched_span(const lac_forecast_outcome *of, double begin, double end);

/// The rest of what the options say.
typedef struct cli_forecast_plan {
    lac_forecast_def def;
    size_t issues;
} cli_forecast_plan;
lac_status cli_forecast_plan_read(const cli_request *request, bool dated, const lac_units *units,
                                  cli_forecast_plan *plan, lac_error *err);

/// Does what `lacuna precursors --rolling` does of its argument, to a file alone: prints no result.
/// @param output  instead of the request's
lac_status cli_precursors_file(const cli_request *request, const char *output, lac_error *err);

void cli_precursors_print(const lac_forecast_outcome *outcome, bool verbose);

/// The drivers that --driver names, read.
typedef struct cli_drivers {
    size_t n;
    lac_driver driver[LAC_DRIVERS_MAX]; ///< point into what follows
    lac_series *series[LAC_DRIVERS_MAX];
    char *text[LAC_DRIVERS_MAX]; ///< copies that names point into
} cli_drivers;

/// Reads them: columns of the readings' file, or of files of their own.
/// @return LAC_OK; LAC_EINPUT; LAC_EIO; LAC_ENOMEM
lac_status cli_drivers_read(const cli_request *request, const lac_case *known,
                            const cli_watched *watched, const lac_units *units, cli_drivers *out,
                            lac_error *err);
void cli_drivers_clear(cli_drivers *drivers);

/// What they explain, a line each.
void cli_drivers_print(const lac_forecast_set *forecasts);
