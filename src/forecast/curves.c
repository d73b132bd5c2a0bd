// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of displacement whose curve has a closed form.
#include "base/vmath.h"
#include "forecast/kinds.h"

static const double low_q = -3.0, high_q = 0.9;
static const double low_m = 0.05, high_m = 0.95, low_omega = 3.0, high_omega = 15.0;

// The fit, refused where c_1 has not the sign of what accelerates.
static lac_status fit_curve(lac_projection *law, double sign, double *p, lac_forecast_fit *fit,
                            lac_error *err)
{
    const lac_status status = lac_projection_fit(law, p, fit, err);
    lac_projection_clear(law);
    return status != LAC_OK || sign * law->c[1] > 0.0
               ? status
               : lac_forecast_fit_refuse(fit, "the slope does not accelerate");
}

// d = A - B ln(tc - t): what a block of rate-and-state friction does near failure, where
// v = (dc/m)/(tc - t), so that B = dc/m.
static void log_curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    const double rate = exp(-p[0]);
    for (size_t i = 0; i < w->n; i++) {
        columns[i] = 1.0;
        columns[w->n + i] = -log1p(-w->time[i] * rate);
    }
}

static lac_status fit_log(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    lac_projection law = {.window = w, .columns = 2, .shapes = 1, .curve = log_curve, .grid = {60}};
    double p[LAC_SHAPES_MAX];
    LAC_TRY_RETURN(fit_curve(&law, 1.0, p, fit, err));
    lac_forecast_fit_add(fit, "scale_m", law.c[1]);
    return LAC_OK;
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
    .calibration = {0.4, 1.6, -2.022, -1.242, -0.725, -0.196, 0.84},
    .fit = fit_log,
};

// dv/dt = A v^alpha with alpha > 1: v = kappa (tc - t)^(-1/(alpha - 1)), integrated
//     d = D - C (tc - t)^q,  q = (alpha - 2)/(alpha - 1);  the log law is q = 0. Columns are
// (z^q - 1)/q with z = (tc - t)/(tc - now), which goes over into ln z
static void power_curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    const double q = p[1], rate = exp(-p[0]);
    for (size_t i = 0; i < w->n; i++) {
        const double log_z = log1p(-w->time[i] * rate);
        columns[i] = 1.0;
        columns[w->n + i] = fabs(q * log_z) < 1e-12 ? -log_z : -expm1(q * log_z) / q;
    }
}

static double place_power(const lac_projection *self, size_t shape, double part)
{
    (void)self, (void)shape;
    return low_q + (high_q - low_q) * part;
}

// Slope of ln(dv/dt) on ln v by ordinary least squares, over the pairs of successive velocities
// that rise: alpha as it is read off a plot. NaN from fewer than two.
static double plane_slope(const lac_window *w)
{
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0;
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
                          .curve = power_curve,
                          .place = place_power,
                          .grid = {40, 12}};
    double p[LAC_SHAPES_MAX];
    LAC_TRY_RETURN(fit_curve(&law, 1.0, p, fit, err));
    lac_forecast_fit_add(fit, "alpha", 1.0 + 1.0 / (1.0 - p[1]));
    lac_forecast_fit_add(fit, "alpha_plane", plane_slope(w));
    return p[1] < 1.0 ? LAC_OK
                      : lac_forecast_fit_refuse(
                            fit, "no exponent alpha > 1 fits: the velocity stays finite");
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
    .calibration = {0.4, 1.3, -1.647, -0.977, -0.583, -0.196, 0.461},
    .fit = fit_voight,
};

// Power law with log-periodic oscillations, z = tc - t:
//     d = A + z^m {B + C1 cos(omega ln z) + C2 sin(omega ln z)},  lambda = exp(2 pi/omega).

// p stays free while m and omega keep to their ranges.
static double within(double low, double high, double p)
{
    return low + (high - low) / (1.0 + exp(-p));
}

// z in windows, so that the power of it is of order 1
static void wavy_curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    const size_t n = w->n;
    const double m = within(low_m, high_m, p[1]);
    const double omega = within(low_omega, high_omega, p[2]);
    const double remaining = exp(p[0]);
    double *power = columns + n, *log_z = columns + 2 * n;
    for (size_t i = 0; i < n; i++) {
        log_z[i] = (remaining - w->time[i]) / -w->time[0];
    }
    lac_vlog(n, log_z, log_z);
    for (size_t i = 0; i < n; i++) {
        columns[i] = 1.0;
        power[i] = m * log_z[i];
    }
    lac_vexp(n, power, power);
    for (size_t i = 0; i < n; i++) {
        const double angle = omega * log_z[i];
        columns[2 * n + i] = power[i] * cos(angle);
        columns[3 * n + i] = power[i] * sin(angle);
    }
}

static double place_wave(const lac_projection *self, size_t shape, double part)
{
    (void)self, (void)shape;
    return log(part / (1.0 - part));
}

static lac_status fit_lppls(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    lac_projection law = {.window = w,
                          .columns = 4,
                          .shapes = 3,
                          .curve = wavy_curve,
                          .place = place_wave,
                          .grid = {24, 6, 12}};
    double p[LAC_SHAPES_MAX];
    LAC_TRY_RETURN(fit_curve(&law, -1.0, p, fit, err));
    const double omega = within(low_omega, high_omega, p[2]);
    lac_forecast_fit_add_within(fit, "m", within(low_m, high_m, p[1]), low_m, high_m);
    lac_forecast_fit_add_within(fit, "omega", omega, low_omega, high_omega);
    lac_forecast_fit_add(fit, "lambda", exp(2.0 * M_PI / omega));
    lac_forecast_fit_add(fit, "oscillation", hypot(law.c[2], law.c[3]) / fabs(law.c[1]));
    return LAC_OK;
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
    .calibration = {0.4, 1.6, -1.218, -0.722, -0.405, 0.022, 0.792},
    .fit = fit_lppls,
};
