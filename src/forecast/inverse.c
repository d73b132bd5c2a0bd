// SPDX-License-Identifier: GPL-3.0-or-later
// Inverse velocity falls along a straight line to zero at the time of failure: 1/v = (tc - t)/B,
// the case alpha = 2 of Voight's law.
#include <math.h>

#include "forecast/kinds.h"

enum { LAST = 8 };

// y = a + b t by ordinary least squares, with the variances of a and b.
typedef struct line {
    double a, b, aa, bb, ab;
} line;

static line fit_line(size_t n, const double *t, const double *v)
{
    double mean = 0.0;
    double y = 0.0;
    double tt = 0.0;
    double ty = 0.0;
    double left = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += t[i] / (double)n;
        y += 1.0 / v[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        tt += (t[i] - mean) * (t[i] - mean);
        ty += (t[i] - mean) * (1.0 / v[i] - y);
    }
    line l = {.b = ty / tt};
    l.a = y - l.b * mean;
    for (size_t i = 0; i < n; i++) {
        const double r = 1.0 / v[i] - l.a - l.b * t[i];
        left += r * r;
    }
    const double variance = n > 2 ? left / (double)(n - 2) : NAN;
    l.bb = variance / tt;
    l.aa = variance * (1.0 / (double)n + mean * mean / tt);
    l.ab = -variance * mean / tt;
    return l;
}

static lac_status fit_last(const lac_window *w, size_t n, lac_finding *fit)
{
    const double *t = w->velocity_time + (w->velocities - n);
    const double *v = w->velocity + (w->velocities - n);
    for (size_t i = 0; i < n; i++) {
        if (!(v[i] > 0.0)) {
            return lac_finding_refuse(fit, "a velocity of the %zu is not above 0", n);
        }
    }
    const line l = fit_line(n, t, v);
    if (!(l.b < 0.0)) {
        return lac_finding_refuse(fit, "inverse velocity does not fall");
    }
    fit->remaining = -l.a / l.b;
    // Var ln(a/b), to first order
    fit->error =
        sqrt(fmax(0.0, l.aa / (l.a * l.a) + l.bb / (l.b * l.b) - 2.0 * l.ab / (l.a * l.b)));
    lac_finding_judge_inverse(n, t, v, -1.0 / l.b, fit);
    lac_finding_add(fit, "scale_m", -1.0 / l.b);
    return LAC_OK;
}

static lac_status fit_eight(const lac_window *w, lac_finding *fit, lac_error *err)
{
    (void)err;
    return fit_last(w, LAST, fit);
}

static lac_status fit_all(const lac_window *w, lac_finding *fit, lac_error *err)
{
    (void)err;
    return fit_last(w, w->velocities, fit);
}

const lac_forecast_kind lac_forecast_inv8 = {
    .about = {.name = "inv8",
              .summary = "inverse velocity, the last eight",
              .reference =
                  "Fukuzono (1985), Proc. 4th Int. Conf. Field Workshop Landslides, Tokyo, "
                  "145-150"},
    .estimator = "1/v on t by ordinary least squares over the last eight velocities; tc where the "
                 "line meets 0",
    .least = LAST,
    .worst = 0.6,
    .calibration = {0.8, -0.901, -0.496, -0.120, 0.222},
    .fit = fit_eight,
};

const lac_forecast_kind lac_forecast_inv = {
    .about = {.name = "inv",
              .summary = "inverse velocity, the whole window",
              .reference =
                  "Fukuzono (1985), Proc. 4th Int. Conf. Field Workshop Landslides, Tokyo, "
                  "145-150"},
    .estimator = "as inv8 over all velocities of the window",
    .least = 5,
    .worst = 0.6,
    .calibration = {1.2, -1.631, -1.031, -0.344, -0.016},
    .fit = fit_all,
};
