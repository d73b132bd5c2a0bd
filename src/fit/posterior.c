// SPDX-License-Identifier: GPL-3.0-or-later
// The posterior by the ensemble sampler, begun about the best fit, how well it was sampled, and the
// evidence of the case from its draws.
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "base/rng.h"
#include "base/statistics.h"
#include "fit/internal.h"

enum { TRIES = 200 };

void lac_fit_quantiles(size_t n, double *x, double quantile[LAC_FIT_QUANTILES])
{
    static const double share[LAC_FIT_QUANTILES] = {0.05, 0.25, 0.5, 0.75, 0.95};
    gsl_sort(x, 1, n);
    for (size_t q = 0; n > 0 && q < LAC_FIT_QUANTILES; q++) {
        quantile[q] = lac_quantile(n, x, share[q]);
    }
}

// Lower triangle L of the covariance, L L^T, made so small that no coordinate scatters by more than
// a fifth of its range or a unit: along what no reading tells of, least squares know no bound.
static void find_spread(const lac_fit *fit, double l[LAC_MOST_FITTED][LAC_MOST_FITTED])
{
    size_t n = fit->def->count;
    double scale = 1.0;
    memcpy(l, fit->covariance, sizeof fit->covariance);
    (void)lac_fit_factor(n, LAC_MOST_FITTED, &l[0][0]);
    for (size_t i = 0; i < n; i++) {
        double width = fit->high[i] - fit->low[i];
        double most = isfinite(width) ? 0.2 * width : 1.0;
        scale = fmin(scale, most / sqrt(fmax(fit->covariance[i][i], 1e-300)));
    }
    for (size_t i = 0; i < n; i++) {
        double width = fit->high[i] - fit->low[i];
        for (size_t j = 0; j <= i; j++) {
            l[i][j] *= scale;
        }
        // walkers in a plane would stay in it
        l[i][i] = fmax(l[i][i], 1e-6 * (isfinite(width) ? width : 1.0));
    }
}

// A number turned back into its range where it has left it: a best fit may stand at an end.
static double reflect(double x, double low, double high)
{
    x = x > high ? 2.0 * high - x : x;
    x = x < low ? 2.0 * low - x : x;
    double edge = isfinite(high - low) ? 1e-6 * (high - low) : 0.0; // where ln(share) has digits
    return fmin(fmax(x, low + edge), high - edge);
}

// A place near the best fit, nearer with every try.
static void draw_start(const lac_fit *fit, double l[LAC_MOST_FITTED][LAC_MOST_FITTED],
                       uint64_t which, double nearness, double *x)
{
    const uint64_t apart = UINT64_C(1) << 61; // from the numbers of the moves
    double z[LAC_FIT_UNKNOWNS + 1];
    for (size_t k = 0; k < fit->unknowns; k += 2) {
        lac_random_normal((uint64_t)fit->def->seed, LAC_STREAM_SAMPLER, apart + which, k, z + k);
    }
    for (size_t k = 0; k < fit->unknowns; k++) {
        double move = k < fit->def->count ? 0.0 : 0.1 * z[k];
        for (size_t j = 0; k < fit->def->count && j <= k; j++) {
            move += l[k][j] * z[j];
        }
        x[k] = reflect(fit->best[k] + nearness * move, fit->low[k], fit->high[k]);
    }
}

static lac_status find_starts(lac_fit *fit, double *start, lac_error *err)
{
    double l[LAC_MOST_FITTED][LAC_MOST_FITTED];
    size_t walkers = (size_t)fit->def->walkers;
    find_spread(fit, l);
    for (size_t w = 0; w < walkers; w++) {
        double x[LAC_FIT_UNKNOWNS];
        double nearness = 1.0;
        int tries = 0;
        do {
            LAC_FAIL_IF(tries++ == TRIES, err, LAC_ENUMERIC,
                        "the sampler finds no place about the best fit from which every run "
                        "reaches the last reading");
            draw_start(fit, l, (uint64_t)w * TRIES + (uint64_t)tries, nearness, x);
            nearness *= tries > 20 ? 0.9 : 1.0;
            fit->runs++;
        } while (!isfinite(lac_fit_log_posterior(fit, 0, x)));
        lac_fit_to_line(fit, x, start + w * fit->unknowns);
    }
    return LAC_OK;
}

static double density(void *context, int thread, const double *z)
{
    double u[LAC_FIT_UNKNOWNS];
    lac_fit *fit = context;
    double log_slope = lac_fit_from_line(fit, z, u);
    return lac_fit_log_posterior(fit, thread, u) + log_slope;
}

// The draws as coordinates.
static void return_chain(const lac_fit *fit)
{
    lac_chain *chain = fit->chain;
    for (size_t i = 0; i < chain->walkers * chain->steps; i++) {
        double u[LAC_FIT_UNKNOWNS];
        double *x = chain->x + i * chain->dimension;
        chain->log_density[i] -= lac_fit_from_line(fit, x, u);
        memcpy(x, u, chain->dimension * sizeof *x);
    }
}

// The evidence Z of a case, the mean of the likelihood over the prior, from the draws alone:
//     1/Z = mean over the posterior of g/(L prior)
// for any density g (Gelfand & Dey 1994). g is the normal one with the draws' mean and covariance,
// cut off where it holds half (Geweke 1999), so that the mean has a variance whatever the tails do.

static const double held = 0.5; // by g before it is cut off

// ln of what the prior of lac_fit_log_prior comes to over its range.
static double log_prior_mass(const lac_fit *fit)
{
    double sum = 0.0;
    for (size_t k = 0; k < fit->unknowns; k++) {
        const lac_fit_parameter *p = k < fit->def->count ? &fit->def->parameter[k] : NULL;
        if (p == NULL || p->prior != LAC_PRIOR_NORMAL) {
            sum += log(fit->high[k] - fit->low[k]);
            continue;
        }
        const double within = gsl_cdf_ugaussian_P(lac_fit_prior_residual(p, fit->high[k])) -
                              gsl_cdf_ugaussian_P(lac_fit_prior_residual(p, fit->low[k]));
        sum += log(p->sigma * sqrt(2.0 * M_PI) * within);
    }
    return sum;
}

// The draws on the walkers' line, less their mean, and ln of their density there.
static void lay_out(const lac_fit *fit, size_t n, double *z, double *log_density)
{
    const size_t d = fit->unknowns;
    double u[LAC_FIT_UNKNOWNS];
    for (size_t i = 0; i < n; i++) {
        lac_fit_to_line(fit, fit->chain->x + i * d, z + i * d);
        log_density[i] = fit->chain->log_density[i] + lac_fit_from_line(fit, z + i * d, u);
    }
    for (size_t k = 0; k < d; k++) {
        const double mean = gsl_stats_mean(z + k, d, n);
        for (size_t i = 0; i < n; i++) {
            z[i * d + k] -= mean;
        }
    }
}

// Root of their covariance. @return whether it has one
static bool find_root(size_t d, size_t n, const double *z, double *root)
{
    for (size_t k = 0; k < d; k++) {
        for (size_t l = 0; l < d; l++) {
            root[k * d + l] = gsl_stats_covariance_m(z + k, d, z + l, d, n, 0.0, 0.0);
        }
    }
    return lac_fit_factor(d, d, root);
}

// ln of g, but for what it is normalised by, over the density; -INFINITY where it is cut off.
static void compare(size_t d, size_t n, const double *root, double *z, double *log_density)
{
    const double reach = gsl_cdf_chisq_Pinv(held, (double)d);
    for (size_t i = 0; i < n; i++) {
        double square = 0.0;
        lac_fit_solve(d, root, z + i * d);
        for (size_t k = 0; k < d; k++) {
            square += z[i * d + k] * z[i * d + k];
        }
        log_density[i] = square < reach ? -0.5 * square - log_density[i] : -INFINITY;
    }
}

static lac_status find_evidence(const lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    const size_t d = fit->unknowns, walkers = fit->chain->walkers, n = walkers * fit->chain->steps;
    double root[LAC_FIT_UNKNOWNS * LAC_FIT_UNKNOWNS];
    double *z = calloc(n * (d + 1) + walkers, sizeof *z);
    LAC_FAIL_MEMORY_IF(z == NULL, err);
    double *ratio = z + n * d, *mean = ratio + n; // the latter of each walker's draws
    lay_out(fit, n, z, ratio);
    if (find_root(d, n, z, root)) {
        compare(d, n, root, z, ratio);
        const double most = gsl_stats_max(ratio, 1, n);
        for (size_t i = 0; i < n; i++) {
            mean[i % walkers] += exp(ratio[i] - most) / (double)fit->chain->steps;
        }
        const double all = gsl_stats_mean(mean, 1, walkers);
        result->evidence = log(held / all) - most + 0.5 * (double)d * log(2.0 * M_PI);
        for (size_t k = 0; k < d; k++) {
            result->evidence += log(root[k * d + k]);
        }
        result->evidence -= log_prior_mass(fit);
        result->evidence_error = gsl_stats_sd(mean, 1, walkers) / (all * sqrt((double)walkers));
    }
    free(z);
    return LAC_OK;
}

// Quantiles of every unknown.
static lac_status sum_up(const lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    const lac_chain *chain = fit->chain;
    size_t n = chain->walkers * chain->steps;
    double *x = calloc(n, sizeof *x);
    LAC_FAIL_MEMORY_IF(x == NULL, err);
    for (size_t k = 0; k < fit->unknowns; k++) {
        lac_fit_unknown *of = &result->unknown[k];
        for (size_t i = 0; i < n; i++) {
            x[i] = lac_fit_value(of->log, chain->x[i * chain->dimension + k]);
        }
        lac_fit_quantiles(n, x, of->quantile);
    }
    result->acceptance = gsl_stats_mean(chain->acceptance, 1, chain->walkers);
    result->chain = chain;
    result->sampled = true;
    free(x);
    return result->converged ? find_evidence(fit, result, err) : LAC_OK;
}

// R-hat of every unknown, and whether all are near 1.
static lac_status judge_chain(const lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    lac_status status = LAC_OK;
    result->converged = true;
    for (size_t k = 0; status == LAC_OK && k < fit->unknowns; k++) {
        lac_convergence *of = &result->unknown[k].converged;
        status = lac_chain_converged(fit->chain, k, of, err);
        result->converged = result->converged && of->rhat < LAC_FIT_RHAT;
    }
    return status;
}

// One chain; it takes the place of the one before, unless it was interrupted when still shorter.
static lac_status walk(lac_fit *fit, const lac_sampler_def *def, double *start, lac_error *err)
{
    lac_chain *chain = NULL;
    lac_status status = lac_sampler_run(def, start, &chain, err);
    if (chain == NULL) {
        return status;
    }
    fit->runs += (int64_t)((chain->steps + def->burn + 1) * def->walkers);
    if (fit->chain != NULL && chain->steps < fit->chain->steps) {
        lac_chain_free(chain);
        return status;
    }
    size_t row = def->walkers * def->dimension;
    if (chain->steps > 0) {
        memcpy(start, chain->x + (chain->steps - 1) * row, row * sizeof *start);
    }
    lac_chain_free(fit->chain);
    fit->chain = chain;
    return_chain(fit);
    return status;
}

// The walkers' valley straightened for the next chain, by where this one ended.
static lac_status shear(lac_fit *fit, double *start, lac_error *err)
{
    const size_t d = fit->unknowns;
    const lac_fit_shear before = fit->shear;
    LAC_TRY_RETURN(lac_fit_find_shear(fit, err));
    for (int64_t k = 0; k < fit->def->walkers; k++) {
        lac_fit_shear_to(&before, -1.0, start + (size_t)k * d);
        lac_fit_shear_to(&fit->shear, 1.0, start + (size_t)k * d);
    }
    return LAC_OK;
}

// Chains until one has converged: one that has not is dropped, as what leads up to the next, which
// is twice as long.
static lac_status walk_on(lac_fit *fit, lac_sampler_def *def, double *start, lac_fit_result *result,
                          lac_error *err)
{
    lac_status status = LAC_OK;
    for (int64_t round = 0; round <= fit->def->rounds; round++) {
        status = walk(fit, def, start, err);
        if (fit->chain == NULL || fit->chain->steps < 8) {
            return status;
        }
        if (status == LAC_OK || round == 0) {
            result->dropped = def->first + def->burn;
        }
        lac_status judged = judge_chain(fit, result, status == LAC_OK ? err : NULL);
        status = status == LAC_OK ? judged : status;
        if (status != LAC_OK || result->converged) {
            return status;
        }
        LAC_TRY_RETURN(shear(fit, start, err));
        def->first += def->burn + def->steps;
        def->burn = 0;
        def->steps *= 2;
    }
    return status;
}

lac_status lac_fit_sample(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                          lac_error *err)
{
    lac_status status = LAC_OK;
    lac_sampler_def def = {.dimension = fit->unknowns,
                           .walkers = (size_t)fit->def->walkers,
                           .steps = (size_t)fit->def->steps,
                           .burn = (size_t)fit->def->burn,
                           .seed = (uint64_t)fit->def->seed,
                           .drawing = 0.7,
                           .stretching = 0.15,
                           .threads = fit->threads,
                           .log_density = density,
                           .context = fit,
                           .watch = watch};
    double *start = malloc(def.walkers * def.dimension * sizeof *start);
    LAC_FAIL_MEMORY_IF(start == NULL, err);
    fit->straight = lac_fit_straighten(fit);
    LAC_TRY(find_starts(fit, start, err));
    status = walk_on(fit, &def, start, result, err);
    bool enough = fit->chain != NULL && fit->chain->steps >= 8;
    if (status == LAC_OK || (status == LAC_EINTERRUPT && enough)) {
        lac_status summed = sum_up(fit, result, status == LAC_OK ? err : NULL);
        status = status == LAC_OK ? summed : status;
    }
out:
    free(start);
    return status;
}

// How well a chain was sampled: rank-normalised split R-hat (Vehtari et al. 2021, eqs 1 to 4, 14)
// and the integrated autocorrelation time of an ensemble (Goodman & Weare 2010, sec. 4).

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
    double *x = calloc(n, 3 * sizeof *x + sizeof(size_t));
    LAC_FAIL_MEMORY_IF(x == NULL, err);
    double *z = x + n;
    size_t *order = (size_t *)(x + 3 * n);
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
    return LAC_OK;
}
