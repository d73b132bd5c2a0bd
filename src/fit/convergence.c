// SPDX-License-Identifier: GPL-3.0-or-later
// How well a chain was sampled: rank-normalised split R-hat (Vehtari et al. 2021, eqs 1 to 4, 14)
// and the integrated autocorrelation time of an ensemble (Goodman & Weare 2010, sec. 4).
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/statistics.h"
#include "fit/sampler.h"

// R-hat of m chains of n draws each, chain after chain.
static double rhat_of(const double *x, size_t m, size_t n)
{
    double between = 0.0;
    double within = 0.0;
    double mean = gsl_stats_mean(x, 1, m * n);
    for (size_t j = 0; j < m; j++) {
        double own = gsl_stats_mean(x + j * n, 1, n);
        between += (own - mean) * (own - mean);
        within += gsl_stats_variance_m(x + j * n, 1, n, own);
    }
    between *= (double)n / (double)(m - 1);
    within /= (double)m;
    double pooled = (double)(n - 1) / (double)n * within + between / (double)n;
    return within > 0.0 ? sqrt(pooled / within) : between > 0.0 ? INFINITY : 1.0;
}

// Values by their ranks, of equal ones the mean, on a normal scale: z = Phi^-1((r - 3/8)/(S +
// 1/4)).
static void rank_normalise(size_t n, const double *x, size_t *order, double *z)
{
    gsl_sort_index(order, x, 1, n);
    for (size_t i = 0; i < n;) {
        size_t end = i + 1;
        while (end < n && x[order[end]] == x[order[i]]) {
            end++;
        }
        double rank = 0.5 * (double)(i + 1 + end);
        double value = gsl_cdf_ugaussian_Pinv((rank - 0.375) / ((double)n + 0.25));
        for (; i < end; i++) {
            z[order[i]] = value;
        }
    }
}

// Halves of every walker, one behind the other; an odd last draw is left out.
static size_t split(const lac_chain *chain, size_t coordinate, double *x)
{
    size_t half = chain->steps / 2;
    for (size_t k = 0; k < chain->walkers; k++) {
        for (size_t i = 0; i < 2 * half; i++) {
            x[k * 2 * half + i] =
                chain->x[(i * chain->walkers + k) * chain->dimension + coordinate];
        }
    }
    return half;
}

// Mean over the walkers of the autocovariance at a lag, about the mean of all.
static double covariance(const lac_chain *chain, size_t coordinate, double mean, size_t lag)
{
    size_t stride = chain->walkers * chain->dimension;
    double sum = 0.0;
    for (size_t k = 0; k < chain->walkers; k++) {
        const double *x = chain->x + k * chain->dimension + coordinate;
        for (size_t i = 0; i + lag < chain->steps; i++) {
            sum += (x[i * stride] - mean) * (x[(i + lag) * stride] - mean);
        }
    }
    return sum / (double)(chain->walkers * chain->steps);
}

static double autocorrelation_time(const lac_chain *chain, size_t coordinate)
{
    double mean =
        gsl_stats_mean(chain->x + coordinate, chain->dimension, chain->walkers * chain->steps);
    double variance = covariance(chain, coordinate, mean, 0);
    double time = 1.0;
    if (!(variance > 0.0)) {
        return (double)chain->steps; // nothing ever moved
    }
    for (size_t lag = 1; lag < chain->steps && (double)lag < 5.0 * time; lag++) {
        time += 2.0 * covariance(chain, coordinate, mean, lag) / variance;
    }
    return fmax(time, 1.0);
}

lac_status lac_chain_converged(const lac_chain *chain, size_t coordinate, lac_convergence *out,
                               lac_error *err)
{
    size_t n = chain->walkers * chain->steps;
    LAC_FAIL_IF(chain->steps < 8, err, LAC_EINPUT, "%zu steps are too few to judge a chain by",
                chain->steps);
    double *x = calloc(3 * n, sizeof *x);
    size_t *order = malloc(n * sizeof *order);
    if (x == NULL || order == NULL) {
        free(x);
        free(order);
        return lac_fail_memory(err);
    }
    double *z = x + n;
    size_t half = split(chain, coordinate, x);
    size_t chains = 2 * chain->walkers;
    size_t used = chains * half;
    rank_normalise(used, x, order, z);
    double bulk = rhat_of(z, chains, half);
    memcpy(z + n, x, used * sizeof *x);
    double middle = lac_median(used, z + n);
    for (size_t i = 0; i < used; i++) {
        x[i] = fabs(x[i] - middle);
    }
    rank_normalise(used, x, order, z);
    out->rhat = fmax(bulk, rhat_of(z, chains, half));
    out->time = autocorrelation_time(chain, coordinate);
    out->ess = (double)n / out->time;
    free(x);
    free(order);
    return LAC_OK;
}
