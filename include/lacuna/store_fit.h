/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_FIT_H
#define LACUNA_STORE_FIT_H

#include "lacuna/linkage.h"
#include "lacuna/store.h"

LAC_BEGIN_C

/// One unknown of a fit, as it is written.
typedef struct lac_fit_column {
    const char *key, *unit; ///< "friction.aging.dc", "m"
    bool log;               ///< its coordinate is the logarithm of the value
    double best, error;     ///< value; standard error of the coordinate; NaN: not known
    double limit;           ///< end of its range that the best stands at; NaN: at none
    double rhat, ess;       ///< of its draws; NaN
} lac_fit_column;

/// The results of a fit, as they are written. NaN and INFINITY are missing values.
typedef struct lac_fit_view {
    const char *status; ///< complete, interrupted
    size_t unknowns;
    const lac_fit_column *unknown; ///< [unknowns]
    size_t chains, draws;          ///< 0: nothing sampled
    const double *x;               ///< [draws][chains][unknowns] coordinates
    const double *log_density;     ///< [draws][chains]
    const double *acceptance;      ///< [chains]
    size_t quantiles;
    const double *quantile; ///< [quantiles] which
    size_t times;
    const double *time;         ///< [times] since the start [s]
    const double *displacement; ///< [quantiles][times] [m]; NULL: nothing sampled
    const double *rate;         ///< [quantiles][times] [m/s]; NULL
    const double *fitted;       ///< [times] of the best fit [m]
    size_t readings;
    const double *reading_time;             ///< [readings] [s]
    const double *observed, *observed_rate; ///< [readings] [m], [m/s]
    size_t failures;
    const double *failure; ///< [failures] of draws that were run on [s]
    bool dated;
    double start_date; ///< seconds since 1970 of t = 0
} lac_fit_view;

/// Writes them to a netCDF-4 file of their own; docs/format.md.
/// @return as lac_store_create
lac_status lac_store_fit(const char *path, bool force, const lac_provenance *provenance,
                         const lac_fit_view *view, lac_error *err);

LAC_END_C

#endif
