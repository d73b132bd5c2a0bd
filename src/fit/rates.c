// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities with errors of their own, upper bounds of velocities, and times that are known within
// a window only: what they say of a run. docs/theory/fitting.md eqs 9 to 11.
#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_erf.h>

#include "base/statistics.h"
#include "fit/internal.h"

static const double log_two_pi = 1.8378770664093454836;

enum { NARROWINGS = 60 };

bool lac_fit_has_rates(const lac_fit_def *def)
{
    return def->columns.velocity_sigma != NULL || def->columns.velocity_most != NULL ||
           def->columns.within != NULL;
}

// Where a rate is looked at: at its time; over a window at the nodes of a Gauss-Legendre rule, or,
// for a bound, evenly from end to end.
static size_t choose_nodes(const lac_fit_seen *row, bool bound, double end, double *time)
{
    const double from = fmax(row->time - row->within, 0.0);
    const double to = fmin(row->time + row->within, end);
    if (!(row->within > 0.0)) {
        time[0] = row->time;
        return 1;
    }
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(LAC_FIT_NODES);
    for (size_t i = 0; i < LAC_FIT_NODES; i++) {
        double weight;
        time[i] = from + (to - from) * (double)i / (LAC_FIT_NODES - 1);
        if (!bound && rule != NULL) {
            (void)gsl_integration_glfixed_point(from, to, i, &time[i], &weight, rule);
        }
    }
    gsl_integration_glfixed_table_free(rule);
    return LAC_FIT_NODES;
}

// Weights of the nodes, the sum of which is 1.
static bool weigh_nodes(double *weight)
{
    gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(LAC_FIT_NODES);
    double ignored;
    for (size_t i = 0; i < LAC_FIT_NODES && rule != NULL; i++) {
        (void)gsl_integration_glfixed_point(0.0, 1.0, i, &ignored, &weight[i], rule);
    }
    gsl_integration_glfixed_table_free(rule);
    return rule != NULL;
}

// One look at the run: when, for whom, and what was read at that very time.
typedef struct look {
    double time, displacement, sigma; // the time first: lac_by_first
    lac_fit_rate *of;                 // NULL: a displacement
    size_t node;
} look;

static size_t add_rate(lac_fit_data *data, const lac_fit_seen *row, bool bound, double end,
                       look *looks)
{
    double time[LAC_FIT_NODES];
    lac_fit_rate *rate = &data->rate[data->rates++];
    *rate = (lac_fit_rate){.value = log(bound ? row->most : row->velocity),
                           .sigma = row->rate_sigma,
                           .bound = bound,
                           .row = (size_t)(row - data->seen)};
    rate->count = choose_nodes(row, bound, end, time);
    for (size_t j = 0; j < rate->count; j++) {
        looks[j] =
            (look){.time = time[j], .displacement = NAN, .sigma = 1.0, .of = rate, .node = j};
    }
    return rate->count;
}

// Rows for the run in the order of time, each time once.
static void put_looks(lac_fit_data *data, size_t n, look *looks)
{
    qsort(looks, n, sizeof *looks, lac_by_first);
    data->n = 0;
    for (size_t i = 0; i < n; i++) {
        const bool same = data->n > 0 && looks[i].time == data->time[data->n - 1];
        const size_t at = same ? data->n - 1 : data->n++;
        if (!same) {
            data->time[at] = looks[i].time;
            data->displacement[at] = NAN;
            data->log_rate[at] = NAN;
            data->sigma[at] = 1.0;
        }
        if (looks[i].of != NULL) {
            looks[i].of->at[looks[i].node] = at;
        } else {
            data->displacement[at] = looks[i].displacement;
            data->sigma[at] = looks[i].sigma;
        }
    }
}

lac_status lac_fit_look_at_rates(lac_fit_data *data, double end, lac_error *err)
{
    size_t n = 0;
    const size_t most = data->rows * (1 + 2 * LAC_FIT_NODES) + 1;
    look *looks = calloc(most, sizeof *looks);
    data->rate = calloc(2 * data->rows + 1, sizeof *data->rate);
    if (looks == NULL || data->rate == NULL || !weigh_nodes(data->weight)) {
        free(looks);
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < data->rows; i++) {
        const lac_fit_seen *row = &data->seen[i];
        if (!isnan(row->displacement)) {
            looks[n++] =
                (look){.time = row->time, .displacement = row->displacement, .sigma = row->sigma};
        }
        n += isnan(row->velocity) ? 0 : add_rate(data, row, false, end, looks + n);
        n += isnan(row->most) ? 0 : add_rate(data, row, true, end, looks + n);
    }
    put_looks(data, n, looks);
    free(looks);
    return LAC_OK;
}

// ln of the share of a normal density beyond x.
static double log_tail(double x) { return gsl_sf_log_erfc(x / sqrt(2.0)) - log(2.0); }

// The node of the largest rate.
static size_t find_fastest(const lac_fit_rate *rate, const double *log_rate)
{
    size_t best = 0;
    for (size_t j = 1; j < rate->count; j++) {
        best = log_rate[rate->at[j]] > log_rate[rate->at[best]] ? j : best;
    }
    return best;
}

// Where within the window a velocity was read, after seeing it. @param share  [count] sums to 1
// @return ln of the mean of exp(-z^2/2)
static double share_out(const lac_fit_data *data, const lac_fit_rate *rate, double s,
                        const double *log_rate, double *share)
{
    double least = INFINITY, sum = 0.0;
    for (size_t j = 0; j < rate->count; j++) {
        const double z = (rate->value - log_rate[rate->at[j]]) / s;
        share[j] = 0.5 * z * z;
        least = fmin(least, share[j]);
    }
    for (size_t j = 0; j < rate->count; j++) {
        share[j] = (rate->count > 1 ? data->weight[j] : 1.0) * exp(least - share[j]);
        sum += share[j];
    }
    for (size_t j = 0; j < rate->count; j++) {
        share[j] /= sum;
    }
    return log(sum) - least;
}

// ln of how likely it is, but for the constant of a normal density.
static double fit_of(const lac_fit_data *data, const lac_fit_rate *rate, double s,
                     const double *log_rate)
{
    double share[LAC_FIT_NODES];
    if (!rate->bound) {
        return share_out(data, rate, s, log_rate, share);
    }
    const double v = log_rate[rate->at[find_fastest(rate, log_rate)]];
    return log_tail((v - rate->value) / s);
}

double lac_fit_rates_likelihood(const lac_fit_data *data, double error, const double *log_rate)
{
    double sum = 0.0;
    for (size_t k = 0; k < data->rates; k++) {
        const lac_fit_rate *rate = &data->rate[k];
        const double s = error * rate->sigma;
        sum += fit_of(data, rate, s, log_rate);
        sum -= rate->bound ? 0.0 : 0.5 * log_two_pi + log(s);
    }
    return sum;
}

double lac_fit_rate_residual(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                             const double *log_rate)
{
    if (rate->count == 1 && !rate->bound) {
        return (log_rate[rate->at[0]] - rate->value) / (error * rate->sigma);
    }
    return sqrt(fmax(-2.0 * fit_of(data, rate, error * rate->sigma, log_rate), 0.0));
}

double lac_fit_rate_slope(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                          const double *log_rate, const double *by, size_t stride)
{
    const double s = error * rate->sigma;
    const double r = lac_fit_rate_residual(data, rate, error, log_rate);
    double share[LAC_FIT_NODES];
    double slope = 0.0;
    if (rate->count == 1 && !rate->bound) {
        return by[rate->at[0] * stride] / s;
    }
    if (rate->bound) {
        const size_t at = rate->at[find_fastest(rate, log_rate)];
        const double x = (log_rate[at] - rate->value) / s;
        const double hazard = exp(-0.5 * (x * x + log_two_pi) - log_tail(x));
        return r > 1e-8 ? hazard / (r * s) * by[at * stride] : 0.0;
    }
    (void)share_out(data, rate, s, log_rate, share);
    for (size_t j = 0; j < rate->count; j++) {
        const double z = (rate->value - log_rate[rate->at[j]]) / s;
        slope -= share[j] * z / fmax(r, 1e-8) * by[rate->at[j] * stride] / s;
    }
    return slope;
}

double lac_fit_rate_off(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                        const double *log_rate)
{
    double share[LAC_FIT_NODES];
    double off = 0.0;
    if (rate->bound) {
        return fmin(rate->value - log_rate[rate->at[find_fastest(rate, log_rate)]], 0.0);
    }
    (void)share_out(data, rate, error * rate->sigma, log_rate, share);
    for (size_t j = 0; j < rate->count; j++) {
        off += share[j] * (rate->value - log_rate[rate->at[j]]);
    }
    return off;
}

double lac_fit_rate_rank(const lac_fit_data *data, const lac_fit_rate *rate, double error,
                         const double *log_rate)
{
    const double s = error * rate->sigma * sqrt(2.0);
    double below = 0.0;
    if (rate->bound) {
        const double v = log_rate[rate->at[find_fastest(rate, log_rate)]];
        return 0.5 * erfc((v - rate->value) / s);
    }
    for (size_t j = 0; j < rate->count; j++) {
        const double weight = rate->count > 1 ? data->weight[j] : 1.0;
        below += weight * 0.5 * erfc((log_rate[rate->at[j]] - rate->value) / s);
    }
    return below;
}

double lac_fit_likeliest_rate_error(const lac_fit_data *data, const double *log_rate, double low,
                                    double high)
{
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    for (int i = 0; i < NARROWINGS; i++) {
        const double a = high - golden * (high - low);
        const double b = low + golden * (high - low);
        const bool lower = lac_fit_rates_likelihood(data, exp(a), log_rate) >
                           lac_fit_rates_likelihood(data, exp(b), log_rate);
        high = lower ? b : high;
        low = lower ? low : a;
    }
    return 0.5 * (low + high);
}
