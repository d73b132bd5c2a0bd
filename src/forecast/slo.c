// SPDX-License-Identifier: GPL-3.0-or-later
// v (tc - t) = B, read as t v = tc v - B: the slope of t v against v is the time of failure.
#include <math.h>
#include <stdlib.h>

#include "base/statistics.h"
#include "forecast/kinds.h"

static lac_status fit_slope(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    const size_t n = w->velocities;
    const double *t = w->velocity_time;
    const double *v = w->velocity;
    size_t known = 0;
    double *y = calloc(n, sizeof *y);
    LAC_FAIL_MEMORY_IF(y == NULL, err);
    for (; known < n && v[known] > 0.0; known++) {
        y[known] = t[known] * v[known];
    }
    const lac_line line = lac_line_fit(known, v, y);
    free(y);
    if (known < n) {
        return lac_forecast_fit_refuse(fit, "a velocity of the window is not above 0");
    }
    const double intercept = lac_line_at(&line, 0.0);
    fit->remaining = lac_line_slope(&line);
    if (!(intercept < 0.0)) {
        return lac_forecast_fit_refuse(fit,
                                       "t v does not fall with v as that of a finite time does");
    }
    fit->error = sqrt(line.rest / (line.n - 2.0) / line.xx) / fabs(fit->remaining);
    lac_forecast_fit_judge_inverse(n, t, v, -intercept, fit);
    lac_forecast_fit_add(fit, "scale_m", -intercept);
    return LAC_OK;
}

const lac_forecast_kind lac_forecast_slo = {
    .info = LAC_ABOUT("slo", "slope of t v against v",
                      "Mufundirwa, Fujii & Kodama (2010), Int. J. Rock Mech. Min. Sci. 47, "
                      "1065-1073, doi 10.1016/j.ijrmms.2010.06.004"),
    .estimator =
        "t v on v by ordinary least squares over all velocities of the window; tc is the slope",
    .least = 5,
    .worst = 0.6,
    .calibration = {0.3, -3.954, -2.496, -0.764, 0.146},
    .fit = fit_slope,
};
