// SPDX-License-Identifier: GPL-3.0-or-later
// Draws of the posterior run on to time.end: quantiles of displacement and rate, and when they
// fail.
#include <math.h>
#include <omp.h>
#include <stdlib.h>

#include "fit/internal.h"

enum { TIMES = 200, MOST_DRAWS = 1000 };
enum { COLUMNS = 7 }; // of what is kept of the rows of the file

// What the draws come to.
typedef struct prediction {
    lac_fit *fit;
    size_t draws;
    double *time;         // [TIMES]
    double *displacement; // [draws][TIMES]; INFINITY beyond the failure
    double *rate;         // [draws][TIMES]
    double *failure;      // [draws]; NaN: not by time.end
    double *rank;         // [draws][rates] of rates.c
    double *column;       // [draws] work
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
                 double *rate, double *failure, double *rank)
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
    for (size_t k = 0; k < data->rates && rank != NULL; k++) {
        rank[k] = whole ? lac_fit_rate_rank(data, &data->rate[k], errors.velocity, log_rate) : NAN;
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
    size_t kept = TIMES * (2 + 2 * LAC_FIT_QUANTILES) + COLUMNS * fit->data.rows;
    size_t whole = (p->draws + 1) * TIMES;
    fit->kept = calloc(kept + p->draws, sizeof *fit->kept);
    const size_t ranks = p->draws * fit->data.rates;
    p->displacement =
        malloc((2 * whole + p->draws + ranks + (size_t)fit->threads * (2 * n + 2 * TIMES)) *
               sizeof(double));
    LAC_FAIL_MEMORY_IF(fit->kept == NULL || p->displacement == NULL, err);
    p->rate = p->displacement + whole;
    p->column = p->rate + whole;
    p->rank = p->column + p->draws;
    p->room = p->rank + ranks;
    p->time = fit->kept;
    p->failure = fit->kept + kept;
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
             p->displacement + (size_t)i * TIMES, p->rate + (size_t)i * TIMES, &p->failure[i],
             p->rank + (size_t)i * p->fit->data.rates);
    }
    p->fit->runs += 2 * (int64_t)p->draws;
}

// Quantiles of the failure times, INFINITY for draws that do not fail.
static void sum_failures(const prediction *p, lac_fit_result *result)
{
    size_t failing = 0;
    for (size_t i = 0; i < p->draws; i++) {
        bool fails = !isnan(p->failure[i]);
        failing += fails ? 1 : 0;
        p->column[i] = fails ? p->failure[i] : INFINITY;
    }
    lac_fit_quantiles(p->draws, p->column, result->failures.quantile);
    result->failing = (double)failing / (double)p->draws;
}

// Quantiles over the draws at every time. @param out  [LAC_FIT_QUANTILES][TIMES]
static void sum_series(const prediction *p, const double *of, double *out)
{
    double quantile[LAC_FIT_QUANTILES];
    for (size_t i = 0; i < TIMES; i++) {
        for (size_t k = 0; k < p->draws; k++) {
            p->column[k] = of[k * TIMES + i];
        }
        lac_fit_quantiles(p->draws, p->column, quantile);
        for (size_t q = 0; q < LAC_FIT_QUANTILES; q++) {
            out[q * TIMES + i] = quantile[q];
        }
    }
}

// The rows of the file as they stand there. @param to  [COLUMNS][rows]
static void keep_readings(const lac_fit *fit, double *to, lac_fit_result *result)
{
    const lac_fit_data *data = &fit->data;
    const size_t n = data->rows;
    for (size_t i = 0; i < n; i++) {
        const lac_fit_seen *row = &data->seen[i];
        to[i] = row->time;
        to[n + i] = row->displacement;
        to[2 * n + i] = exp(log(row->velocity)); // to the bit what the fit saw
        to[3 * n + i] = row->most;
        to[4 * n + i] = row->within;
        to[5 * n + i] = NAN;
        to[6 * n + i] = NAN;
    }
    result->readings = n;
    result->windows = data->rates > 0;
    result->reading_time = to;
    result->observed = to + n;
    result->observed_rate = to + 2 * n;
    result->observed_most = to + 3 * n;
    result->reading_within = to + 4 * n;
    result->rate_rank = to + 5 * n;
    result->most_kept = to + 6 * n;
}

// What share of what the posterior predicts lies below each rate, and keeps each bound.
static void sum_ranks(const prediction *p, double *rate_rank, double *most_kept)
{
    const lac_fit_data *data = &p->fit->data;
    for (size_t k = 0; k < data->rates; k++) {
        double sum = 0.0, whole = 0.0;
        for (size_t i = 0; i < p->draws; i++) {
            const double rank = p->rank[i * data->rates + k];
            sum += isnan(rank) ? 0.0 : rank;
            whole += isnan(rank) ? 0.0 : 1.0;
        }
        (data->rate[k].bound ? most_kept : rate_rank)[data->rate[k].row] = sum / whole;
    }
}

static void sum_up(const prediction *p, lac_fit_result *result)
{
    double *displacement = p->time + 2 * TIMES;
    double *rate = displacement + LAC_FIT_QUANTILES * TIMES;
    double *readings = p->time + TIMES * (2 + 2 * LAC_FIT_QUANTILES);
    const size_t n = p->fit->data.rows;
    sum_failures(p, result);
    sum_ranks(p, readings + 5 * n, readings + 6 * n);
    sum_series(p, p->displacement, displacement);
    sum_series(p, p->rate, rate);
    result->displacement = displacement;
    result->rate = rate;
    result->draws = p->draws;
    result->draw_failure = p->failure;
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
    look(&p, 0, fit->best, fitted, p.rate + p.draws * TIMES, &ignored, NULL);
    for (size_t i = 0; i < TIMES; i++) {
        fitted[i] = isinf(fitted[i]) ? NAN : fitted[i];
    }
    result->times = TIMES;
    result->time = p.time;
    result->fitted = fitted;
    keep_readings(fit, p.time + TIMES * (2 + 2 * LAC_FIT_QUANTILES), result);
    if (p.draws > 0) {
        run_draws(&p, watch);
        sum_up(&p, result);
    }
out:
    free(p.displacement);
    return status;
}
