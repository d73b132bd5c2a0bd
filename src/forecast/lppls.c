// SPDX-License-Identifier: GPL-3.0-or-later
// Power law with log-periodic oscillations, z = tc - t:
//     d = A + z^m {B + C1 cos(omega ln z) + C2 sin(omega ln z)},  lambda = exp(2 pi/omega).
#include <math.h>

#include "forecast/project.h"

enum { GRID = 24, POWERS = 6, FREQUENCIES = 12 };
static const double pi = 3.14159265358979323846;
static const double low_m = 0.05, high_m = 0.95, low_omega = 3.0, high_omega = 15.0;

// p stays free while m and omega keep to their ranges.
static double within(double low, double high, double p)
{
    return low + (high - low) / (1.0 + exp(-p));
}

// z in windows, so that the power of it is of order 1
static void curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    const size_t n = w->n;
    const double m = within(low_m, high_m, p[1]);
    const double omega = within(low_omega, high_omega, p[2]);
    for (size_t i = 0; i < n; i++) {
        const double log_z = log((exp(p[0]) - w->time[i]) / -w->time[0]);
        const double power = exp(m * log_z);
        columns[i] = 1.0;
        columns[n + i] = power;
        columns[2 * n + i] = power * cos(omega * log_z);
        columns[3 * n + i] = power * sin(omega * log_z);
    }
}

static double place(const lac_projection *self, size_t shape, double part)
{
    (void)self, (void)shape;
    return log(part / (1.0 - part));
}

static lac_status fit_lppls(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    lac_projection law = {.window = w,
                          .columns = 4,
                          .shapes = 3,
                          .curve = curve,
                          .place = place,
                          .grid = {GRID, POWERS, FREQUENCIES}};
    double p[LAC_SHAPES_MAX];
    lac_status status;
    LAC_TRY(lac_projection_fit(&law, p, fit, err));
    const double omega = within(low_omega, high_omega, p[2]);
    lac_forecast_fit_add_within(fit, "m", within(low_m, high_m, p[1]), low_m, high_m);
    lac_forecast_fit_add_within(fit, "omega", omega, low_omega, high_omega);
    lac_forecast_fit_add(fit, "lambda", exp(2.0 * pi / omega));
    lac_forecast_fit_add(fit, "oscillation", hypot(law.c[2], law.c[3]) / fabs(law.c[1]));
    if (!(law.c[1] < 0.0)) {
        status = lac_forecast_fit_refuse(fit, "the slope does not accelerate");
    }
out:
    lac_projection_clear(&law);
    return status;
}

const lac_forecast_kind lac_forecast_lppls = {
    .info = LAC_ABOUT("lppls", "log-periodic power law",
                      "Lei & Sornette (2025), Geophys. Res. Lett., doi 10.1029/2025GL116379"),
    .estimator = "d = A + z^m (B + C1 cos(omega ln z) + C2 sin(omega ln z)), z = tc - t, over all "
                 "displacements of the window: A, B, C1, C2 exactly at each of 1728 (tc, m, "
                 "omega), the best four refined; 0.05 < m < 0.95, 3 < omega < 15",
    .least = 15,
    .displacements = true,
    .worst = 0.04,
    .calibration = {0.6, -0.392, 0.186, 0.988, 1.993},
    .fit = fit_lppls,
};
