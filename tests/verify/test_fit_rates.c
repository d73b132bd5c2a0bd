// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities with errors of their own, upper bounds and times that are known within a window: the
// likelihood against numerical integration over an exact solution, the least squares against it.
#include <stdio.h>

#include <gsl/gsl_sf_lambert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit/internal.h"
#include "support/test.h"

enum { ROWS = 6 };

static const double day = 86400.0;

// A velocity that was read or a bound, its error, and half the window of its time. The first and
// the fourth have no window, the third and the fifth are bounds.
static double row_time[ROWS] = {3.0 * 86400,  9.0 * 86400,  15.0 * 86400,
                                21.0 * 86400, 27.0 * 86400, 33.0 * 86400};
static double row_velocity[ROWS] = {2.3e-8, 3.1e-8, NAN, 2.8e-8, NAN, 9.0e-8};
static double row_most[ROWS] = {NAN, NAN, 4.4e-8, NAN, 3.6e-8, NAN};
static double row_sigma[ROWS] = {0.3, 0.2, 0.4, 0.5, 0.25, 0.1};
static double row_within[ROWS] = {0.0, 5.0 * 86400, 4.0 * 86400, NAN, 0.0, 3.0 * 86400};
static size_t row_line[ROWS] = {2, 3, 4, 5, 6, 7};

static lac_series rows(void)
{
    return (lac_series){.n = ROWS,
                        .time = row_time,
                        .velocity = row_velocity,
                        .velocity_most = row_most,
                        .velocity_sigma = row_sigma,
                        .within = row_within,
                        .line = row_line};
}

// m = 2; a start at 0.8 theta_ss.
static lac_case *read_case(const char *fit)
{
    char text[2048];
    lac_case *c = NULL;
    lac_case_issues report;
    lac_error err = {""};
    const lac_case_request how = {LAC_FOR_FIT, NULL, 0};
    (void)snprintf(
        text, sizeof text,
        "lacuna: 1\n"
        "load: {normal: {pressure: \"1 MPa\"}}\n"
        "friction: {aging: {f0: 0.6, a: 0.010, b: 0.020, dc: \"0.1 m\", v0: \"1 um/s\"}}\n"
        "initial: {slip_rate: \"2 mm/day\", state: {ratio_to_steady: 0.8}}\n"
        "time: {end: \"400 day\"}\n"
        "solver: {rtol: 1e-11}\n"
        "fit: {parameters: {friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
        "initial.slip_rate: {range: [\"0.1 mm/day\", \"20 mm/day\"]}}, time: t, "
        "velocity: v, velocity_sigma: s, velocity_most: m, time_within: w, starts: 24, "
        "steps: 0%s}\n",
        fit);
    if (lac_case_read_text("case.yaml", text, strlen(text), &how, &c, &report, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_case_issues_clear(&report);
    return c;
}

static lac_fit *make_fit(const lac_case *c)
{
    lac_fit *fit = NULL;
    lac_error err = {""};
    const lac_series series = rows();
    if (lac_fit_create(c, &series, 1, &fit, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return fit;
}

static double exact_slip(double dc, double rate, double x, double t)
{
    double scale = dc / (rate * x * x);
    double now = 1.0 + gsl_sf_lambert_W0(-exp(x + log(1.0 - x) + t / scale - 1.0));
    return dc * log((1.0 / now - 1.0) / (1.0 / x - 1.0));
}

static double exact_log_rate(double dc, double rate, double t)
{
    const double h = 200.0;
    return log((exact_slip(dc, rate, 0.8, t + h) - exact_slip(dc, rate, 0.8, t - h)) / (2.0 * h));
}

static double normal(double z) { return exp(-0.5 * z * z) / sqrt(2.0 * acos(-1.0)); }

// ln of what row i says, by Simpson's rule over the window, or by its largest rate.
static double exact_term(size_t i, double factor, double dc, double rate)
{
    const int pieces = 2000;
    const double s = factor * row_sigma[i];
    const double half = isnan(row_within[i]) ? 0.0 : row_within[i];
    double sum = 0.0, most = -INFINITY;
    for (int k = 0; k <= pieces; k++) {
        const double t = row_time[i] - half + 2.0 * half * k / pieces;
        const double v = exact_log_rate(dc, rate, t);
        const double weight = k == 0 || k == pieces ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
        sum += weight / (3.0 * pieces) * normal((log(row_velocity[i]) - v) / s) / s;
        most = fmax(most, v);
    }
    return isnan(row_most[i]) ? log(sum)
                              : log(0.5 * erfc((most - log(row_most[i])) / (s * sqrt(2.0))));
}

static void likelihood_is_the_integral(void **state)
{
    (void)state;
    const double dc[] = {0.11, 0.2, 0.09}, rate[] = {2.1e-3 / day, 2.6e-3 / day, 1.1e-3 / day};
    lac_case *c = read_case("");
    lac_fit *fit = make_fit(c);
    assert_int_equal(fit->data.velocities, ROWS);
    assert_int_equal(fit->unknowns, 3);
    for (size_t k = 0; k < 3; k++) {
        const double factor = 0.7 + 0.5 * (double)k;
        const double x[3] = {log(dc[k]), log(rate[k]), log(factor)};
        double want = 0.0;
        for (size_t i = 0; i < ROWS; i++) {
            want += exact_term(i, factor, dc[k], rate[k]);
        }
        const double got = lac_fit_log_posterior(fit, 0, x);
        if (!(fabs(got - want) < 1e-5)) {
            fail_msg("ln posterior %.10g, expected %.10g", got, want);
        }
    }
    lac_fit_free(fit);
    lac_case_free(c);
}

// A rate that grows by the factor e^(c) over the window: the integral of a normal density is a
// difference of two of its distribution's values.
static void a_straight_window_has_a_closed_form(void **state)
{
    (void)state;
    const double from = -17.0, c = 2.5, value = -16.2;
    lac_fit_data data = {.n = LAC_FIT_NODES, .rates = 1};
    lac_fit_seen seen[1] = {{.time = 50.0,
                             .within = 50.0,
                             .velocity = exp(value),
                             .displacement = NAN,
                             .most = NAN,
                             .rate_sigma = 1.0}};
    double time[4 * (LAC_FIT_NODES + 1)], log_rate[LAC_FIT_NODES];
    lac_error err = {""};
    data = (lac_fit_data){.rows = 1,
                          .seen = seen,
                          .time = time,
                          .displacement = time + LAC_FIT_NODES + 1,
                          .log_rate = time + 2 * (LAC_FIT_NODES + 1),
                          .sigma = time + 3 * (LAC_FIT_NODES + 1)};
    assert_int_equal(lac_fit_look_at_rates(&data, 1e9, &err), LAC_OK);
    assert_int_equal(data.n, LAC_FIT_NODES);
    for (size_t i = 0; i < data.n; i++) {
        log_rate[i] = from + c * time[i] / 100.0;
    }
    for (double s = 0.2; s < 3.0; s *= 2.0) {
        const double root = s * sqrt(2.0);
        const double want =
            log(0.5 * (erf((value - from) / root) - erf((value - from - c) / root)) / c);
        const double got = lac_fit_rates_likelihood(&data, s, log_rate);
        if (!(fabs(got - want) < 1e-6)) {
            fail_msg("s %g: %.10g, expected %.10g", s, got, want);
        }
    }
    free(data.rate);
}

// The descent ends where the posterior is highest, also along the error, and knows its bends.
static void least_squares_find_the_top(void **state)
{
    (void)state;
    const char *fits[] = {"", ", velocity_error: 1"};
    for (size_t f = 0; f < 2; f++) {
        lac_case *c = read_case(fits[f]);
        lac_fit *fit = make_fit(c);
        lac_fit_result result;
        lac_error err = {""};
        double x[LAC_FIT_UNKNOWNS];
        if (lac_fit_run(fit, NULL, &result, &err) != LAC_OK) {
            fail_msg("%s", err.message);
        }
        assert_int_equal(result.unknowns, f == 0 ? 3 : 2);
        for (size_t k = 0; k < result.unknowns; k++) {
            x[k] = log(result.unknown[k].best);
        }
        const double top = lac_fit_log_posterior(fit, 0, x);
        assert_true(fabs(top - result.log_likelihood) < 1e-6);
        for (size_t k = 0; k < result.unknowns; k++) {
            for (double h = -0.02; h < 0.03; h += 0.04) {
                const double before = x[k];
                x[k] += h;
                const double other = lac_fit_log_posterior(fit, 0, x);
                if (!(other < top + 1e-6)) {
                    fail_msg("%s: %g is above the top, %g", result.unknown[k].key, other, top);
                }
                x[k] = before;
            }
        }
        lac_fit_free(fit);
        lac_case_free(c);
    }
}

// What least squares take for the slope of a residual is that of its square root of a likelihood.
static void slopes_are_those_of_residuals(void **state)
{
    (void)state;
    lac_case *c = read_case("");
    lac_fit *fit = make_fit(c);
    double log_rate[ROWS * 50], by[ROWS * 50], moved[ROWS * 50];
    const double h = 1e-6;
    for (size_t i = 0; i < fit->data.n; i++) {
        log_rate[i] = exact_log_rate(0.1, 2.2e-3 / day, fit->data.time[i]);
        by[i] = 1.0 + 0.3 * sin((double)i);
        moved[i] = log_rate[i] + h * by[i];
    }
    for (size_t k = 0; k < fit->data.rates; k++) {
        const lac_fit_rate *rate = &fit->data.rate[k];
        const double at = lac_fit_rate_residual(&fit->data, rate, 0.8, log_rate);
        const double want = (lac_fit_rate_residual(&fit->data, rate, 0.8, moved) - at) / h;
        const double got = lac_fit_rate_slope(&fit->data, rate, 0.8, log_rate, by, 1);
        if (!(fabs(got - want) < 1e-4 * (1.0 + fabs(want)))) {
            fail_msg("rate %zu: slope %g, expected %g", k, got, want);
        }
    }
    lac_fit_free(fit);
    lac_case_free(c);
}

static void later_readings_are_left_out(void **state)
{
    (void)state;
    lac_case *c = read_case("");
    c->fit.until = 28.0 * day;
    lac_fit *fit = make_fit(c);
    assert_int_equal(fit->data.velocities, ROWS - 1);
    assert_int_equal(fit->data.outside, 1);
    lac_fit_free(fit);
    lac_case_free(c);
}

static void absurd_rows_are_refused(void **state)
{
    (void)state;
    lac_case *c = read_case("");
    const struct {
        double *at, value;
        const char *said;
    } wrong[] = {{&row_sigma[2], 0.0, "line 4: s: the standard error of a velocity's logarithm"},
                 {&row_sigma[5], NAN, "line 7: s: the standard error of a velocity's logarithm"},
                 {&row_most[4], -1.0, "line 6: m: an upper bound of a velocity must be > 0"},
                 {&row_within[1], -1.0, "line 3: w: how far a time may be off must be >= 0"}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const double before = *wrong[i].at;
        const lac_series series = rows();
        lac_error err = {""};
        lac_fit *fit = NULL;
        *wrong[i].at = wrong[i].value;
        assert_int_equal(lac_fit_create(c, &series, 1, &fit, &err), LAC_EINPUT);
        if (strstr(err.message, wrong[i].said) == NULL) {
            fail_msg("%s", err.message);
        }
        *wrong[i].at = before;
    }
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(likelihood_is_the_integral),
        cmocka_unit_test(a_straight_window_has_a_closed_form),
        cmocka_unit_test(least_squares_find_the_top),
        cmocka_unit_test(slopes_are_those_of_residuals),
        cmocka_unit_test(later_readings_are_left_out),
        cmocka_unit_test(absurd_rows_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
