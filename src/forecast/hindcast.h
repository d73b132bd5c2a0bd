/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "forecast/forecast.h"

enum { LAC_LEADS = 4 };

/// Forecasts as they would have been issued at many times.
typedef struct lac_rolling {
    size_t issues, methods;
    double start;           ///< the first reading [s]
    double *issue_time;     ///< [issues] [s]
    lac_forecast *forecast; ///< [issues][methods]
    lac_verdict *verdict;   ///< [issues]
} lac_rolling;

/// What a caller may stop a long hindcast by, and see of it.
typedef struct lac_rolling_watch {
    void *context;
    bool (*go_on)(void *context, size_t done, size_t all); ///< NULL: always
    void *seer;
    /// Looks at the set of forecasts of each issue time, in their order; NULL: nobody does.
    lac_status (*see)(void *seer, const lac_forecast_set *forecasts, lac_error *err);
} lac_rolling_watch;

/// Forecasts at each reading, from nothing but the readings up to it; where there are more than
/// `most`, at `most` of them, evenly by number, the last included.
/// @param out NULL where it fails; of an interrupted one the issue times that were done, if any
/// @return LAC_OK; LAC_EINPUT; LAC_ENOMEM; LAC_EINTERRUPT
lac_status lac_rolling_create(const lac_forecast_def *def, const lac_readings *readings,
                              size_t most, const lac_rolling_watch *watch, lac_rolling **out,
                              lac_error *err);

void lac_rolling_free(lac_rolling *rolling);

/// How good a method's rolling forecasts were, where the time of failure is known. A method alarms
/// at an issue time where its 50 % interval ends within the horizon: failure within it with a
/// chance of three in four at least.
typedef struct lac_skill {
    const lac_forecast_kind *kind;
    size_t asked, issued; ///< issue times before failure, and those with a forecast
    size_t inside50, inside90;
    double error;            ///< median |tc - failure| [s]; NaN: none issued
    double crps;             ///< mean continuous ranked probability score [s]
    double persistence_crps; ///< of the baseline at the same issue times [s]
    size_t alarms, hits, misses, false_alarms;
    size_t lead_count[LAC_LEADS];
    double lead_error[LAC_LEADS]; ///< median |tc - failure| [s], lead times in eighths, eighth to
                                  ///< quarter, quarter to half, and beyond, of the whole series
    double lead_bias[LAC_LEADS];  ///< median (tc - issue)/(failure - issue); > 1 is late
} lac_skill;

/// Measures all methods.
/// @param failed_at  [s]; INFINITY: never
/// @param horizon    of alarms [s]
lac_status lac_rolling_measure(const lac_rolling *rolling, double failed_at, double horizon,
                               lac_skill *skill, lac_error *err);
