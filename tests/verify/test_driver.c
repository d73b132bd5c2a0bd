// SPDX-License-Identifier: GPL-3.0-or-later
// Drivers whose answer is known are found with it; those that have none are not, but for the share
// of chances that p stands for.
#include <math.h>
#include <string.h>

#include "base/statistics.h"
#include "support/driven.h"
#include "support/test.h"

static const double day = 86400.0, mm = 1e-3;

enum { SLOPES = 11, CHANCES = 200 };

// Median over slopes of memory and of the answer, over what they are.
static void assert_memory_found(double memory, size_t days)
{
    double scale[SLOPES], slope[SLOPES];
    for (size_t k = 0; k < SLOPES; k++) {
        driven slope_of;
        lac_driver_effect e;
        driven_make(&(driven_def){.days = days,
                                  .seed = k + 1,
                                  .weather = DRIVEN_RAIN,
                                  .answer = 10.0,
                                  .memory = memory,
                                  .noise = 0.3},
                    &slope_of);
        driven_explain(&slope_of, &e);
        assert_int_equal(e.verdict, LAC_EXPLAINS);
        assert_int_equal(e.response, LAC_RESPONSE_MEMORY);
        assert_true(e.p < 0.011 && e.share > 0.8);
        scale[k] = e.scale / (memory * day);
        slope[k] = e.slope / (10.0 * mm / day);
        lac_driver_effect_clear(&e);
    }
    const double found = lac_median(SLOPES, scale), answer = lac_median(SLOPES, slope);
    assert_true(found > 0.85 && found < 1.15);
    assert_true(answer > 0.9 && answer < 1.1);
}

static void a_reservoir_is_found(void **state)
{
    (void)state;
    assert_memory_found(3.0, 100);
    assert_memory_found(8.0, 150);
}

static void a_lag_is_found(void **state)
{
    (void)state;
    driven slope;
    lac_driver_effect e;
    driven_make(
        &(driven_def){
            .days = 100, .seed = 3, .weather = DRIVEN_RAIN, .answer = -1.0, .lag = 4, .noise = 0.2},
        &slope);
    driven_explain(&slope, &e);
    assert_int_equal(e.verdict, LAC_EXPLAINS);
    assert_int_equal(e.response, LAC_RESPONSE_LAG);
    assert_true(fabs(e.scale - 4.0 * day) < 0.5 * day);
    assert_true(fabs(e.slope / (-1.0 * mm / day) - 1.0) < 0.1);
    assert_true(e.share > 0.85);
    for (size_t i = 30; i < slope.n; i++) { // what it adds, reading by reading
        assert_true(fabs(e.value[i] - slope.value[i]) < 1e-6);
        assert_true(fabs(e.part[i] * day / mm + slope.value[i - 4]) <
                    0.6 + 0.2 * slope.value[i - 4]);
    }
    lac_driver_effect_clear(&e);
}

// A slope that moves while its lake falls.
static void a_change_is_found(void **state)
{
    (void)state;
    driven slope;
    lac_driver_effect e;
    driven_make(
        &(driven_def){.days = 120, .seed = 5, .weather = DRIVEN_RED, .change = -2.0, .noise = 0.2},
        &slope);
    driven_explain(&slope, &e);
    assert_int_equal(e.verdict, LAC_EXPLAINS);
    assert_int_equal(e.response, LAC_RESPONSE_CHANGE);
    assert_true(e.slope < 0.0 && e.share > 0.5);
    lac_driver_effect_clear(&e);
}

// A twentieth of all chances, 10 of 200, within 3.3 standard deviations; and half of them below a
// half within as many.
static void assert_chances(driven_weather weather, bool red)
{
    size_t few = 0, half = 0;
    for (size_t k = 0; k < CHANCES; k++) {
        driven slope;
        lac_driver_effect e;
        driven_make(
            &(driven_def){.days = 50, .seed = k + 1, .weather = weather, .noise = 1.0, .red = red},
            &slope);
        driven_explain(&slope, &e);
        few += e.p <= 0.05 ? 1 : 0;
        half += e.p <= 0.5 ? 1 : 0;
        assert_true(e.verdict != LAC_EXPLAINS || e.p <= 0.05);
        lac_driver_effect_clear(&e);
    }
    assert_in_range(few, 1, 20);
    assert_in_range(half, 77, 123);
}

static void nothing_explains_white_noise(void **state)
{
    (void)state;
    assert_chances(DRIVEN_WHITE, false);
    assert_chances(DRIVEN_RAIN, false);
}

static void red_noise_does_not_explain_red_noise(void **state)
{
    (void)state;
    assert_chances(DRIVEN_RED, true);
}

static lac_remains remains(const driven_def *def)
{
    driven slope;
    lac_driver_effect e;
    driven_make(def, &slope);
    driven_explain(&slope, &e);
    const lac_remains left = e.verdict == LAC_EXPLAINS ? e.remains : LAC_REMAINS_UNKNOWN;
    assert_true(lac_driver_withholds(&e) == (left == LAC_REMAINS_LEVEL));
    lac_driver_effect_clear(&e);
    return left;
}

// Rain that grows makes the rate rise; without its part it does not. A slope that fails in the same
// rain still does.
static void what_remains_is_told(void **state)
{
    (void)state;
    size_t level = 0, rising = 0;
    for (size_t k = 0; k < SLOPES; k++) {
        driven_def def = {.days = 120,
                          .seed = k + 1,
                          .weather = DRIVEN_WET,
                          .answer = 3.0,
                          .memory = 4.0,
                          .noise = 0.3};
        level += remains(&def) == LAC_REMAINS_LEVEL ? 1 : 0;
        def.rise = 40.0;
        rising += remains(&def) == LAC_REMAINS_RISING ? 1 : 0;
    }
    assert_in_range(level, SLOPES - 3, SLOPES);
    assert_int_equal(rising, SLOPES);
}

static void assert_unknown(const driven *slope, const char *reason)
{
    lac_driver_effect e;
    driven_explain(slope, &e);
    assert_int_equal(e.verdict, LAC_EXPLAINS_UNKNOWN);
    assert_non_null(strstr(e.reason, reason));
    assert_true(isnan(e.p));
    assert_false(lac_driver_withholds(&e));
    lac_driver_effect_clear(&e);
}

static void what_cannot_be_told_is_said(void **state)
{
    (void)state;
    driven slope;
    const driven_def def = {
        .days = 60, .seed = 1, .weather = DRIVEN_RAIN, .answer = 3.0, .memory = 3.0, .noise = 0.1};
    driven_make(&def, &slope);
    slope.readings.n = 15;
    assert_unknown(&slope, "too few readings: 14 intervals since rain begins, at least 15");
    slope.readings.n = 1;
    assert_unknown(&slope, "too few readings");
    slope.readings.n = slope.n;
    slope.driver.n = 50;
    assert_unknown(&slope, "ends before the readings");
    slope.driver.n = 0;
    assert_unknown(&slope, "ends before the readings");
    slope.driver.n = slope.n;
    for (size_t i = 0; i < 55; i++) {
        slope.value[i] = i % 4 != 0 ? NAN : slope.value[i];
    }
    assert_unknown(&slope, "too many gaps");
    for (size_t i = 0; i < slope.n; i++) {
        slope.value[i] = 7.0;
    }
    assert_unknown(&slope, "is constant");
    driven_make(&def, &slope);
    for (size_t i = 0; i < slope.n; i++) {
        slope.displacement[i] = 0.01 * (double)i;
    }
    assert_unknown(&slope, "the rate is constant");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_reservoir_is_found),
        cmocka_unit_test(a_lag_is_found),
        cmocka_unit_test(a_change_is_found),
        cmocka_unit_test(nothing_explains_white_noise),
        cmocka_unit_test(red_noise_does_not_explain_red_noise),
        cmocka_unit_test(what_remains_is_told),
        cmocka_unit_test(what_cannot_be_told_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
