// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse velocity falls along a straight line to zero at the time of failure: 1/v = (tc - t)/B,
// the case alpha = 2 of Voight's law.
#include <math.h>
#include <stdlib.h>

#include "base/statistics.h"
#include "forecast/kinds.h"

enum { LAST = 8 };

static lac_status fit_last(const lac_window *w, size_t n, lac_forecast_fit *fit, lac_error *err)
{
    const double *t = w->velocity_time + (w->velocities - n);
    const double *v = w->velocity + (w->velocities - n);
    size_t known = 0;
    double *y = calloc(n, sizeof *y);
    LAC_FAIL_MEMORY_IF(y == NULL, err);
    for (; known < n && v[known] > 0.0; known++) {
        y[known] = 1.0 / v[known];
    }
    const lac_line l = lac_line_fit(known, t, y);
    free(y);
    if (known < n) {
        return lac_forecast_fit_refuse(fit, "a velocity of the %zu is not above 0", n);
    }
    const double a = lac_line_at(&l, 0.0);
    const double b = lac_line_slope(&l);
    if (!(b < 0.0)) {
        return lac_forecast_fit_refuse(fit, "inverse velocity does not fall");
    }
    fit->remaining = -a / b;
    // of ln(a/b), to first order: the line is off at the mean, and turned about it
    fit->error = sqrt(l.rest / (l.n - 2.0) / l.xx) * hypot(sqrt(l.xx / l.n) / a, l.x / a + 1.0 / b);
    lac_forecast_fit_judge_inverse(n, t, v, -1.0 / b, fit);
    lac_forecast_fit_add(fit, "scale_m", -1.0 / b);
    return LAC_OK;
}

static lac_status fit_eight(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    return fit_last(w, LAST, fit, err);
}

static lac_status fit_all(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    return fit_last(w, w->velocities, fit, err);
}

const lac_forecast_kind lac_forecast_inv8 = {
    .info = LAC_ABOUT(
        "inv8", "inverse velocity, the last eight",
        "Fukuzono (1985), Proc. 4th Int. Conf. Field Workshop Landslides, Tokyo, 145-150"),
    .estimator = "1/v on t by ordinary least squares over the last eight velocities; tc where the "
                 "line meets 0",
    .least = LAST,
    .worst = 0.6,
    .calibration = {0.8, -0.901, -0.496, -0.120, 0.222},
    .fit = fit_eight,
};

const lac_forecast_kind lac_forecast_inv = {
    .info = LAC_ABOUT(
        "inv", "inverse velocity, the whole window",
        "Fukuzono (1985), Proc. 4th Int. Conf. Field Workshop Landslides, Tokyo, 145-150"),
    .estimator = "as inv8 over all velocities of the window",
    .least = 5,
    .worst = 0.6,
    .calibration = {1.2, -1.631, -1.031, -0.344, -0.016},
    .fit = fit_all,
};
