/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/kept.h"

/// Who watches a fit. Members may be NULL.
typedef struct lac_fit_watch {
    bool (*interrupted)(void *context);
    void (*progress)(void *context, const char *stage, size_t done, size_t total);
    void *context;
    lac_kept *kept; ///< takes the steps of the sampler, and gives those that it has
} lac_fit_watch;

static inline bool lac_fit_interrupted(const lac_fit_watch *watch)
{
    return watch != NULL && watch->interrupted != NULL && watch->interrupted(watch->context);
}

static inline void lac_fit_tell(const lac_fit_watch *watch, const char *stage, size_t done,
                                size_t total)
{
    if (watch != NULL && watch->progress != NULL) {
        watch->progress(watch->context, stage, done, total);
    }
}

/// What is sampled, and how.
typedef struct lac_sampler_def {
    size_t dimension;
    size_t walkers;    ///< even, at least 2 dimension + 2
    size_t steps;      ///< kept of each walker
    size_t burn;       ///< steps before those, dropped
    double drawing;    ///< share of moves drawn from a density made of the other half
    double stretching; ///< share of stretch moves; the rest goes by the difference of two walkers
    uint64_t first;    ///< number of the first step: one that goes on from another chain differs
    uint64_t seed;
    int threads; ///< that look at walkers at the same time; < 1 counts as 1
    /// ln of the density, up to a constant; -INFINITY (or NaN) where there is none. It must depend
    /// on x alone.
    /// @param thread  below `threads`: whose scratch is free
    double (*log_density)(void *context, int thread, const double *x);
    void *context;
    const lac_fit_watch *watch; ///< asked and told after every step; NULL: nobody
} lac_sampler_def;

/// The draws.
typedef struct lac_chain {
    size_t dimension, walkers, steps;
    double *x;           ///< [steps][walkers][dimension]
    double *log_density; ///< [steps][walkers]
    bool *moved;         ///< [steps][walkers] whether the move that led there was accepted
    double *acceptance;  ///< [walkers] moves accepted, of those of the steps kept [1]
} lac_chain;

/// Draws from a density with an ensemble of walkers and the stretch move (Goodman & Weare 2010,
/// doi 10.2140/camcos.2010.5.65; a = 2) and, for the share of moves that is left, differential
/// evolution (ter Braak 2006, doi 10.1007/s11222-006-8769-1; Nelson et al. 2014), which goes faster
/// along curved valleys, and draws from a density of the walkers themselves (kernels as wide as the
/// places about each; at most 128 of them), which forget where they came from. Half of the ensemble
/// moves after the other, and looks only at it, so that the walkers of a half move at the same
/// time. Random numbers are functions of (seed, step, walker): the chain is the same to the bit for
/// any number of threads.
/// @param start  [walkers][dimension] where they begin; not all in a plane
/// Steps that the watch's `kept` holds are taken from it, those after them put there: the chain is
/// the same to the bit as one made in one go.
/// @return LAC_OK; LAC_EINPUT (too few walkers, odd, a start without density, or another one than
///         that of the steps kept); LAC_EINTERRUPT (the chain holds the steps up to there);
///         LAC_EIO; LAC_ENOMEM
lac_status lac_sampler_run(const lac_sampler_def *def, const double *start, lac_chain **out,
                           lac_error *err);

void lac_chain_free(lac_chain *chain);

/// How well one coordinate of a chain was sampled.
typedef struct lac_convergence {
    double rhat; ///< rank-normalised split R-hat, the larger of bulk and folded (Vehtari et al.
                 ///< 2021, doi 10.1214/20-BA1221), each walker a chain [1]
    double time; ///< integrated autocorrelation time [steps]
    double ess;  ///< effective number of draws: walkers * steps / time
} lac_convergence;

/// The integrated autocorrelation time is that of the walkers' mean autocorrelation function,
/// summed to the first lag that is five times the sum (Sokal's window).
/// @return LAC_OK; LAC_EINPUT (fewer than 8 steps); LAC_ENOMEM
lac_status lac_chain_converged(const lac_chain *chain, size_t coordinate, lac_convergence *out,
                               lac_error *err);

/// Cholesky's lower triangle in the place of a matrix; GSL's own ends the program where there is
/// none. What depends on the rows before it gets 0.
/// @param stride  from row to row
/// @return whether the matrix is positive definite, with twelve digits
bool lac_fit_factor(size_t d, size_t stride, double *a);

/// x = L^-1 x, for an L of which the rows lie side by side.
void lac_fit_solve(size_t d, const double *l, double *x);
