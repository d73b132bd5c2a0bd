// SPDX-License-Identifier: GPL-3.0-or-later
// The evidence Z of a case, the mean of the likelihood over the prior, from the draws alone:
//     1/Z = mean over the posterior of g/(L prior)
// for any density g (Gelfand & Dey 1994). g is the normal one with the draws' mean and covariance,
// cut off where it holds half (Geweke 1999), so that the mean has a variance whatever the tails do.
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_statistics_double.h>

#include "fit/internal.h"

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

lac_status lac_fit_find_evidence(const lac_fit *fit, lac_fit_result *result, lac_error *err)
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
