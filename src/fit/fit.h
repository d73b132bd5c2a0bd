/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "fit/sampler.h"
#include "lacuna/fit.h"
#include "scene/scene.h"
#include "series/series.h"

enum {
    LAC_FIT_UNKNOWNS = LAC_MOST_FITTED + 3, ///< parameters, two errors and a correlation time
    LAC_FIT_QUANTILES = 5,                  ///< 5, 25, 50, 75 and 95 %
};

/// R-hat from which on a chain counts as not converged.
#define LAC_FIT_RHAT 1.05

/// A case being fitted to a series.
typedef struct lac_fit lac_fit;

/// How derivatives by a parameter were had.
typedef enum lac_fit_by {
    LAC_BY_SENSITIVITY = 0, ///< CVODES' forward sensitivities
    LAC_BY_RUNS,            ///< differences of runs: it changes the cells or when loads break
    LAC_BY_NOTHING,         ///< an error of the data, which has a closed form
} lac_fit_by;

/// One unknown: a parameter of the case, or an error of the data.
typedef struct lac_fit_unknown {
    const char *key;  ///< as in the case, or error.displacement, error.velocity, error.time
    const char *unit; ///< SI
    bool log;         ///< its coordinate is the logarithm
    int by;           ///< lac_fit_by
    double best;      ///< least squares [unit]
    int end;          ///< of its range that the best stands at: -1 the lower, 1 the upper, 0 none
    double limit;     ///< that end [unit]; NaN: none
    double error;     ///< standard error of the coordinate from the least squares; NaN: none
    double quantile[LAC_FIT_QUANTILES]; ///< of the posterior [unit]; NaN where not sampled
    lac_convergence converged;
} lac_fit_unknown;

/// A product of powers of the parameters (of a parameter that is not logarithmic: of its value),
/// one principal axis of the posterior, or of the least squares where nothing was sampled.
typedef struct lac_fit_combination {
    double power[LAC_MOST_FITTED]; ///< [parameters] the largest is 1
    double sigma;                  ///< standard deviation of its logarithm
} lac_fit_combination;

/// A number with its intervals.
typedef struct lac_fit_interval {
    double quantile[LAC_FIT_QUANTILES]; ///< NaN: not known; INFINITY: never
} lac_fit_interval;

/// What came of a fit. Arrays belong to the fit.
typedef struct lac_fit_result {
    size_t parameters, unknowns;
    lac_fit_unknown unknown[LAC_FIT_UNKNOWNS];   ///< [unknowns] parameters first
    size_t displacements, frictions, velocities; ///< readings used
    size_t bounds;                               ///< of the velocities, that are upper bounds
    size_t outside, missing;                     ///< left out: outside the run, not given
    size_t not_positive;                         ///< velocities left out: they have no logarithm
    double displacement_rms;                     ///< of the best fit [m]; NaN
    double log_rate_rms;                         ///< of the best fit, of ln v [1]; NaN
    double offset;                               ///< zero of the displacements [m]
    double autocorrelation; ///< of successive residuals of displacements, whitened if ar1 [1]
    double misfit;          ///< rms over the range of the displacements; of velocities that of ln v
    double excess;          ///< what of it the noise does not explain: lac_unexplained
    double scatter;         ///< of displacements about the line between their neighbours [m]; NaN
    bool poor;    ///< they hang together or (white ones) exceed that scatter as noise does 1 in 100
    bool falls;   ///< and the displacements fall: slip only grows
    bool windows; ///< velocities have errors, bounds or windows of their own
    bool friction;         ///< it stands in the place of displacements, here and below [1], not [m]
    double log_likelihood; ///< of the best fit, offset integrated out
    double bic;            ///< Bayesian information criterion: k ln n - 2 ln L; less is better
    double evidence;       ///< ln of the mean likelihood over the prior; NaN: not sampled
    double evidence_error; ///< its standard error, from the walkers' scatter
    double failure;        ///< time of failure of the best fit [s]; NaN: none by time.end
    double failure_error;  ///< its standard error from the least squares [s]
    int64_t runs;          ///< integrations made
    size_t tried, alive;   ///< places tried before the least squares, those with a likelihood
    bool sampled;
    size_t dropped;                                       ///< steps of each walker before the draws
    bool converged;                                       ///< R-hat of all below LAC_FIT_RHAT
    double acceptance;                                    ///< of the sampler [1]
    double correlation[LAC_MOST_FITTED][LAC_MOST_FITTED]; ///< of the coordinates
    lac_fit_combination axis[LAC_MOST_FITTED];            ///< [parameters] the loosest first
    bool one_block;             ///< `shape` holds: a block under the aging law, its ratio given
    lac_fit_interval shape;     ///< (m/dc)(1 - x^(m-1)), m = b/a [1/m]
    double shape_sigma;         ///< standard deviation of its logarithm
    lac_fit_interval failures;  ///< time of failure over the posterior [s]
    double failing;             ///< share of the draws that fail by time.end
    size_t draws;               ///< of the posterior that were run on
    size_t times;               ///< of the predictive series
    const double *time;         ///< [times] [s] since the start
    const double *displacement; ///< [LAC_FIT_QUANTILES][times] [m]; INFINITY: beyond failure
    const double *rate;         ///< [LAC_FIT_QUANTILES][times] [m/s]
    const double *fitted;       ///< [times] displacement of the best fit [m]; NaN beyond failure
    size_t readings;
    const double *reading_time;  ///< [readings] [s] since the start
    const double *observed;      ///< [readings] displacement [m]; NaN
    const double *observed_rate; ///< [readings] [m/s]; NaN
    /// With `windows` only: what the rate did not exceed [m/s]; NaN
    const double *observed_most;  ///< [readings]
    const double *reading_within; ///< [readings] half the window of the time [s]
    const double *rate_rank;      ///< [readings] share of predicted readings of the rate below it
    const double *most_kept;      ///< [readings] how likely the posterior keeps the bound
    /// What the posterior predicts of the readings, their errors included, and ln of the likelihood
    /// of each, given those before it: of `told` draws, evenly taken of those that were run on
    size_t told;
    const double *told_reading, *told_rate;     ///< [told][readings] as observed; NaN
    const double *likely_reading, *likely_rate; ///< [told][readings] [1]; NaN
    const double *draw_failure;                 ///< [draws] [s]; NaN: not by time.end
    const lac_chain *chain;                     ///< of the coordinates; NULL
} lac_fit_result;

/// A fit as it is told: what lac_fit_describe lays its tables on.
typedef struct lac_fit_outcome {
    const lac_case *source;
    const lac_fit_result *result;
    const char *status; ///< complete, interrupted
} lac_fit_outcome;

/// Its variables, for a file, JSON or page; docs/format.md.
/// @param outcome  with all that it points to must outlive the dataset
lac_status lac_fit_describe(const lac_fit_outcome *outcome, lac_dataset **out, lac_error *err);

/// Lays a series on a case that has a section `fit`.
/// @param c        must outlive the fit; its own values are the first start
/// @param series   its times on the run's clock: seconds since 1970 where both are dated, else
///                 since the start; read with the columns of c->fit
/// @param sigma    the column fit.sigma: the series' `value` holds it
/// @return LAC_OK; LAC_EINPUT (too few readings, a date against none ...); what a scene returns
lac_status lac_fit_create(const lac_case *c, const lac_series *series, int threads, lac_fit **out,
                          lac_error *err);

void lac_fit_free(lac_fit *fit);

/// What the steps of its sampler follow from, but for fit.rounds: of lac_kept_open. Asked for
/// before it is run.
/// @return 0 where memory is short
uint64_t lac_fit_sum(lac_fit *fit);

/// Least squares, then the sampler, then the predictions, as the case says; docs/theory/fitting.md.
/// @param result  filled as far as it came, whatever the status
/// @return LAC_OK; LAC_ENUMERIC (no start has a likelihood: every run fails before the last
///         reading, or cannot be computed); LAC_EINTERRUPT; LAC_ENOMEM
lac_status lac_fit_run(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                       lac_error *err);

/// Whether the draws can be relied on.
/// @return LAC_OK; LAC_ENUMERIC: says which unknown was sampled worst and what it trades off with
lac_status lac_fit_trust(const lac_fit_result *result, lac_error *err);

/// Puts the best fit into a case of the same parameters.
void lac_fit_apply(const lac_fit_result *result, lac_case *c);

/// ln of the posterior density at coordinates, offset integrated out.
/// @param x  [unknowns] in the order of the result
/// @return -INFINITY where a run fails before the last reading, or cannot be computed
double lac_fit_log_posterior(lac_fit *fit, int thread, const double *x);
