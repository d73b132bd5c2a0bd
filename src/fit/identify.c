// SPDX-License-Identifier: GPL-3.0-or-later
// What the data tell of the parameters together: correlations, principal axes, and the number that
// one block under the aging law shows.
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit/internal.h"

// Covariance of the coordinates: of the draws, or of the least squares.
static void find_covariance(const lac_fit *fit, double c[LAC_MOST_FITTED][LAC_MOST_FITTED])
{
    const lac_chain *chain = fit->chain;
    for (size_t k = 0; k < fit->def->count; k++) {
        for (size_t l = 0; l < fit->def->count; l++) {
            c[k][l] = chain == NULL || chain->steps < 8
                          ? fit->covariance[k][l]
                          : gsl_stats_covariance(chain->x + k, chain->dimension, chain->x + l,
                                                 chain->dimension, chain->walkers * chain->steps);
        }
    }
}

// An axis as powers, the largest 1: a change of the combination prod p^w.
static void put_axis(const gsl_matrix *vectors, size_t column, double variance, size_t n,
                     lac_fit_combination *axis)
{
    double largest = 0.0;
    for (size_t k = 0; k < n; k++) {
        double w = gsl_matrix_get(vectors, k, column);
        largest = fabs(w) > fabs(largest) ? w : largest;
    }
    for (size_t k = 0; k < n; k++) {
        axis->power[k] = gsl_matrix_get(vectors, k, column) / largest;
    }
    axis->sigma = sqrt(fmax(variance, 0.0)) / fabs(largest);
}

// Principal axes of the relative changes: of a coordinate that is no logarithm over its value.
static lac_status find_axes(const lac_fit *fit, double c[LAC_MOST_FITTED][LAC_MOST_FITTED],
                            lac_fit_result *result, lac_error *err)
{
    size_t n = fit->def->count;
    gsl_matrix *m = gsl_matrix_alloc(n, n);
    gsl_matrix *vectors = gsl_matrix_alloc(n, n);
    gsl_vector *values = gsl_vector_alloc(n);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(n);
    lac_status status = LAC_OK;
    if (m == NULL || vectors == NULL || values == NULL || w == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    for (size_t k = 0; k < n; k++) {
        for (size_t l = 0; l < n; l++) {
            double unit_k = result->unknown[k].log ? 1.0 : fabs(result->unknown[k].best);
            double unit_l = result->unknown[l].log ? 1.0 : fabs(result->unknown[l].best);
            gsl_matrix_set(m, k, l, c[k][l] / (unit_k * unit_l));
        }
    }
    (void)gsl_eigen_symmv(m, values, vectors, w);
    (void)gsl_eigen_symmv_sort(values, vectors, GSL_EIGEN_SORT_VAL_DESC);
    for (size_t i = 0; i < n; i++) {
        put_axis(vectors, i, gsl_vector_get(values, i), n, &result->axis[i]);
    }
out:
    gsl_eigen_symmv_free(w);
    gsl_matrix_free(m);
    gsl_matrix_free(vectors);
    gsl_vector_free(values);
    return status;
}

// (m/dc)(1 - x^(m-1)) of the case at coordinates u.
static double shape_at(const lac_fit *fit, const double *u)
{
    lac_fit_variant *v = &fit->model[0].base;
    const lac_friction_params *law = v->c->friction.params;
    lac_fit_put(fit->def, u, v->at);
    double m = law->b / law->a;
    return m / law->dc * (1.0 - pow(v->c->initial.state_value, m - 1.0));
}

static lac_status find_shape(const lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    const lac_chain *chain = fit->chain;
    result->one_block = lac_fit_is_one_block(fit->source);
    if (!result->one_block) {
        return LAC_OK;
    }
    if (chain == NULL || chain->steps < 8) {
        result->shape.quantile[2] = shape_at(fit, fit->best);
        return LAC_OK;
    }
    size_t n = chain->walkers * chain->steps;
    double *shape = calloc(n, sizeof *shape);
    LAC_FAIL_MEMORY_IF(shape == NULL, err);
    for (size_t i = 0; i < n; i++) {
        shape[i] = shape_at(fit, chain->x + i * chain->dimension);
    }
    double mean = gsl_stats_mean(shape, 1, n);
    result->shape_sigma = gsl_stats_sd_m(shape, 1, n, mean) / fabs(mean);
    lac_fit_quantiles(n, shape, result->shape.quantile);
    free(shape);
    return LAC_OK;
}

lac_status lac_fit_identify(lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    double c[LAC_MOST_FITTED][LAC_MOST_FITTED];
    size_t n = fit->def->count;
    find_covariance(fit, c);
    for (size_t k = 0; k < n; k++) {
        for (size_t l = 0; l < n; l++) {
            double product = c[k][k] * c[l][l];
            result->correlation[k][l] = product > 0.0 ? c[k][l] / sqrt(product)
                                        : k == l      ? 1.0
                                                      : 0.0;
        }
    }
    lac_status status = find_axes(fit, c, result, err);
    return status == LAC_OK ? find_shape(fit, result, err) : status;
}
