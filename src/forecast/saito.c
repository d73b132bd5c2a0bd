// SPDX-License-Identifier: GPL-3.0-or-later
// Three readings on d = -B ln(tc - t) + A. With equal increments of displacement Saito's
//     tc - t1 = (t2 - t1)^2 / (2 (t2 - t1) - (t3 - t1))
// solves (tc - t2)^2 = (tc - t1)(tc - t3). Readings do not divide the displacement equally; solved
// is what his formula solves where they do:
//     (d3 - d1)/(d2 - d1) = ln((tc - t1)/(tc - t3)) / ln((tc - t1)/(tc - t2)).
#include "base/roots.h"
#include "forecast/kinds.h"

enum { HALVINGS = 200, POINTS = 3 };
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
    double low = log(-t1) - 40.0, high = log(-t1 * widest);
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

// The log law through three readings.
typedef struct curve {
    double start, rest; // first time, last displacement
    double remaining, scale;
} curve;

// Through them as they are, or with one of them, `which` of POINTS, moved.
static curve curve_of(const lac_window *w, int which, double by)
{
    const size_t middle = middle_reading(w);
    const double d[POINTS] = {w->displacement[0] + (which == 0 ? by : 0.0),
                              w->displacement[middle] + (which == 1 ? by : 0.0),
                              w->displacement[w->n - 1] - (which == 2 ? by : 0.0)};
    curve c = {.start = w->time[0],
               .rest = d[2],
               .remaining = solve(w->time[0], w->time[middle], d[0], d[1], d[2])};
    c.scale = (d[2] - d[0]) / log1p(-c.start / c.remaining);
    return c;
}

static double value_at(const curve *c, double t)
{
    return c->rest - c->scale * log1p(-t / c->remaining);
}

// Mean square between two of them; 0 where one cannot be had.
static double square_off(const lac_window *w, const curve *a, const curve *b)
{
    double square = 0.0;
    for (size_t i = 0; i < w->n; i++) {
        const double off = value_at(a, w->time[i]) - value_at(b, w->time[i]);
        square += off * off / (double)w->n;
    }
    return isfinite(square) ? square : 0.0;
}

// All readings of the window about the curve. Their noise is in what they are off it, and in the
// three that it goes through, each of which counts as one degree of freedom.
static void judge(const lac_window *w, const curve *c, lac_forecast_fit *fit)
{
    const double n = (double)w->n;
    double squares = 0.0, noise = 0.0;
    double spread = 0.0; // variance of `noise`, halved
    curve moved[POINTS];
    for (int k = 0; k < POINTS; k++) {
        moved[k] = curve_of(w, k, w->noise);
    }
    for (size_t i = 0; i < w->n; i++) {
        const double off = w->displacement[i] - value_at(c, w->time[i]);
        const double error = w->error / w->weight[i];
        squares += off * off / n;
        noise += error * error / n;
    }
    spread = noise * noise / (n - POINTS);
    for (int k = 0; k < POINTS; k++) {
        const double part = square_off(w, c, &moved[k]);
        noise += part;
        spread += part * part;
    }
    fit->points = POINTS;
    fit->rms_unit = "m";
    lac_forecast_fit_weigh(fit, sqrt(squares), fabs(c->rest - w->displacement[0]), sqrt(noise),
                           noise * noise / spread);
}

static lac_status fit_three(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    (void)err;
    if (!(w->time[w->n - 1] == 0.0)) {
        return lac_forecast_fit_refuse(fit, "the last reading has no displacement");
    }
    const curve c = curve_of(w, POINTS, 0.0);
    fit->remaining = c.remaining;
    if (isnan(fit->remaining)) {
        return lac_forecast_fit_refuse(
            fit, "the second half of the displacement took longer than the first");
    }
    judge(w, &c, fit);
    // each of the three readings moved by the noise, or by the curve's misfit where that is larger
    const double by = fmax(isnan(w->noise) ? 0.0 : w->noise, fit->rms);
    double variance = 0.0;
    for (int k = 0; k < POINTS; k++) {
        const double step = log(curve_of(w, k, by).remaining) - log(c.remaining);
        variance += isfinite(step) ? step * step : 1.0;
    }
    fit->error = sqrt(variance);
    lac_forecast_fit_add(fit, "scale_m", c.scale);
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
    .calibration = {0.4, 1.6, -1.877, -1.169, -0.72, -0.249, 0.318},
    .fit = fit_three,
};
