// SPDX-License-Identifier: GPL-3.0-or-later
// The times that are told of a fit: the calibrated median, its intervals, and what the step between
// readings does to them.
#include <stdlib.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "base/statistics.h"
#include "forecast/forecast.h"
#include "support/test.h"

enum { MOST = 1200, METHODS = 16 };
static const double day = 86400.0;

static double times[MOST], displacement[MOST];

static double normal(size_t i)
{
    double pair[2];
    lac_random_normal(5, LAC_STREAM_TEST, i, 0, pair);
    return pair[0];
}

static lac_forecast_set *look(size_t n, const lac_forecast_model *model, double since)
{
    const lac_readings readings = {.n = n, .time = times, .displacement = displacement};
    lac_forecast_def def = lac_forecast_default();
    lac_forecast_set *o = NULL;
    lac_error err = {""};
    def.model = model;
    def.since = since;
    if (lac_forecast_set_create(&def, &readings, &o, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return o;
}

// (1 - (1 - t)^q)/q, of q = 0 the log law, to 0.95 of the life at uneven times.
static void fill_law(size_t n, double q, double noise)
{
    for (size_t i = 0; i < n; i++) {
        const double part = 0.95 * ((double)i + 0.3 * sin(3.0 * (double)i)) / (double)n;
        times[i] = 1.4e9 + 100.0 * day * part;
        displacement[i] =
            (q == 0.0 ? -log1p(-part) : -expm1(q * log1p(-part)) / q) + noise * normal(i);
    }
}

static void the_median_lies_in_its_intervals(void **state)
{
    (void)state;
    static const double noises[] = {0.0, 0.0003, 0.01};
    size_t issued[METHODS][2] = {{0}};
    size_t methods = 0;
    for (size_t k = 0; k < 18; k++) {
        fill_law(60, 0.4 * (double)(k / 3) - 0.8, noises[k % 3]);
        lac_forecast_set *o = look(60, NULL, times[0]);
        methods = o->count;
        assert_true(methods <= METHODS);
        for (size_t i = 0; i < methods; i++) {
            const lac_forecast *f = &o->forecast[i];
            issued[i][k % 3 > 0 ? 1 : 0] += f->issued ? 1 : 0;
            assert_true(!f->issued ||
                        (f->issue_time <= f->low90 && f->low90 < f->low50 && f->low50 < f->time &&
                         f->time < f->high50 && f->high50 < f->high90 && isfinite(f->high90)));
        }
        lac_forecast_set_free(o);
    }
    for (size_t i = 0; i < methods; i++) {
        assert_true(issued[i][0] > 0 && issued[i][1] > 0);
    }
}

// A model that finds what it is told to.
static lac_status find(void *context, const lac_motion *m, double now, lac_forecast_fit *found,
                       lac_error *err)
{
    (void)m, (void)now, (void)err;
    *found = *(const lac_forecast_fit *)context;
    return LAC_OK;
}

enum { LAST = 30 };
static const lac_forecast_kind told = {.info = {.name = "told"},
                                       .least = 1,
                                       .worst = 1.0,
                                       .calibration = {0.25, 0.3, -2.0, -1.0, -0.4, 0.5, 2.5}};
static const lac_forecast_kind exact = {.info = {.name = "exact"},
                                        .least = 1,
                                        .worst = 1.0,
                                        .calibration = {0.0, 1e-12, -1.6448536269514722,
                                                        -0.6744897501960817, 0.0,
                                                        0.6744897501960817, 1.6448536269514722}};

static lac_forecast forecast(const lac_forecast_kind *kind, lac_forecast_fit fit)
{
    const lac_forecast_model model = {.kind = kind, .fit = find, .context = &fit};
    lac_forecast_set *o = look(LAST, &model, times[0]);
    const lac_forecast f = o->forecast[o->count - 2];
    assert_true(f.kind == kind);
    lac_forecast_set_free(o);
    return f;
}

// Daily readings, the last intervals 9, 2, 1, 2, 3 days: steps of 2.
static void fill_steps(void)
{
    static const double last[] = {9.0, 2.0, 1.0, 2.0, 3.0};
    double t = 0.0;
    for (size_t i = 0; i < LAST; i++) {
        times[i] = day * t;
        displacement[i] = 1e-3 * t * t;
        t += i + 6 < LAST ? 1.0 : i + 1 < LAST ? last[i + 6 - LAST] : 0.0;
    }
}

static bool near(double a, double b, double by) { return fabs(a - b) <= by; }

// R = 10 days in a window of 41: pulled by a quarter of ln 4.1.
static void the_median_is_calibrated(void **state)
{
    (void)state;
    fill_steps();
    const double now = times[LAST - 1];
    assert_true(near(now, 41.0 * day, 1e-6));
    lac_forecast_fit fit = {.remaining = 10.0 * day, .error = 0.4};
    const double centre = log(10.0 * day) + 0.25 * log(4.1);
    const lac_forecast f = forecast(&told, fit);
    assert_true(f.issued && f.raw_time == now + 10.0 * day);
    const double q[] = {-2.0, -1.0, -0.4, 0.5, 2.5};
    const double is[] = {f.low90, f.low50, f.time, f.high50, f.high90};
    for (size_t k = 0; k < 5; k++) {
        assert_true(near(is[k], now + exp(centre + 0.5 * q[k]), 1e-3));
    }
    // a posterior's ends are its own, pulled likewise
    const double own[] = {-0.9, -0.3, 0.1, 0.3, 1.6};
    fit.posterior = true;
    for (size_t k = 0; k < 5; k++) {
        fit.quantile[k] = log(10.0 * day) + own[k];
    }
    const lac_forecast g = forecast(&exact, fit);
    assert_true(near(g.low90, now + exp(fit.quantile[0]), 1.0));
    assert_true(near(g.time, now + exp(fit.quantile[2]), 1.0));
    assert_true(near(g.high50, now + exp(fit.quantile[3]), 1.0));
    const lac_forecast h = forecast(&told, fit);
    const double middle = fit.quantile[2] + 0.25 * (log(41.0 * day) - fit.quantile[2]);
    assert_true(near(h.time, now + exp(middle - 0.4 * 0.5), 1e-3));
    assert_true(
        near(h.high90, now + exp(middle + 2.5 * hypot(1.5 / 1.6448536269514722, 0.3)), 1e-3));
}

// Steps are of two days: no median within one of them, no interval of 90 % below two, of 50 % below
// 0.8; what is wider stays.
static void nothing_is_finer_than_the_step(void **state)
{
    (void)state;
    fill_steps();
    const double now = times[LAST - 1];
    const lac_forecast close = forecast(&exact, (lac_forecast_fit){.remaining = 0.01 * day});
    assert_true(close.issued && close.raw_time == now + 0.01 * day);
    assert_true(near(close.time, now + day, 1e-6) && near(close.low90, now, 1e-6));
    assert_true(close.low90 >= now && near(close.high90, now + 2.0 * day, 1e-6));
    assert_true(near(close.low50, now + 0.01 * day, 1e-6)); // wide enough below
    assert_true(near(close.high50, now + 1.4 * day, 1e-6));
    const lac_forecast far = forecast(&exact, (lac_forecast_fit){.remaining = 20.0 * day});
    assert_true(near(far.time, now + 20.0 * day, 1e-3));
    assert_true(near(far.low90, now + 19.0 * day, 1e-3));
    assert_true(near(far.high90, now + 21.0 * day, 1e-3));
    assert_true(near(far.high50 - far.low50, 0.8 * day, 1e-3));
    const lac_forecast wide =
        forecast(&exact, (lac_forecast_fit){.remaining = 20.0 * day, .error = 0.5});
    assert_true(near(wide.low50, now + 20.0 * day * exp(-0.5 * 0.6744897501960817), 1e-3));
    assert_true(near(wide.high90, now + 20.0 * day * exp(0.5 * 1.6448536269514722), 1e-3));
    // the last interval is of three days
    assert_true(forecast(&exact, (lac_forecast_fit){.remaining = 0.0031 * day}).issued);
    const lac_forecast over = forecast(&exact, (lac_forecast_fit){.remaining = 0.0029 * day});
    assert_true(!over.issued && strstr(over.fit.reason, "over") != NULL && isnan(over.time));
    assert_true(over.raw_time == now + 0.0029 * day);
}

// Many readings are fitted by their means, but come as often as they do.
static void means_of_readings_have_no_longer_step(void **state)
{
    (void)state;
    for (size_t i = 0; i < MOST; i++) {
        times[i] = 600.0 * (double)i;
        displacement[i] = -log1p(-0.999 * (double)i / MOST);
    }
    lac_forecast_fit fit = {.remaining = 10.0};
    const lac_forecast_model model = {.kind = &exact, .fit = find, .context = &fit};
    lac_forecast_set *o = look(MOST, &model, times[0]);
    const lac_forecast *f = &o->forecast[o->count - 2];
    assert_true(f->issued && near(f->time - f->issue_time, 300.0, 1e-6));
    lac_forecast_set_free(o);
}

// 23.209 is the 99 % quantile of chi-square with ten degrees of freedom.
static void noise_explains_what_it_comes_to(void **state)
{
    (void)state;
    const double most = 0.2 * sqrt(2.32092512);
    assert_true(lac_unexplained(most * 0.999, 0.2, 10.0) == 0.0);
    assert_true(near(lac_unexplained(most * 1.001, 0.2, 10.0), 0.2 * sqrt(1.32092512), 1e-3));
    assert_true(near(lac_unexplained(5.0, 3.0, 1e6), 4.0, 1e-12));
    assert_true(lac_unexplained(5.0, NAN, 10.0) == 5.0 && lac_unexplained(5.0, 0.0, 10.0) == 5.0);
    assert_true(lac_unexplained(1.0, 0.99, -3.0) == 0.0); // of one at least
    assert_true(isnan(lac_unexplained(NAN, 1.0, 10.0)));
}

static const lac_forecast *of(const lac_forecast_set *o, const char *method)
{
    for (size_t k = 0; k < o->count; k++) {
        if (strcmp(o->forecast[k].kind->info.name, method) == 0) {
            return &o->forecast[k];
        }
    }
    fail_msg("no method %s", method);
    return o->forecast;
}

enum { SEEN = 57, DRAWS = 20 };

// As satellites see a slide: every 15 days for two years, then of 2 to 6 days, to two days before
// failure; 6.6 m.
static void fill_slide(size_t draw, double noise)
{
    double left = 2.0;
    for (size_t i = SEEN; i-- > 0; left += i + 8 < SEEN ? 15.0 : 2.0 + (double)(i % 3) * 2.0) {
        times[i] = 1.4e9 - day * left;
        displacement[i] = 7.5 - 1.2 * log(left) + noise * normal(draw * MOST + i);
    }
}

// Residuals of 3 and 6 % of the range are noise, and do not count against a fit; of a slide that
// comes in steps they do, and their noise is taken out of them.
static void noise_is_no_bad_fit(void **state)
{
    (void)state;
    static const char *const methods[] = {"log", "voight", "block", "saito"};
    static const double noises[] = {0.2, 0.4};
    size_t bad[4] = {0};
    size_t asked = 0;
    for (size_t k = 0; k < DRAWS; k++) {
        fill_slide(k / 2, noises[k % 2]);
        lac_forecast_set *o = look(SEEN, NULL, times[0]);
        for (size_t i = 0; i < 4 && o->asked; i++) {
            const lac_forecast_fit *fit = &of(o, methods[i])->fit;
            bad[i] += strstr(fit->reason, "bad fit") != NULL ? 1 : 0;
            assert_true(fit->excess <= fit->misfit);
        }
        asked += o->asked ? 1 : 0;
        assert_true(!o->asked || of(o, "log")->fit.misfit > noises[k % 2] / 11.0);
        lac_forecast_set_free(o);
    }
    assert_in_range(asked, DRAWS - 2, DRAWS);
    assert_true(bad[0] + bad[1] + bad[2] == 0);
    assert_in_range(bad[3], 0, DRAWS / 5); // one of its three readings may be far off
    fill_slide(0, 0.05);
    for (size_t i = SEEN / 2; i < SEEN; i++) {
        displacement[i] += 2.0;
    }
    lac_forecast_set *o = look(SEEN, NULL, times[0]);
    const lac_forecast_fit *fit = &of(o, "log")->fit;
    assert_non_null(strstr(fit->reason, "more than the noise explains, at most 0.04"));
    assert_true(fit->excess > 0.04 && fit->excess < fit->misfit);
    assert_true(near(hypot(fit->excess, 0.05 / 9.0), fit->misfit, 0.02 * fit->misfit));
    lac_forecast_set_free(o);
}

// Inverse velocities of v with a noise of a twentieth of the first ones, and exact ones of another
// law.
static void noise_is_no_bad_inverse_velocity(void **state)
{
    (void)state;
    size_t explained = 0;
    for (size_t draw = 0; draw < DRAWS; draw++) {
        fill_law(40, 0.0, 0.0);
        for (size_t i = 0; i < 40; i++) {
            const double left = 1.4e9 + 100.0 * day - times[i];
            displacement[i] = 1.0 / left + 0.05 / (100.0 * day) * normal(draw * MOST + i);
        }
        const lac_readings readings = {.n = 40, .time = times, .velocity = displacement};
        lac_forecast_def def = lac_forecast_default();
        def.since = times[0];
        lac_forecast_set *o = NULL;
        assert_int_equal(lac_forecast_set_create(&def, &readings, &o, NULL), LAC_OK);
        const lac_forecast_fit *fit = &of(o, "inv")->fit;
        explained += fit->excess < 0.5 * fit->misfit ? 1 : 0;
        assert_true(fit->misfit > 0.05);
        lac_forecast_set_free(o);
    }
    assert_in_range(explained, DRAWS - DRAWS / 5, DRAWS);
    for (size_t i = 0; i < 40; i++) {
        displacement[i] = exp((times[i] - times[0]) / (12.0 * day));
    }
    lac_forecast_set *o = look(40, NULL, times[0]);
    const lac_forecast_fit *fit = &of(o, "inv")->fit;
    assert_true(fit->misfit > 0.3 && fit->excess > 0.9 * fit->misfit);
    lac_forecast_set_free(o);
}

// Noise in v, here a third of its variance, draws the slope of t v on v to the middle of the
// window: the time that it finds is early by more than the scatter about the line tells, and its
// error knows it.
static void noise_that_draws_a_slope_is_in_its_error(void **state)
{
    (void)state;
    size_t early = 0, known = 0;
    for (size_t draw = 0; draw < DRAWS; draw++) {
        for (size_t i = 0; i < 40; i++) {
            times[i] = day * (double)i;
            displacement[i] = 1e-6 / (80.0 - (double)i) + 2.5e-9 * normal(draw * MOST + i);
        }
        const lac_readings readings = {.n = 40, .time = times, .velocity = displacement};
        lac_forecast_def def = lac_forecast_default();
        def.since = times[0];
        lac_forecast_set *o = NULL;
        assert_int_equal(lac_forecast_set_create(&def, &readings, &o, NULL), LAC_OK);
        const lac_forecast_fit *fit = &of(o, "slo")->fit;
        early += o->asked && fit->remaining < 41.0 * day ? 1 : 0;
        known += o->asked && fabs(fit->remaining - 41.0 * day) < 2.0 * fit->error * fit->remaining;
        lac_forecast_set_free(o);
    }
    assert_in_range(early, DRAWS - 3, DRAWS);
    assert_in_range(known, DRAWS - 3, DRAWS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_median_lies_in_its_intervals),
        cmocka_unit_test(the_median_is_calibrated),
        cmocka_unit_test(nothing_is_finer_than_the_step),
        cmocka_unit_test(means_of_readings_have_no_longer_step),
        cmocka_unit_test(noise_explains_what_it_comes_to),
        cmocka_unit_test(noise_is_no_bad_fit),
        cmocka_unit_test(noise_is_no_bad_inverse_velocity),
        cmocka_unit_test(noise_that_draws_a_slope_is_in_its_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
