// SPDX-License-Identifier: GPL-3.0-or-later
// Methods that read v (tc - t) = B, the case alpha = 2 of Voight's law, as a straight line: inverse
// velocity falls to zero at the time of failure; or, as t v = tc v - B, the slope of t v against v
// is the time of failure.
#include "forecast/kinds.h"

enum { LAST = 8 };
static const double least_signal = 1e-3; // of the variance of velocities

// The line of 1/v over t, or of t v over v, of velocities above 0; it ends before one that is not.
static lac_status fit_line(size_t n, const double *t, const double *v, bool inverse, lac_line *line,
                           lac_error *err)
{
    size_t known = 0;
    double *y = calloc(n, sizeof *y);
    LAC_FAIL_MEMORY_IF(y == NULL, err);
    for (; known < n && v[known] > 0.0; known++) {
        y[known] = inverse ? 1.0 / v[known] : t[known] * v[known];
    }
    *line = lac_line_fit(known, inverse ? t : v, y);
    free(y);
    return LAC_OK;
}

// Misfit of v = B/(remaining - t) to n velocities from `first` on, as inverse velocities. The noise
// of each is that of v over v^2, v of the law: where noise makes it low, it is not more certain. It
// has as many degrees of freedom as a chi-square with its mean and variance.
static void judge(const lac_window *w, size_t first, double scale, lac_forecast_fit *fit)
{
    const double *v = w->velocity + first;
    const size_t n = w->velocities - first;
    double mean = 0.0, all = 0.0, left = 0.0, noise = 0.0, fourth = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += 1.0 / v[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const double inverse = 1.0 / v[i];
        const double law = (fit->remaining - w->velocity_time[first + i]) / scale;
        const double error = w->velocity_error[first + i] * law * law;
        left += (inverse - law) * (inverse - law);
        all += (inverse - mean) * (inverse - mean);
        noise += error * error;
        fourth += error * error * error * error;
    }
    const double count = (double)n;
    fit->points = n;
    fit->rms_unit = "s/m";
    lac_forecast_fit_weigh(fit, sqrt(left / count), sqrt(all / count), sqrt(noise / count),
                           noise * noise / fourth - 2.0);
}

static lac_status fit_last(const lac_window *w, size_t n, lac_forecast_fit *fit, lac_error *err)
{
    const double *t = w->velocity_time + (w->velocities - n);
    const double *v = w->velocity + (w->velocities - n);
    lac_line l;
    LAC_TRY_RETURN(fit_line(n, t, v, true, &l, err));
    if ((size_t)l.n < n) {
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
    judge(w, w->velocities - n, -1.0 / b, fit);
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
    .calibration = {0.2, 1.6, -0.975, -0.503, -0.224, 0.273, 0.943},
    .fit = fit_eight,
};

const lac_forecast_kind lac_forecast_inv = {
    .info = LAC_ABOUT(
        "inv", "inverse velocity, the whole window",
        "Fukuzono (1985), Proc. 4th Int. Conf. Field Workshop Landslides, Tokyo, 145-150"),
    .estimator = "as inv8 over all velocities of the window",
    .least = 5,
    .worst = 0.6,
    .calibration = {0.1, 1.6, -1.98, -0.904, -0.446, -0.103, 0.541},
    .fit = fit_all,
};

// Noise of v is in both t v and v, and draws their slope to the mean time by the share that it has
// in the variance of v. @return how far it is drawn [s]
static double drawn_by_noise(const lac_window *w, const lac_line *line)
{
    const double count = (double)w->velocities;
    const double noise = lac_dot(w->velocities, w->velocity_error, w->velocity_error) / count;
    const double part = noise > 0.0 ? noise / (line->xx / count) : 0.0;
    return part / fmax(least_signal, 1.0 - part) *
           (lac_line_slope(line) - lac_mean(w->velocities, w->velocity_time));
}

static lac_status fit_slope(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    const size_t n = w->velocities;
    const double *t = w->velocity_time, *v = w->velocity;
    lac_line line;
    LAC_TRY_RETURN(fit_line(n, t, v, false, &line, err));
    if ((size_t)line.n < n) {
        return lac_forecast_fit_refuse(fit, "a velocity of the window is not above 0");
    }
    const double intercept = lac_line_at(&line, 0.0);
    fit->remaining = lac_line_slope(&line);
    if (!(intercept < 0.0)) {
        return lac_forecast_fit_refuse(fit,
                                       "t v does not fall with v as that of a finite time does");
    }
    fit->error = hypot(sqrt(line.rest / (line.n - 2.0) / line.xx), drawn_by_noise(w, &line)) /
                 fabs(fit->remaining);
    judge(w, 0, -intercept, fit);
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
    .calibration = {0.4, 1.6, -1.75, -0.89, 0.012, 0.655, 0.806},
    .fit = fit_slope,
};
