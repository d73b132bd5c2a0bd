/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FORECAST_H
#define LACUNA_FORECAST_H

#include <math.h>

#include "lacuna/case.h"
#include "lacuna/dataset.h"
#include "lacuna/series.h"

LAC_BEGIN_C

/// How forecasts are made; from lac_forecast_options_default. Times are on the series' clock.
typedef struct lac_forecast_options {
    size_t size; ///< of this structure, as the default has it
    lac_smoothing smoothing;
    size_t points, order;
    double window;              ///< [s]
    bool raw;                   ///< keep outliers and resets as they are
    double since;               ///< start of what is fitted, accelerating or not [s]; NaN: the
                                ///< onset of acceleration
    double until;               ///< nothing later is looked at [s]
    size_t short_run, long_run; ///< velocities in the means that tell the onset; 0: the trend's
                                ///< test tells it, which knows the noise
    size_t issues;              ///< forecasts as of so many readings, at most; 0: of the last one
    double failed_at;           ///< when it failed [s]; NaN: not known; INFINITY: never
    const lac_case *source;     ///< one more method: the slope's own model, read with LAC_FOR_FIT;
                                ///< outlives the dataset; NULL: none
    int threads;                ///< of that one; 0: 1
    /// Asked before each issue time; false: ends here. NULL: never asked.
    bool (*go_on)(void *context, size_t done, size_t all);
    void *context;
    const char *levels; ///< file of thresholds of the level, as `lacuna describe levels` prints the
                        ///< default; NULL: the default
} lac_forecast_options;

/// As of the last reading, from the onset of acceleration.
static inline lac_forecast_options lac_forecast_options_default(void)
{
    lac_forecast_options options = LAC_ZEROS;
    options.size = sizeof options;
    options.since = options.failed_at = (double)NAN;
    options.until = (double)INFINITY;
    return options;
}

/// Forecasts of the time of failure from a motion's past, a row a method, and indicators of it, as
/// `lacuna precursors` has them. A forecast sees nothing later than its time of issue.
/// @param series   of displacements or velocities; must outlive the dataset
/// @param options  NULL: the default
/// @param out      its variables are those of docs/format.md; NULL unless LAC_OK or, of the issue
///                 times that were done, LAC_EINTERRUPT
/// @return LAC_OK, also where no method issues one; LAC_EINPUT; LAC_EINTERRUPT; LAC_ENOMEM
lac_status lac_forecast_compute(const lac_series *series, const lac_forecast_options *options,
                                lac_dataset **out, lac_error *err);

LAC_END_C

#endif
