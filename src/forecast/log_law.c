// SPDX-License-Identifier: GPL-3.0-or-later
// d = A - B ln(tc - t): what a block of rate-and-state friction does near failure, where
// v = (dc/m)/(tc - t), so that B = dc/m.
#include <math.h>

#include "forecast/project.h"

enum { GRID = 60 };

static void curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    for (size_t i = 0; i < w->n; i++) {
        columns[i] = 1.0;
        columns[w->n + i] = -log1p(-w->time[i] * exp(-p[0]));
    }
}

static lac_status fit_log(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    lac_projection law = {.window = w, .columns = 2, .shapes = 1, .curve = curve, .grid = {GRID}};
    double p[LAC_SHAPES_MAX];
    lac_status status;
    LAC_TRY(lac_projection_fit(&law, p, fit, err));
    if (!(law.c[1] > 0.0)) {
        status = lac_forecast_fit_refuse(fit, "the slope does not accelerate");
    }
    lac_forecast_fit_add(fit, "scale_m", law.c[1]);
out:
    lac_projection_clear(&law);
    return status;
}

const lac_forecast_kind lac_forecast_log = {
    .info = LAC_ABOUT(
        "log", "log law of displacement",
        "Helmstetter et al. (2004), J. Geophys. Res. 109, B02409, doi 10.1029/2002JB002160"),
    .estimator = "d = A - B ln(tc - t) by least squares over all displacements of the window",
    .least = 6,
    .displacements = true,
    .dates = true,
    .worst = 0.04,
    .calibration = {1.2, -1.153, -0.676, -0.211, 0.016},
    .fit = fit_log,
};
