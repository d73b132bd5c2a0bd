// SPDX-License-Identifier: GPL-3.0-or-later
// Three readings on d = -B ln(tc - t) + A. With equal increments of displacement Saito's
//     tc - t1 = (t2 - t1)^2 / (2 (t2 - t1) - (t3 - t1))
// solves (tc - t2)^2 = (tc - t1)(tc - t3). Readings do not divide the displacement equally; solved
// is what his formula solves where they do:
//     (d3 - d1)/(d2 - d1) = ln((tc - t1)/(tc - t3)) / ln((tc - t1)/(tc - t2)).
#include <math.h>

#include "base/roots.h"
#include "forecast/kinds.h"

enum { HALVINGS = 200 };
static const double widest = 1e6; // remaining time over the window's length

// The left side less the right; t3 = 0. Falls as tc grows.
static double excess(double r, double t1, double t2)
{
    return log1p(-t1 / r) / log1p((t2 - t1) / (r - t2));
}

// Remaining time of three readings; NaN where no time is finite, 0 where it is over.
static double solve(double t1, double t2, double d1, double d2, double d3)
{
    const double ratio = (d3 - d1) / (d2 - d1);
    double low = log(-t1) - 40.0;
    double high = log(-t1 * widest);
    if (!(ratio > 1.0) || !(excess(exp(high), t1, t2) < ratio)) {
        return NAN;
    }
    for (int i = 0; i < HALVINGS && high - low > 0.0; i++) {
        lac_halve(&low, &high, excess(exp(0.5 * (low + high)), t1, t2) > ratio);
    }
    return exp(0.5 * (low + high));
}

// The inner reading nearest to half of the displacement.
static size_t middle_reading(const lac_window *w)
{
    const double *d = w->displacement;
    const double half = 0.5 * (d[0] + d[w->n - 1]);
    size_t best = 1;
    for (size_t i = 1; i + 1 < w->n; i++) {
        best = fabs(d[i] - half) < fabs(d[best] - half) ? i : best;
    }
    return best;
}

// Rms of all readings of the window about the curve through the three.
static void judge(const lac_window *w, double scale, lac_forecast_fit *fit)
{
    const double *d = w->displacement;
    double squares = 0.0;
    for (size_t i = 0; i < w->n; i++) {
        const double model =
            d[0] + scale * log((fit->remaining - w->time[0]) / (fit->remaining - w->time[i]));
        squares += (d[i] - model) * (d[i] - model);
    }
    fit->points = 3;
    fit->rms = sqrt(squares / (double)w->n);
    fit->rms_unit = "m";
    fit->misfit = fit->rms / fabs(d[w->n - 1] - d[0]);
}

static lac_status fit_three(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    const double *t = w->time;
    const double *d = w->displacement;
    const size_t k = middle_reading(w);
    const double end = d[w->n - 1];
    (void)err;
    if (!(t[w->n - 1] == 0.0)) {
        return lac_forecast_fit_refuse(fit, "the last reading has no displacement");
    }
    fit->remaining = solve(t[0], t[k], d[0], d[k], end);
    if (isnan(fit->remaining)) {
        return lac_forecast_fit_refuse(
            fit, "the second half of the displacement took longer than the first");
    }
    const double scale = (end - d[0]) / log1p(-t[0] / fit->remaining);
    judge(w, scale, fit);
    // each of the three readings moved by the noise, or by the curve's misfit where that is larger
    const double noise = fmax(isnan(w->noise) ? 0.0 : w->noise, fit->rms);
    const double at = log(fit->remaining);
    const double moved[3] = {log(solve(t[0], t[k], d[0] + noise, d[k], end)),
                             log(solve(t[0], t[k], d[0], d[k] + noise, end)),
                             log(solve(t[0], t[k], d[0], d[k], end - noise))};
    double variance = 0.0;
    for (int i = 0; i < 3; i++) {
        const double step = isfinite(moved[i]) ? moved[i] - at : 1.0;
        variance += step * step;
    }
    fit->error = sqrt(variance);
    lac_forecast_fit_add(fit, "scale_m", scale);
    return LAC_OK;
}

const lac_forecast_kind lac_forecast_saito = {
    .info =
        LAC_ABOUT("saito", "three points of equal displacement",
                  "Saito (1969), Proc. 7th Int. Conf. Soil Mech. Found. Eng., Mexico, 2, 677-683"),
    .estimator = "the log law through the first and the last reading of the window and the one "
                 "nearest to half of the displacement",
    .least = 5,
    .displacements = true,
    .worst = 0.04,
    .calibration = {0.0, 1.2, -1.093, -0.661, -0.4355, -0.210, 0.013},
    .fit = fit_three,
};
