// SPDX-License-Identifier: GPL-3.0-or-later
// How good the best fit is.
#include <math.h>
#include <stdlib.h>

#include "fit/internal.h"

// Correlation of successive residuals; beyond 2.33/sqrt(n) white errors would be so related in one
// of a hundred series.
static void look_for_memory(const lac_fit_data *data, const double *r, lac_fit_result *result)
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
    result->autocorrelation = squares > 0.0 ? products / squares : 0.0;
    result->poor = result->autocorrelation > 2.33 / sqrt((double)data->displacements);
}

static void measure(lac_fit *fit, double *slip, double *log_rate, lac_fit_result *result)
{
    const lac_fit_data *data = &fit->data;
    double squares = 0.0;
    double log_squares = 0.0;
    lac_fit_errors_at errors = lac_fit_errors_of(fit, fit->best);
    errors.time = 0.0;
    lac_fit_misfit misfit =
        lac_fit_likelihood(fit, &errors, slip, log_rate, fit->model[0].scratch + 2 * data->n);
    result->log_likelihood = misfit.log_likelihood;
    result->offset = misfit.offset;
    for (size_t i = 0; i < data->n; i++) {
        double by = data->log_rate[i] - log_rate[i];
        slip[i] = data->displacement[i] - slip[i] - misfit.offset;
        squares += isnan(slip[i]) ? 0.0 : slip[i] * slip[i];
        log_squares += isnan(by) ? 0.0 : by * by;
    }
    if (data->displacements > 0) {
        result->displacement_rms = sqrt(squares / (double)data->displacements);
        look_for_memory(data, slip, result);
    }
    if (data->velocities > 0) {
        result->log_rate_rms = sqrt(log_squares / (double)data->velocities);
    }
}

// When the best fit fails, and how far that is known from the least squares alone.
static lac_status find_failure(lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    double by[LAC_MOST_FITTED];
    double variance = 0.0;
    lac_follow seen = {.failure_by = by};
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

lac_status lac_fit_judge(lac_fit *fit, lac_fit_result *result, lac_error *err)
{
    const lac_fit_data *data = &fit->data;
    double *slip = fit->model[0].scratch;
    double *log_rate = slip + data->n;
    lac_follow seen = {.slip = slip, .log_rate = log_rate};
    // As exact as it was found: it may fail close behind the last reading.
    lac_fit_model_tighten(&fit->model[0], true);
    lac_status status = lac_fit_model_run(&fit->model[0], fit->best, data->time[data->n - 1],
                                          data->n, data->time, &seen, err);
    lac_fit_model_tighten(&fit->model[0], false);
    if (status == LAC_OK && seen.reached < data->n) {
        status = lac_fail(err, LAC_ENUMERIC, "the best fit fails before the last reading");
    }
    if (status != LAC_OK) {
        return status;
    }
    measure(fit, slip, log_rate, result);
    for (size_t k = 0; k < fit->unknowns; k++) {
        lac_fit_unknown *x = &result->unknown[k];
        bool parameter = k < fit->def->count;
        x->best = lac_fit_value(x->log, fit->best[k]);
        x->by = parameter ? fit->by[k] : LAC_BY_NOTHING;
        x->error = parameter ? sqrt(fit->covariance[k][k]) : NAN;
    }
    return find_failure(fit, result, err);
}
