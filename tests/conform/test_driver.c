// SPDX-License-Identifier: GPL-3.0-or-later
// What is said of a driver knows nothing of the future, and does not care for units or clocks; and
// what forecasts make of it.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forecast/hindcast.h"
#include "support/driven.h"
#include "support/test.h"

enum { DAYS = 60, CUT = 45 };

static const driven_def usual = {
    .days = DAYS, .seed = 2, .weather = DRIVEN_WET, .answer = 3.0, .memory = 3.0, .noise = 0.3};

static bool same(double a, double b) { return isnan(a) ? isnan(b) : a == b; }
static bool near(double a, double b, double part) { return fabs(a - b) <= part * fabs(b); }

static lac_driver_effect ask(const driven *slope)
{
    lac_driver_effect e;
    driven_explain(slope, &e);
    return e;
}

static void the_future_changes_nothing(void **state)
{
    (void)state;
    driven slope;
    for (int kind = 0; kind < 3; kind++) {
        driven_make(&usual, &slope);
        slope.driver.sum = kind == 1;
        slope.driver.days = kind == 2;
        slope.readings.n = CUT;
        lac_driver_effect a = ask(&slope);
        for (size_t i = CUT; i < slope.n; i++) {
            slope.value[i] = -1e6 * (double)i;
            slope.displacement[i] = NAN;
            slope.time[i] += 1e4 * (double)i;
        }
        if (kind == 2) { // of a day that is not over nothing is known
            slope.value[CUT - 1] = 1e9;
        }
        lac_driver_effect b = ask(&slope);
        slope.driver.n = CUT;
        lac_driver_effect c = ask(&slope);
        assert_true(a.verdict == b.verdict && a.verdict == c.verdict);
        assert_true(kind == 2 || a.verdict == LAC_EXPLAINS);
        assert_true(same(a.p, b.p) && same(a.share, b.share) && same(a.slope, b.slope));
        assert_true(same(a.scale, b.scale) && same(a.slope, c.slope) && a.remains == b.remains);
        for (size_t i = 0; i < CUT; i++) {
            assert_true(same(a.value[i], b.value[i]) && same(a.part[i], b.part[i]));
            assert_true(same(a.part[i], c.part[i]));
        }
        lac_driver_effect_clear(&a);
        lac_driver_effect_clear(&b);
        lac_driver_effect_clear(&c);
    }
}

static void assert_alike(const lac_driver_effect *a, const lac_driver_effect *b, double slope)
{
    assert_int_equal(a->verdict, b->verdict);
    assert_int_equal(a->response, b->response);
    assert_true(a->p == b->p && near(a->share, b->share, 1e-6));
    assert_true(near(a->scale, b->scale, 1e-6) && near(a->slope * slope, b->slope, 1e-6));
    assert_int_equal(a->remains, b->remains);
}

// Degrees of other scales, feet, other clocks: the same answer.
static void units_and_clock_do_not_matter(void **state)
{
    (void)state;
    driven slope;
    driven_make(&usual, &slope);
    lac_driver_effect here = ask(&slope), there;
    assert_int_equal(here.verdict, LAC_EXPLAINS);
    for (size_t i = 0; i < slope.n; i++) {
        slope.value[i] = 1.8 * slope.value[i] + 32.0;
        slope.displacement[i] *= 1024.0;
        slope.time[i] += 1073741824.0;
    }
    there = ask(&slope);
    assert_alike(&here, &there, 1024.0 / 1.8);
    lac_driver_effect_clear(&there);
    lac_driver_effect_clear(&here);
}

// An amount a day is a mean of the day, in seconds.
static void amounts_are_means(void **state)
{
    (void)state;
    driven slope;
    driven_make(&usual, &slope);
    lac_driver_effect mean = ask(&slope);
    slope.driver.sum = true;
    lac_driver_effect sum = ask(&slope);
    assert_int_equal(mean.response, LAC_RESPONSE_MEMORY);
    assert_true(mean.p == sum.p && near(86400.0 * sum.value[20], mean.value[20], 1e-9));
    assert_true(near(sum.slope, 86400.0 * mean.slope, 1e-6));
    lac_driver_effect_clear(&mean);
    lac_driver_effect_clear(&sum);
}

static lac_forecast_set *look(const driven *slope, size_t drivers)
{
    lac_forecast_def def = lac_forecast_default();
    lac_forecast_set *o = NULL;
    def.motion.raw = true;
    def.since = 0.0;
    def.drivers = drivers;
    def.driver = &slope->driver;
    assert_int_equal(lac_forecast_set_create(&def, &slope->readings, &o, NULL), LAC_OK);
    assert_int_equal(o->effects, drivers);
    return o;
}

// Withheld where nothing else rises, its values still there; wider where something does.
static void forecasts_take_it_in(void **state)
{
    (void)state;
    for (int fails = 0; fails < 2; fails++) {
        driven slope;
        driven_def def = usual;
        size_t changed = 0;
        def.days = 120;
        def.noise = 0.01;
        def.rise = fails != 0 ? 40.0 : 0.0;
        driven_make(&def, &slope);
        lac_forecast_set *without = look(&slope, 0), *with = look(&slope, 1);
        assert_true(lac_driver_withholds(with->effect) == (fails == 0));
        for (size_t k = 0; k < with->count; k++) {
            const lac_forecast *a = &without->forecast[k], *b = &with->forecast[k];
            assert_true(same(a->time, b->time));
            if (!a->issued || a->kind->baseline) {
                assert_true(a->issued == b->issued && same(a->low90, b->low90));
                assert_true(same(a->high90, b->high90) && same(a->high50, b->high50));
            } else if (fails == 0) {
                assert_false(b->issued);
                assert_non_null(strstr(b->fit.reason, "withheld: rain explains"));
                assert_true(a->low50 == b->low50 && a->high90 == b->high90);
                changed++;
            } else {
                assert_true(b->issued && b->low90 < a->low90 && b->high90 > a->high90);
                assert_true(b->low50 < a->low50 && b->high50 > a->high50);
                assert_true(b->low90 < b->low50 && b->low90 > b->issue_time);
                assert_true(b->high50 < b->high90);
                changed++;
            }
        }
        assert_true(changed > 0);
        lac_forecast_set_free(without);
        lac_forecast_set_free(with);
    }
}

static void any_numbers_are_survived(void **state)
{
    (void)state;
    static const double wild[] = {0.0, -1.0, 1e300, -1e300, 1e-300, NAN, 3.0};
    for (size_t k = 0; k < test_some(40); k++) {
        driven slope;
        lac_driver_effect e;
        driven_make(&usual, &slope);
        slope.driver.sum = k % 2 == 0;
        for (size_t i = 0; i < slope.n; i++) {
            if ((i * 7 + k) % 5 == 0) {
                slope.value[i] = wild[(i + k) % (sizeof wild / sizeof *wild)];
            }
        }
        e = ask(&slope);
        assert_true(isnan(e.p) || (e.p > 0.0 && e.p <= 1.0));
        assert_true(isnan(e.share) || (e.share >= 0.0 && e.share <= 1.0));
        lac_driver_effect_clear(&e);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_future_changes_nothing),
        cmocka_unit_test(units_and_clock_do_not_matter),
        cmocka_unit_test(amounts_are_means),
        cmocka_unit_test(forecasts_take_it_in),
        cmocka_unit_test(any_numbers_are_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
