// SPDX-License-Identifier: GPL-3.0-or-later
// Draws of the posterior run on to time.end: quantiles of displacement and rate, and when they
// fail.
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "fit/internal.h"

enum { TIMES = 200, MOST_DRAWS = 1000 };

// What the draws come to.
typedef struct prediction {
    lac_fit *fit;
    size_t draws;
    double *time;         // [TIMES]
    double *displacement; // [draws][TIMES]; INFINITY beyond the failure
    double *rate;         // [draws][TIMES]
    double *failure;      // [draws]; NaN: not by time.end
    double *room;         // [threads][2 readings + 2 TIMES]
} prediction;

// From the first reading on, three quarters of the times up to the last one, the rest as far again
// by a half, or to the end.
static void choose_times(const prediction *p)
{
    const lac_fit_data *data = &p->fit->data;
    const int seen = TIMES * 3 / 4;
    double first = data->time[0];
    double last = data->time[data->n - 1];
    double on = fmin(p->fit->source->run.end, last + 0.5 * (last - first));
    for (int i = 0; i < TIMES; i++) {
        p->time[i] = i < seen ? first + (last - first) * i / (seen - 1)
                              : last + (on - last) * (i - seen + 1) / (TIMES - seen);
    }
    p->time[seen - 1] = last;
    p->time[TIMES - 1] = on;
}

// Displacement [TIMES], rate and time of failure at unknowns x; what cannot be run fails at once.
static void look(const prediction *p, int thread, const double *x, double *displacement,
                 double *rate, double *failure)
{
    lac_fit *fit = p->fit;
    const lac_fit_data *data = &fit->data;
    lac_fit_model *model = &fit->model[thread];
    double *slip = p->room + (size_t)thread * (2 * data->n + 2 * TIMES);
    double *log_rate = slip + data->n;
    double *later = log_rate + data->n;
    double *later_rate = later + TIMES;
    const bool whole = lac_fit_model_read(model, x, slip, log_rate, NULL) == LAC_OK;
    lac_fit_errors_at errors = lac_fit_errors_of(fit, x);
    double offset = 0.0;
    if (whole && data->displacements > 0) {
        offset = lac_fit_likelihood(fit, &errors, slip, log_rate, model->scratch).offset;
    }
    lac_sensitivity seen = {.slip = later, .log_rate = later_rate};
    (void)lac_fit_model_run(model, x, fit->source->run.end, TIMES, p->time, &seen, NULL);
    for (size_t i = 0; i < TIMES; i++) {
        displacement[i] = i < seen.reached ? later[i] + offset : INFINITY;
        rate[i] = i < seen.reached ? exp(later_rate[i]) : INFINITY;
    }
    *failure = seen.failed ? seen.failure_time : NAN;
}

static lac_status allocate(prediction *p, lac_error *err)
{
    lac_fit *fit = p->fit;
    size_t n = fit->data.n;
    size_t kept = TIMES * (2 + 2 * LAC_FIT_QUANTILES) + 3 * n;
    fit->kept = calloc(kept, sizeof *fit->kept);
    fit->draws = calloc(p->draws + 1, sizeof *fit->draws);
    p->displacement = malloc((p->draws + 1) * TIMES * sizeof *p->displacement);
    p->rate = malloc((p->draws + 1) * TIMES * sizeof *p->rate);
    p->room = malloc((size_t)fit->threads * (2 * n + 2 * TIMES) * sizeof *p->room);
    LAC_FAIL_MEMORY_IF(fit->kept == NULL || fit->draws == NULL || p->displacement == NULL ||
                           p->rate == NULL || p->room == NULL,
                       err);
    p->time = fit->kept;
    p->failure = fit->draws;
    return LAC_OK;
}

// Runs the draws, evenly taken from the chain.
static void run_draws(prediction *p, const lac_fit_watch *watch)
{
    const lac_chain *chain = p->fit->chain;
    const int draws = (int)p->draws;
    size_t all = draws > 0 ? chain->walkers * chain->steps : 0;
    size_t done = 0;
#pragma omp parallel for schedule(dynamic) num_threads(p->fit->threads)
    for (int i = 0; i < draws; i++) {
        size_t which = (size_t)i * all / p->draws;
        size_t now;
#pragma omp atomic capture
        now = done++;
        if (omp_get_thread_num() == 0) {
            lac_fit_tell(watch, "draws run on", now, p->draws);
        }
        look(p, omp_get_thread_num(), chain->x + which * chain->dimension,
             p->displacement + (size_t)i * TIMES, p->rate + (size_t)i * TIMES, &p->failure[i]);
    }
    p->fit->runs += 2 * (int64_t)p->draws;
}

// Quantiles of the failure times, INFINITY for draws that do not fail.
static lac_status sum_failures(const prediction *p, lac_fit_result *result, lac_error *err)
{
    size_t failing = 0;
    double *t = malloc(p->draws * sizeof *t);
    LAC_FAIL_MEMORY_IF(t == NULL, err);
    for (size_t i = 0; i < p->draws; i++) {
        bool fails = !isnan(p->failure[i]);
        failing += fails ? 1 : 0;
        t[i] = fails ? p->failure[i] : INFINITY;
    }
    lac_fit_quantiles(p->draws, t, result->failures.quantile);
    result->failing = (double)failing / (double)p->draws;
    free(t);
    return LAC_OK;
}

// Quantiles over the draws at every time. @param out  [LAC_FIT_QUANTILES][TIMES]
static lac_status sum_series(const prediction *p, const double *of, double *out, lac_error *err)
{
    double quantile[LAC_FIT_QUANTILES];
    double *column = malloc(p->draws * sizeof *column);
    LAC_FAIL_MEMORY_IF(column == NULL, err);
    for (size_t i = 0; i < TIMES; i++) {
        for (size_t k = 0; k < p->draws; k++) {
            column[k] = of[k * TIMES + i];
        }
        lac_fit_quantiles(p->draws, column, quantile);
        for (size_t q = 0; q < LAC_FIT_QUANTILES; q++) {
            out[q * TIMES + i] = quantile[q];
        }
    }
    free(column);
    return LAC_OK;
}

static void keep_readings(const lac_fit *fit, double *to, lac_fit_result *result)
{
    const lac_fit_data *data = &fit->data;
    size_t n = data->n;
    memcpy(to, data->time, n * sizeof *to);
    memcpy(to + n, data->displacement, n * sizeof *to);
    for (size_t i = 0; i < n; i++) {
        to[2 * n + i] = exp(data->log_rate[i]);
    }
    result->readings = n;
    result->reading_time = to;
    result->observed = to + n;
    result->observed_rate = to + 2 * n;
}

static lac_status sum_up(const prediction *p, lac_fit_result *result, lac_error *err)
{
    double *displacement = p->time + 2 * TIMES;
    double *rate = displacement + LAC_FIT_QUANTILES * TIMES;
    lac_status status = LAC_OK;
    LAC_TRY(sum_failures(p, result, err));
    LAC_TRY(sum_series(p, p->displacement, displacement, err));
    LAC_TRY(sum_series(p, p->rate, rate, err));
    result->displacement = displacement;
    result->rate = rate;
    result->draws = p->draws;
    result->draw_failure = p->failure;
out:
    return status;
}

lac_status lac_fit_predict(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                           lac_error *err)
{
    const lac_chain *chain = fit->chain;
    prediction p = {.fit = fit};
    lac_status status = LAC_OK;
    double ignored;
    size_t all = chain != NULL ? chain->walkers * chain->steps : 0;
    p.draws = all < MOST_DRAWS ? all : MOST_DRAWS;
    LAC_TRY(allocate(&p, err));
    choose_times(&p);
    double *fitted = p.time + TIMES;
    look(&p, 0, fit->best, fitted, p.rate + p.draws * TIMES, &ignored);
    for (size_t i = 0; i < TIMES; i++) {
        fitted[i] = isinf(fitted[i]) ? NAN : fitted[i];
    }
    result->times = TIMES;
    result->time = p.time;
    result->fitted = fitted;
    keep_readings(fit, p.time + TIMES * (2 + 2 * LAC_FIT_QUANTILES), result);
    if (p.draws > 0) {
        run_draws(&p, watch);
        LAC_TRY(sum_up(&p, result, err));
    }
out:
    free(p.displacement);
    free(p.rate);
    free(p.room);
    return status;
}
