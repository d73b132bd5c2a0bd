// SPDX-License-Identifier: GPL-3.0-or-later
// dv/dt = A v^alpha with alpha > 1: v = kappa (tc - t)^(-1/(alpha - 1)), integrated
//     d = D - C (tc - t)^q,  q = (alpha - 2)/(alpha - 1);  the log law is q = 0.
#include <math.h>

#include "forecast/project.h"

enum { GRID = 40, POWERS = 12 };
static const double lowest = -3.0, highest = 0.9;

// (z^q - 1)/q with z = (tc - t)/(tc - now), which goes over into ln z
static void curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    const double q = p[1];
    for (size_t i = 0; i < w->n; i++) {
        const double log_z = log1p(-w->time[i] * exp(-p[0]));
        columns[i] = 1.0;
        columns[w->n + i] = fabs(q * log_z) < 1e-12 ? -log_z : -expm1(q * log_z) / q;
    }
}

static double place(const lac_projection *self, size_t shape, double part)
{
    (void)self, (void)shape;
    return lowest + (highest - lowest) * part;
}

// Slope of ln(dv/dt) on ln v by ordinary least squares, over the pairs of successive velocities
// that rise: alpha as it is read off a plot. NaN from fewer than two.
static double plane_slope(const lac_window *w)
{
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (size_t i = 1; i < w->velocities; i++) {
        const double rise = w->velocity[i] - w->velocity[i - 1];
        if (rise > 0.0 && w->velocity[i - 1] > 0.0) {
            const double log_v = 0.5 * (log(w->velocity[i]) + log(w->velocity[i - 1]));
            const double log_rise = log(rise / (w->velocity_time[i] - w->velocity_time[i - 1]));
            n += 1.0;
            x += log_v;
            y += log_rise;
            xx += log_v * log_v;
            xy += log_v * log_rise;
        }
    }
    return n > 1.0 ? (xy - x * y / n) / (xx - x * x / n) : NAN;
}

static lac_status fit_voight(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    lac_projection law = {.window = w,
                          .columns = 2,
                          .shapes = 2,
                          .curve = curve,
                          .place = place,
                          .grid = {GRID, POWERS}};
    double p[LAC_SHAPES_MAX];
    lac_status status;
    LAC_TRY(lac_projection_fit(&law, p, fit, err));
    lac_forecast_fit_add(fit, "alpha", 1.0 + 1.0 / (1.0 - p[1]));
    lac_forecast_fit_add(fit, "alpha_plane", plane_slope(w));
    if (!(p[1] < 1.0)) {
        status =
            lac_forecast_fit_refuse(fit, "no exponent alpha > 1 fits: the velocity stays finite");
    } else if (!(law.c[1] > 0.0)) {
        status = lac_forecast_fit_refuse(fit, "the slope does not accelerate");
    }
out:
    lac_projection_clear(&law);
    return status;
}

const lac_forecast_kind lac_forecast_voight = {
    .info = LAC_ABOUT("voight", "Voight's law, exponent free",
                      "Voight (1988), Nature 332, 125-130, doi 10.1038/332125a0"),
    .estimator =
        "d = D - C (tc - t)^((alpha - 2)/(alpha - 1)) by nonlinear least squares in tc and alpha "
        "over all displacements of the window; alpha_plane is the slope of ln(dv/dt) on ln v",
    .least = 8,
    .displacements = true,
    .worst = 0.04,
    .calibration = {0.8, -0.384, 0.134, 0.736, 1.448},
    .fit = fit_voight,
};
