// SPDX-License-Identifier: GPL-3.0-or-later
// How good the best fit is, and what the data tell of the parameters together: correlations,
// principal axes, and the number that one block under the aging law shows.
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_statistics_double.h>

#include "base/noise.h"
#include "base/statistics.h"
#include "fit/internal.h"

// Correlation of successive residuals.
static double find_memory(const lac_fit_data *data, const double *r)
{
    double squares = 0.0;
    double products = 0.0;
    double before = NAN;
    for (size_t i = 0; i < data->n; i++) {
        if (isnan(data->displacement[i])) {
            continue;
        }
        double z = r[i] / data->sigma[i];
        squares += z * z;
        products += isnan(before) ? 0.0 : before * z;
        before = z;
    }
    return squares > 0.0 ? products / squares : 0.0;
}

// What the readings scatter by themselves: each against the straight line between its neighbours.
static double find_scatter(const lac_fit_data *data)
{
    size_t at[2] = {0, 0}; // the last two displacements
    size_t seen = 0;
    double sum = 0.0;
    for (size_t i = 0; i < data->n; i++) {
        if (isnan(data->displacement[i])) {
            continue;
        }
        if (seen >= 2) {
            double share =
                (data->time[at[1]] - data->time[at[0]]) / (data->time[i] - data->time[at[0]]);
            double off = data->displacement[at[1]] - (1.0 - share) * data->displacement[at[0]] -
                         share * data->displacement[i];
            sum += off * off / (1.0 + share * share + (1.0 - share) * (1.0 - share));
        }
        at[0] = at[1];
        at[1] = i;
        seen++;
    }
    return seen > 2 ? sqrt(sum / (double)(seen - 2)) : NAN;
}

// White errors are so related, or so much larger than the readings' own scatter, in one of a
// hundred series. Correlated ones are judged by what is left of them once whitened; they exceed
// that scatter by their nature.
static void judge_residuals(const lac_fit_data *data, const lac_fit_errors_at *errors, double *r,
                            lac_fit_result *result)
{
    double spread = 2.33 / sqrt((double)data->displacements);
    bool related = errors->time > 0.0;
    result->scatter = find_scatter(data);
    double ratio = result->displacement_rms / result->scatter;
    if (related) {
        (void)lac_fit_whiten(data, errors, r, r);
        for (size_t i = 0; i < data->n; i++) {
            r[i] = isnan(data->displacement[i]) ? NAN : r[i] * data->sigma[i];
        }
    }
    result->autocorrelation = find_memory(data, r);
    result->poor =
        result->autocorrelation > spread || (!related && ratio * ratio > 1.0 + 2.0 * spread);
}

// Whether readings fall, and not only where a sensor was set back. @param work  [n]
static bool readings_fall(size_t n, const double *time, const double *value, double *work)
{
    const size_t apart = n / 8 + 1;
    for (size_t i = 0; i + apart < n; i++) {
        work[i] = value[i + apart] - value[i];
    }
    return gsl_stats_correlation(time, 1, value, 1, n) < -0.5 && lac_median(n - apart, work) < 0.0;
}

// How far the rms goes beyond the noise: that of the column of standard errors, else what readings
// scatter by themselves. Displacements first, else logarithms of velocities. @param room  [3 n]
static void weigh(const lac_fit *fit, double *room, lac_fit_result *result)
{
    const lac_fit_data *data = &fit->data;
    const bool slips = data->displacements > 0;
    const bool known = slips && fit->def->columns.sigma != NULL;
    const double *of = slips ? data->displacement : data->log_rate;
    const double rms = slips ? result->displacement_rms : result->log_rate_rms;
    if (!slips && data->rates > 0) { // their errors are stated, and bounds have none
        result->misfit = rms;
        return;
    }
    double *value = room + data->n, *work = value + data->n;
    double low = INFINITY, high = -INFINITY;
    size_t n = 0;
    for (size_t i = 0; i < data->n; i++) {
        if (!isnan(of[i])) {
            low = fmin(low, of[i]);
            high = fmax(high, of[i]);
            room[n] = data->time[i];
            value[n] = of[i];
            work[n++] = data->sigma[i];
        }
    }
    const double noise = known ? lac_median(n, work) : lac_noise_of(n, room, value, work);
    result->falls = result->poor && slips && !fit->friction && readings_fall(n, room, value, work);
    const double range = slips ? high - low : 1.0;
    const double free = (double)n - (double)fit->def->count - (slips && fit->offset ? 1.0 : 0.0);
    result->misfit = rms / range;
    result->excess =
        lac_unexplained(rms, slips && noise < data->digit ? data->digit : noise, free) / range;
}

static void measure(lac_fit *fit, double *slip, double *log_rate, lac_fit_result *result)
{
    const lac_fit_data *data = &fit->data;
    double squares = 0.0;
    double log_squares = 0.0;
    lac_fit_errors_at errors = lac_fit_errors_of(fit, fit->best);
    lac_fit_misfit misfit =
        lac_fit_likelihood(fit, &errors, slip, log_rate, fit->model[0].scratch + 2 * data->n);
    double free = (double)fit->unknowns + (fit->offset && data->displacements > 0 ? 1.0 : 0.0);
    result->log_likelihood = misfit.log_likelihood;
    result->bic = free * log((double)(data->displacements + data->velocities)) - 2.0 * misfit.peak;
    result->offset = misfit.offset;
    for (size_t i = 0; i < data->n; i++) {
        double by = data->log_rate[i] - log_rate[i];
        slip[i] = data->displacement[i] - slip[i] - misfit.offset;
        squares += isnan(slip[i]) ? 0.0 : slip[i] * slip[i];
        log_squares += isnan(by) ? 0.0 : by * by;
    }
    if (data->displacements > 0) {
        result->displacement_rms = sqrt(squares / (double)data->displacements);
        judge_residuals(data, &errors, slip, result);
    }
    for (size_t k = 0; k < data->rates; k++) {
        const double by = lac_fit_rate_off(data, &data->rate[k], errors.velocity, log_rate);
        log_squares += by * by;
    }
    if (data->velocities > 0) {
        result->log_rate_rms = sqrt(log_squares / (double)data->velocities);
    }
    weigh(fit, fit->model[0].scratch + 2 * data->n, result);
}

// When the best fit fails, and how far that is known from the least squares alone.
static lac_status find_failure(lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    double by[LAC_MOST_FITTED];
    double variance = 0.0;
    lac_sensitivity seen = {.failure_by = by};
    lac_status status = lac_fit_model_failure(&fit->model[0], fit->best, &seen, err);
    fit->runs++;
    result->failure = status == LAC_OK && seen.failed ? seen.failure_time : NAN;
    if (isnan(result->failure)) {
        return status == LAC_ENUMERIC ? LAC_OK : status; // beyond the readings nothing is owed
    }
    for (size_t k = 0; k < fit->def->count; k++) {
        for (size_t l = 0; l < fit->def->count; l++) {
            variance += by[k] * fit->covariance[k][l] * by[l];
        }
    }
    result->failure_error = sqrt(variance);
    return LAC_OK;
}

// Whether the best stands in the last hundredth of its coordinate's range, and at which end.
static void find_end(const lac_fit *fit, size_t k, lac_fit_unknown *x)
{
    const double near = 0.01;
    const double share = (fit->best[k] - fit->low[k]) / (fit->high[k] - fit->low[k]);
    const bool ranged = isfinite(fit->low[k]) && isfinite(fit->high[k]);
    x->end = ranged && share <= near ? -1 : ranged && share >= 1.0 - near ? 1 : 0;
    x->limit = x->end != 0 ? lac_fit_value(x->log, x->end < 0 ? fit->low[k] : fit->high[k]) : NAN;
}

lac_status lac_fit_judge(lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    const lac_fit_data *data = &fit->data;
    double *slip = fit->model[0].scratch;
    double *log_rate = slip + data->n;
    lac_sensitivity seen = {.slip = slip, .log_rate = log_rate};
    // As exact as it was found: it may fail close behind the last reading.
    fit->model[0].rtol = LAC_FIT_TIGHT;
    const lac_status status = lac_fit_model_run(&fit->model[0], fit->best, data->time[data->n - 1],
                                                data->n, data->time, &seen, err);
    fit->model[0].rtol = LAC_FIT_LOOSE;
    LAC_TRY_RETURN(status);
    LAC_FAIL_IF(seen.reached < data->n, err, LAC_ENUMERIC,
                "the best fit fails before the last reading");
    measure(fit, slip, log_rate, result);
    for (size_t k = 0; k < fit->unknowns; k++) {
        lac_fit_unknown *x = &result->unknown[k];
        bool parameter = k < fit->def->count;
        x->best = lac_fit_value(x->log, fit->best[k]);
        find_end(fit, k, x);
        x->by = parameter ? fit->by[k] : LAC_BY_NOTHING;
        x->error = parameter ? sqrt(fit->covariance[k][k]) : NAN;
    }
    return find_failure(fit, result, err);
}

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
    double room[LAC_MOST_FITTED * (2 * LAC_MOST_FITTED + 1)];
    gsl_matrix_view m = gsl_matrix_view_array(room, n, n);
    gsl_matrix_view vectors = gsl_matrix_view_array(room + n * n, n, n);
    gsl_vector_view values = gsl_vector_view_array(room + 2 * n * n, n);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(n);
    LAC_FAIL_MEMORY_IF(w == NULL, err);
    for (size_t k = 0; k < n; k++) {
        for (size_t l = 0; l < n; l++) {
            double unit_k = result->unknown[k].log ? 1.0 : fabs(result->unknown[k].best);
            double unit_l = result->unknown[l].log ? 1.0 : fabs(result->unknown[l].best);
            gsl_matrix_set(&m.matrix, k, l, c[k][l] / (unit_k * unit_l));
        }
    }
    (void)gsl_eigen_symmv(&m.matrix, &values.vector, &vectors.matrix, w);
    (void)gsl_eigen_symmv_sort(&values.vector, &vectors.matrix, GSL_EIGEN_SORT_VAL_DESC);
    for (size_t i = 0; i < n; i++) {
        put_axis(&vectors.matrix, i, gsl_vector_get(&values.vector, i), n, &result->axis[i]);
    }
    gsl_eigen_symmv_free(w);
    return LAC_OK;
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
    LAC_TRY_RETURN(find_axes(fit, c, result, err));
    return find_shape(fit, result, err);
}
