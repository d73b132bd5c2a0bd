// SPDX-License-Identifier: GPL-3.0-or-later
// Draws of the posterior run on to time.end: quantiles of displacement and rate, and when they
// fail.
#include <omp.h>

#include "base/rng.h"
#include "base/statistics.h"
#include "fit/internal.h"

enum { TIMES = 200, MOST_DRAWS = 1000 };
enum { COLUMNS = 7 };         // of what is kept of the rows of the file
enum { TOLD = 4 };            // of what is told of the readings by a draw
enum { MOST_TOLD = 1 << 21 }; // numbers of each

static double log_normal(double z, double sigma)
{
    return -0.5 * z * z - log(sigma) - 0.91893853320467274178; // ln(2 pi)/2
}

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
    size_t told, stride;  // draws that are told of the readings, each of so many
    double *reading;      // [TOLD][told][readings]
} prediction;

// The i-th of `seen` times that are the readings' and some between these, or as many of them as
// there is room for: in a laboratory friction moves within a second of a step.
static double time_between(const lac_fit_data *data, size_t i, size_t seen)
{
    const size_t gaps = data->n - 1, steps = seen - 1, k = i * gaps / steps;
    const size_t first = (k * steps + gaps - 1) / gaps;
    const size_t next = ((k + 1) * steps + gaps - 1) / gaps;
    const double share = (double)(i - first) / (double)(next - first);
    return data->time[k] + share * (data->time[k + 1] - data->time[k]);
}

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
        p->time[i] = i >= seen - 1      ? last + (on - last) * (i - seen + 1) / (TIMES - seen)
                     : p->fit->friction ? time_between(data, (size_t)i, (size_t)seen)
                                        : first + (last - first) * i / (seen - 1);
    }
    p->time[TIMES - 1] = on;
}

// What a draw predicts of the readings, errors included, and how likely it makes them: of an error
// that is correlated given the one before (docs/theory/fitting.md eq. 3), with an offset drawn too.
static void foretell(const prediction *p, size_t draw, const lac_fit_errors_at *errors,
                     double offset, const double *slip, const double *log_rate)
{
    const uint64_t apart = (UINT64_C(1) << 59) + draw; // from the numbers of the sampler
    const uint64_t seed = (uint64_t)p->fit->def->seed;
    const lac_fit_data *data = &p->fit->data;
    const size_t n = data->n;
    double *out[TOLD], z[2], made = 0.0, seen = 0.0, last = -INFINITY;
    for (size_t k = 0; k < TOLD; k++) {
        out[k] = p->reading + (k * p->told + draw / p->stride) * n;
    }
    for (size_t i = 0; i < n; i++) {
        const bool slides = !isnan(data->displacement[i]);
        const double s = errors->displacement * data->sigma[i], by = errors->velocity;
        const double rho = errors->time > 0.0 ? exp(-(data->time[i] - last) / errors->time) : 0.0;
        const double rest = sqrt(1.0 - rho * rho), before = seen;
        lac_random_normal(seed, LAC_STREAM_SAMPLER, apart, i, z);
        made = slides ? rho * made + rest * z[0] : made;
        seen = slides ? (data->displacement[i] - slip[i] - offset) / s : seen;
        last = slides ? data->time[i] : last;
        out[0][i] = slides ? slip[i] + offset + s * made : NAN;
        out[1][i] = slides ? log_normal((seen - rho * before) / rest, s * rest) : NAN;
        out[2][i] = isnan(data->log_rate[i]) ? NAN : exp(log_rate[i] + by * z[1]);
        out[3][i] = log_normal((data->log_rate[i] - log_rate[i]) / by, by);
    }
}

// An offset of the draw: normal about its best, as wide as all readings together know it.
static double draw_offset(const lac_fit_model *model, const lac_fit_errors_at *errors, size_t draw,
                          double best)
{
    const lac_fit_data *data = &model->fit->data;
    double z[2];
    lac_fit_whiten_one(data, errors, model->scratch);
    const double weight = lac_dot(data->n, model->scratch, model->scratch);
    lac_random_normal((uint64_t)model->fit->def->seed, LAC_STREAM_SAMPLER,
                      (UINT64_C(1) << 59) + draw, data->n, z);
    return model->fit->offset && weight > 0.0 ? best + z[0] / sqrt(weight) : best;
}

// Displacement [TIMES], rate and time of failure at unknowns x, put in the place of the draw; what
// cannot be run fails at once. @param draw  p->draws: the best fit
static void look(const prediction *p, int thread, const double *x, size_t draw)
{
    double *displacement = p->displacement + draw * TIMES, *rate = p->rate + draw * TIMES;
    const bool drawn = draw < p->draws;
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
    if (drawn && p->told > 0 && draw % p->stride == 0 && whole) {
        foretell(p, draw, &errors, draw_offset(model, &errors, draw, offset), slip, log_rate);
    }
    for (size_t k = 0; k < data->rates && drawn; k++) {
        p->rank[draw * data->rates + k] =
            whole ? lac_fit_rate_rank(data, &data->rate[k], errors.velocity, log_rate) : NAN;
    }
    lac_sensitivity seen = {.slip = later, .log_rate = later_rate};
    (void)lac_fit_model_run(model, x, fit->source->run.end, TIMES, p->time, &seen, NULL);
    for (size_t i = 0; i < TIMES; i++) {
        displacement[i] = i < seen.reached ? later[i] + offset : INFINITY;
        rate[i] = i < seen.reached ? exp(later_rate[i]) : INFINITY;
    }
    if (drawn) {
        p->failure[draw] = seen.failed ? seen.failure_time : NAN;
    }
}

static lac_status allocate(prediction *p, lac_error *err)
{
    lac_fit *fit = p->fit;
    size_t n = fit->data.n;
    size_t kept = TIMES * (2 + 2 * LAC_FIT_QUANTILES) + COLUMNS * fit->data.rows;
    size_t whole = (p->draws + 1) * TIMES;
    if (fit->data.rates == 0 && p->draws > 0) { // else ranks tell of the readings
        p->stride = 1 + (p->draws * n - 1) / MOST_TOLD;
        p->told = (p->draws - 1) / p->stride + 1;
    }
    const size_t told = TOLD * p->told * n;
    fit->kept = calloc(kept + p->draws + told, sizeof *fit->kept);
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
    p->reading = p->failure + p->draws;
    for (size_t i = 0; i < told; i++) {
        p->reading[i] = NAN;
    }
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
        look(p, omp_get_thread_num(), chain->x + which * chain->dimension, (size_t)i);
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
    const size_t each = p->told * p->fit->data.n;
    result->told = p->told;
    result->told_reading = p->reading;
    result->likely_reading = p->reading + each;
    result->told_rate = p->reading + 2 * each;
    result->likely_rate = p->reading + 3 * each;
}

lac_status lac_fit_predict(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                           lac_error *err)
{
    const lac_chain *chain = fit->chain;
    prediction p = {.fit = fit};
    lac_status status = LAC_OK;
    size_t all = chain != NULL ? chain->walkers * chain->steps : 0;
    p.draws = all < MOST_DRAWS ? all : MOST_DRAWS;
    LAC_TRY(allocate(&p, err));
    choose_times(&p);
    double *fitted = p.time + TIMES;
    look(&p, 0, fit->best, p.draws);
    for (size_t i = 0; i < TIMES; i++) {
        const double best = p.displacement[p.draws * TIMES + i];
        fitted[i] = isinf(best) ? NAN : best;
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
