// SPDX-License-Identifier: GPL-3.0-or-later
// The errors of the readings for which given residuals are likeliest, by the likelihood that the
// sampler takes (docs/theory/fitting.md eq. 4).
#include <math.h>

#include "fit/internal.h"

enum { GRID = 33, NARROWINGS = 40 };

// Residuals of displacements and how likely they are.
typedef struct guess {
    const lac_fit *fit;
    const double *r; // before the offset
    double *scratch; // [2 readings]
    double held;     // standard error, or the factor on a column; NaN: the likeliest is taken
    double scale;    // the one taken
} guess;

// ln of the likelihood but for constants, with errors correlated over `time`; sets the scale.
static double likelihood(guess *g, double time)
{
    const lac_fit_data *data = &g->fit->data;
    const lac_fit_errors_at unit = {.displacement = 1.0, .time = time};
    double *w = g->scratch;
    double *e = g->scratch + data->n;
    double ee = 0.0;
    double squares = 0.0;
    double log_det = lac_fit_whiten(data, &unit, g->r, w);
    if (g->fit->def->offset) {
        for (size_t i = 0; i < data->n; i++) {
            e[i] = 1.0;
        }
        (void)lac_fit_whiten(data, &unit, e, e);
        (void)lac_fit_take_offset(data->n, e, w, &ee);
    }
    for (size_t i = 0; i < data->n; i++) {
        squares += w[i] * w[i];
    }
    double n = (double)data->displacements - (ee > 0.0 ? 1.0 : 0.0);
    g->scale = isnan(g->held) ? sqrt(squares / n) : g->held;
    return -0.5 * squares / (g->scale * g->scale) - n * log(g->scale) - 0.5 * log_det -
           (ee > 0.0 ? 0.5 * log(ee) : 0.0);
}

// The likeliest correlation time: the best of a grid, then golden sections about it.
static double find_time(guess *g, double low, double high)
{
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double step = (high - low) / (GRID - 1);
    double best = -INFINITY;
    double at = low;
    for (int i = 0; i < GRID; i++) {
        double found = likelihood(g, exp(low + step * i));
        at = found > best ? low + step * i : at;
        best = fmax(best, found);
    }
    double left = fmax(at - step, low);
    double right = fmin(at + step, high);
    for (int i = 0; i < NARROWINGS; i++) {
        double a = right - golden * (right - left);
        double b = left + golden * (right - left);
        bool lower = likelihood(g, exp(a)) > likelihood(g, exp(b));
        right = lower ? b : right;
        left = lower ? left : a;
    }
    return 0.5 * (left + right);
}

static double within(const lac_fit *fit, int k, double u)
{
    return fmin(fmax(u, fit->low[k]), fit->high[k]);
}

void lac_fit_likeliest_errors(const lac_fit *fit, const double *r, const double *by_log_rate,
                              double *scratch, double *x)
{
    const lac_fit_data *data = &fit->data;
    const int of = fit->unknown_displacement;
    guess g = {.fit = fit, .r = r, .scratch = scratch};
    g.held = of < 0 ? fit->def->displacement_error : NAN;
    double time = 0.0;
    if (fit->unknown_time >= 0) {
        int k = fit->unknown_time;
        x[k] = find_time(&g, fit->low[k], fit->high[k]);
        time = exp(x[k]);
    }
    if (of >= 0) {
        (void)likelihood(&g, time);
        x[of] = within(fit, of, log(g.scale));
    }
    if (fit->unknown_velocity >= 0) {
        double squares = 0.0;
        for (size_t i = 0; i < data->n; i++) {
            squares += isnan(by_log_rate[i]) ? 0.0 : by_log_rate[i] * by_log_rate[i];
        }
        x[fit->unknown_velocity] =
            within(fit, fit->unknown_velocity, 0.5 * log(squares / (double)data->velocities));
    }
}
