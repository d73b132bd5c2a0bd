// SPDX-License-Identifier: GPL-3.0-or-later
// What gives a level: slopes that fail, that only change their rate, and that rain drives.
#include <stdlib.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "forecast/forecast.h"
#include "support/driven.h"
#include "support/test.h"

enum { N = 100, SEEDS = 50, SLOPES = 10 };
static const double day = 86400.0;

static double times[N], displacement[N];

static double random_normal(size_t draw, size_t i)
{
    double pair[2];
    lac_random_normal(11, LAC_STREAM_TEST, draw * N + i, 0, pair);
    return pair[0];
}

static lac_forecast_def default_def(void)
{
    lac_forecast_def def = lac_forecast_default();
    def.motion.raw = true;
    return def;
}

static lac_verdict judge(const lac_forecast_def *def, const lac_readings *readings)
{
    lac_forecast_set *o = NULL;
    assert_int_equal(lac_forecast_set_create(def, readings, &o, NULL), LAC_OK);
    const lac_verdict found = o->verdict;
    lac_forecast_set_free(o);
    assert_true(found.rule[0] != '\0' && strstr(found.rule, "nan") == NULL);
    assert_true(strlen(found.rule) < sizeof found.rule - 1);
    return found;
}

static lac_verdict judge_first(const lac_forecast_def *def, size_t n)
{
    const lac_readings readings = {.n = n, .time = times, .displacement = displacement};
    return judge(def, &readings);
}

// A reading a day of law(part), up to part = last, in noise that is a part of the way so far.
static void fill(double (*law)(double), double last, size_t draw, double noise)
{
    const double way = law(last) - law(0.0);
    for (size_t i = 0; i < N; i++) {
        times[i] = 1.4e9 + day * (double)i;
        displacement[i] = law(last * (double)i / (N - 1)) + noise * way * random_normal(draw, i);
    }
}

static double voight_2(double part) { return -log1p(-part); }
static double voight_15(double part) { return 1.0 / (1.0 - part); }
static double line(double part) { return part; }
static double ramp(double part) { return part + 2.0 * 0.04 * log1p(exp((part - 0.6) / 0.04)); }
static double step(double part)
{
    return 0.3 * part + (part > 0.6 ? -expm1((0.6 - part) / 0.08) : 0.0);
}

static double slowing(double part) { return log1p(20.0 * part); }

// A last reading far off is no quiet, up or down; a smooth curve without noise has none.
static void jump_of_the_last_reading_is_watched(void **state)
{
    (void)state;
    const lac_forecast_def def = default_def();
    for (int way = -1; way <= 1; way++) {
        fill(line, 1.0, 3, 0.002);
        displacement[N - 1] += 0.3 * way;
        const lac_verdict found = judge_first(&def, N);
        assert_int_equal(found.level, way != 0 ? LAC_WATCH : LAC_QUIET);
        assert_int_equal(strstr(found.rule, "measure again") != NULL, way != 0);
    }
    fill(slowing, 1.0, 0, 0.0);
    assert_int_equal(judge_first(&def, N).level, LAC_QUIET);
}

// 0.5 mm/day, and so many times that in the last days, in noise of 1 mm.
static lac_verdict change(size_t days, double times_faster)
{
    lac_forecast_def def = lac_forecast_default();
    for (size_t i = 0; i < N; i++) {
        const double fast = i + days < N ? 0.0 : (double)(i + days + 1 - N);
        times[i] = 1.4e9 + day * (double)i;
        displacement[i] =
            5e-4 * ((double)i + (times_faster - 1.0) * fast) + 1e-3 * random_normal(days, i);
    }
    return judge_first(&def, N);
}

// A rate that changes at once is watched for as long as it lasts, forward and back.
static void new_rate_is_watched(void **state)
{
    (void)state;
    for (size_t days = 2; days <= 12; days += 5) {
        for (int way = -1; way <= 1; way += 2) {
            const lac_verdict v = change(days, 120.0 * way);
            assert_int_equal(v.level, LAC_WATCH);
            assert_true(fabs(v.surge.rate) > 0.04 / day && fabs(v.surge.rate) < 0.065 / day);
            assert_true(fabs(fabs(v.surge.before) - 5e-4 / day) < 4e-4 / day);
            assert_true(times[N - 1] - v.surge.since >= 2.0 * day);
            assert_non_null(strstr(v.rule, "usual before"));
            const bool turned = way < 0 && days == 12; // it fell by more than it had risen
            assert_int_equal(strstr(v.rule, "went back") != NULL, way < 0 && !turned);
            assert_true(v.trend.answer != LAC_DOES_NOT || v.trend.start >= v.surge.since);
        }
    }
    assert_null(strstr(change(12, 1.0).rule, "usual before"));
    assert_true(change(12, 4.0).surge.factor < lac_levels_default().surge);
}

// Where values have stopped nothing is quiet, and no time that is over is told.
static void silence_is_watched(void **state)
{
    (void)state;
    const lac_forecast_def def = default_def();
    for (size_t missing = 0; missing <= 20; missing += 10) {
        lac_forecast_set *o = NULL;
        fill(voight_2, 0.99, 1, 1e-3);
        for (size_t i = N - missing; i < N; i++) {
            displacement[i] = NAN;
        }
        const lac_readings readings = {.n = N, .time = times, .displacement = displacement};
        assert_int_equal(lac_forecast_set_create(&def, &readings, &o, NULL), LAC_OK);
        assert_true(o->verdict.level >= LAC_WATCH);
        assert_int_equal(strstr(o->verdict.rule, "no value has come") != NULL, missing > 0);
        for (size_t k = 0; k < o->count; k++) {
            assert_true(!o->forecast[k].issued || o->forecast[k].time > o->issue_time);
        }
        lac_forecast_set_free(o);
    }
}

// A sensor that repeats its last value is no slope at rest; one that was as coarse before is.
static void repeating_sensor_is_watched(void **state)
{
    (void)state;
    for (size_t stuck = 5; stuck <= 6; stuck++) {
        for (int coarse = 0; coarse < 2; coarse++) {
            fill(line, 1.0, 1, 1e-3);
            for (size_t i = 1; coarse && i <= 8; i++) {
                displacement[10 + i] = displacement[10];
            }
            for (size_t i = N - stuck; i < N; i++) {
                displacement[i] = displacement[N - stuck];
            }
            const lac_forecast_def def = default_def();
            const lac_verdict v = judge_first(&def, N);
            assert_int_equal(strstr(v.rule, "sensor has stopped") != NULL, stuck == 6 && !coarse);
        }
    }
}

// An alarm does not go out as failure nears, where most methods no longer fit the whole of it.
static void alarm_stays_to_the_end(void **state)
{
    (void)state;
    const lac_forecast_def def = default_def();
    for (size_t left = 1; left <= 4; left++) {
        fill(voight_15, 1.0 - (double)left / N, left, 0.003);
        assert_int_equal(judge_first(&def, N).level, LAC_ALARM);
    }
}

// At 3 % of its life left, in noise of 0.3 % of the way.
static void failure_is_warned_of(void **state)
{
    (void)state;
    static double (*const laws[])(double) = {voight_2, voight_15};
    const lac_forecast_def def = default_def();
    for (size_t k = 0; k < 2; k++) {
        for (size_t draw = 0; draw < SEEDS / 5; draw++) {
            fill(laws[k], 0.97, draw, 3e-3);
            const lac_verdict v = judge_first(&def, N);
            assert_true(v.level >= LAC_WARNING);
            assert_true(v.trend.answer == LAC_DOES && v.log_odds >= v.needed);
            assert_true(v.near <= v.issued);
            assert_true(isnan(v.chance) ? v.issued < 3 : v.chance >= 0.0 && v.chance <= 1.0);
            for (size_t q = 1; q < 5; q++) {
                assert_true(isnan(v.chance) ? isnan(v.pooled[q]) : v.pooled[q] >= v.pooled[q - 1]);
            }
        }
    }
}

// A day before, with methods that agree; not where the chance or their share is less than asked.
static void failure_within_the_horizon_is_an_alarm(void **state)
{
    (void)state;
    lac_forecast_def def = default_def();
    fill(voight_2, 0.99, 0, 1e-3);
    const lac_verdict v = judge_first(&def, N);
    assert_int_equal(v.level, LAC_ALARM);
    assert_non_null(strstr(v.rule, "methods expect it within"));
    assert_true(v.chance >= def.levels.chance);
    assert_true((double)v.near >= def.levels.agree * (double)v.issued);
    def.levels.chance = v.chance;
    assert_int_equal(judge_first(&def, N).level, LAC_ALARM);
    def.levels.chance = 1.0 + v.chance;
    assert_int_equal(judge_first(&def, N).level, LAC_WARNING);
    def.levels.chance = 0.0;
    def.levels.agree = 1.0 + (double)v.near / (double)v.issued;
    assert_int_equal(judge_first(&def, N).level, LAC_WARNING);
}

// After a rate went over to one three times as high, and after a step: one of fifty may, by chance.
static void new_rates_and_steps_are_not_warned_of(void **state)
{
    (void)state;
    static double (*const laws[])(double) = {line, ramp, step};
    const lac_forecast_def def = default_def();
    for (size_t k = 0; k < 3; k++) {
        size_t warned = 0;
        for (size_t draw = 0; draw < SEEDS; draw++) {
            fill(laws[k], 1.0, draw, 3e-3);
            warned += judge_first(&def, N).level > LAC_WATCH;
        }
        assert_in_range(warned, 0, 1);
    }
}

// Odds that one reading alone would have to have are another number than those that it has.
static void odds_that_do_not_do_alone_are_told_apart(void **state)
{
    (void)state;
    size_t told = 0;
    lac_forecast_def def = default_def();
    def.levels.odds = 6.0;
    for (size_t draw = 0; draw < SEEDS; draw++) {
        fill(voight_2, 0.9, draw, 0.02);
        const lac_verdict v = judge_first(&def, N);
        told += strstr(v.rule, "in a row, or") != NULL;
        assert_true(strstr(v.rule, "in a row, or") == NULL || strstr(v.rule, "above") == NULL);
    }
    assert_true(told > 0);
}

// A failure that comes to rest: with `hold` a warning is there as long as there was one without it
// at any of so many readings before.
static void a_warning_holds(void **state)
{
    (void)state;
    enum { REST = 80 };
    lac_forecast_def def = default_def();
    const size_t hold = (size_t)def.levels.hold;
    bool bare[N] = {false};
    size_t held = 0, ended = 0;
    for (size_t i = 0; i < N; i++) {
        const double part = 0.97 * (double)(i < REST ? i : REST) / REST;
        times[i] = 1.4e9 + day * (double)i;
        displacement[i] = voight_2(part) + 1e-2 * random_normal(0, i);
    }
    for (size_t n = REST - 3; n <= REST + 12; n++) {
        def.levels.hold = 0.0;
        bare[n - 1] = judge_first(&def, n).level >= LAC_WARNING;
        if (n < REST - 3 + hold) {
            continue;
        }
        bool expected = false;
        for (size_t back = 0; back <= hold; back++) {
            expected = expected || bare[n - 1 - back];
        }
        def.levels.hold = (double)hold;
        const lac_verdict v = judge_first(&def, n);
        assert_true((v.level >= LAC_WARNING) == expected);
        held += expected && !bare[n - 1];
        ended += !expected && n > REST;
        assert_true((strstr(v.rule, "ago") != NULL) == (expected && !bare[n - 1]));
    }
    assert_in_range(held, hold, N);
    assert_in_range(ended, 1, N);
}

// A line of 10 mm/day is quiet but for what thresholds of its rate say.
static void rates_give_a_level_where_named(void **state)
{
    (void)state;
    const double mm_day = 1e-3 / day;
    lac_forecast_def def = default_def();
    fill(line, 1.0, 0, 0.0);
    for (size_t i = 0; i < N; i++) {
        displacement[i] = 1e-2 * (double)i;
    }
    assert_int_equal(judge_first(&def, N).level, LAC_QUIET);
    double *const threshold[] = {&def.levels.watch_rate, &def.levels.warning_rate,
                                 &def.levels.alarm_rate};
    for (size_t k = 0; k < 3; k++) {
        *threshold[k] = 11.0 * mm_day;
        assert_int_equal(judge_first(&def, N).level, LAC_QUIET + k);
        *threshold[k] = 9.0 * mm_day;
        const lac_verdict v = judge_first(&def, N);
        assert_int_equal(v.level, LAC_WATCH + k);
        assert_non_null(strstr(v.rule, "10 mm/day, is at least 9 mm/day"));
    }
}

// Where any rise would be a warning, one that rain explains is to be watched.
static void rain_that_explains_is_watched(void **state)
{
    (void)state;
    size_t fewer = 0;
    for (size_t k = 0; k < SLOPES; k++) {
        const driven_def wet = {.days = 120,
                                .seed = k + 1,
                                .weather = DRIVEN_WET,
                                .answer = 3.0,
                                .memory = 4.0,
                                .noise = 0.3};
        driven slope;
        driven_make(&wet, &slope);
        lac_forecast_def def = default_def();
        def.levels.odds = -1e6;
        const lac_level alone = judge(&def, &slope.readings).level;
        def.drivers = 1;
        def.driver = &slope.driver;
        const lac_verdict v = judge(&def, &slope.readings);
        assert_true(v.level <= alone);
        if (v.level < alone) {
            fewer++;
            assert_int_equal(v.level, LAC_WATCH);
            assert_non_null(strstr(v.rule, "rain explains"));
        }
    }
    assert_in_range(fewer, 1, SLOPES);
}

// What few readings do not tell is not there; the level is quiet and says why.
static void few_readings_are_quiet(void **state)
{
    (void)state;
    const lac_forecast_def def = default_def();
    fill(voight_2, 0.97, 0, 0.0);
    for (size_t n = 1; n < 6; n++) {
        const lac_verdict v = judge_first(&def, n);
        assert_int_equal(v.level, LAC_QUIET);
        assert_int_equal(v.trend.answer, LAC_CANNOT_TELL);
        assert_true(isnan(v.log_odds) && isnan(v.chance) && isnan(v.pooled[2]));
        assert_int_equal(v.issued, 0);
        assert_string_equal(v.rule, v.trend.reason);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(failure_is_warned_of),
        cmocka_unit_test(failure_within_the_horizon_is_an_alarm),
        cmocka_unit_test(new_rates_and_steps_are_not_warned_of),
        cmocka_unit_test(odds_that_do_not_do_alone_are_told_apart),
        cmocka_unit_test(a_warning_holds),
        cmocka_unit_test(jump_of_the_last_reading_is_watched),
        cmocka_unit_test(alarm_stays_to_the_end),
        cmocka_unit_test(new_rate_is_watched),
        cmocka_unit_test(silence_is_watched),
        cmocka_unit_test(repeating_sensor_is_watched),
        cmocka_unit_test(rates_give_a_level_where_named),
        cmocka_unit_test(rain_that_explains_is_watched),
        cmocka_unit_test(few_readings_are_quiet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
