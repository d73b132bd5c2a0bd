// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a rate is told to rise: of motions that do, that do not, and that noise hides.
#include <stdlib.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "forecast/verdict.h"
#include "support/test.h"

enum { N = 60, SEEDS = 200 };
static const double interval = 3600.0;

static double times[N], values[N];

static double random_normal(size_t draw, size_t i)
{
    double pair[2];
    lac_random_normal(7, LAC_STREAM_TEST, draw * N + i, 0, pair);
    return pair[0];
}

// The trend of the first n values, displacements or velocities.
static lac_trend find(size_t n, bool velocities)
{
    const lac_readings readings = {.n = n,
                                   .time = times,
                                   .displacement = velocities ? NULL : values,
                                   .velocity = velocities ? values : NULL};
    const lac_motion_def def = {.raw = true};
    lac_motion *m = NULL;
    assert_int_equal(lac_motion_create(&def, &readings, &m, NULL), LAC_OK);
    const lac_trend found = lac_trend_find(m);
    lac_motion_free(m);
    assert_true((found.answer == LAC_CANNOT_TELL) == (found.reason[0] != '\0'));
    return found;
}

static void fill_times(bool even)
{
    for (size_t i = 0; i < N; i++) {
        const double t = (double)i + (even ? 0.0 : 0.45 * sin(7.0 * (double)i));
        times[i] = 1.4e9 + interval * (even ? t : t * (1.0 + 0.05 * t));
    }
}

// law(part of the time until failure, or of the window), and noise.
static void fill(double (*law)(double), double last, size_t draw, double noise)
{
    for (size_t i = 0; i < N; i++) {
        const double part = last * (times[i] - times[0]) / (times[N - 1] - times[0]);
        values[i] = law(part) + noise * random_normal(draw, i);
    }
}

static double line(double part) { return part; }
static double level(double part) { return 1.0 + 0.0 * part; }
static double log_law(double part) { return -log1p(-part); }
static double rate_of_log_law(double part) { return 1.0 / (1.0 - part); }
static double slowing(double part) { return sqrt(part + 0.01); }
static double relaxing(double part) { return 0.2 * part - expm1(-6.0 * part); }
static double rate_that_falls(double part) { return 2.0 - part; }

// Of so many draws how many are told to rise.
static size_t risen(double (*law)(double), double last, double noise, bool velocities)
{
    size_t count = 0;
    for (size_t draw = 0; draw < SEEDS; draw++) {
        fill(law, last, draw, noise);
        count += find(N, velocities).answer == LAC_DOES;
    }
    return count;
}

static void a_steady_line_does_not_rise(void **state)
{
    (void)state;
    for (size_t even = 0; even < 2; even++) {
        fill_times(even == 1);
        for (size_t n = 6; n <= N; n++) {
            fill(line, 1.0, 0, 0.0);
            assert_int_not_equal(find(n, false).answer, LAC_DOES);
            fill(level, 1.0, 0, 0.0);
            assert_int_not_equal(find(n, true).answer, LAC_DOES);
        }
        fill(line, 1.0, 0, 0.0);
        assert_int_equal(find(N, false).answer, LAC_DOES_NOT);
    }
}

// One of a hundred may, as p is that of "yes"; a few more by chance over so many draws.
static void noise_about_a_line_seldom_rises(void **state)
{
    (void)state;
    static const double noises[] = {0.002, 0.05, 1.0};
    for (size_t k = 0; k < test_some(6); k++) {
        fill_times(k % 2 == 0);
        assert_in_range(risen(line, 1.0, noises[k / 2], false), 0, SEEDS * 4 / 100);
        assert_in_range(risen(level, 1.0, noises[k / 2], true), 0, SEEDS * 4 / 100);
    }
}

// At a twentieth of its life left, in noise of a hundredth of the way so far.
static void a_law_that_ends_in_failure_rises(void **state)
{
    (void)state;
    for (size_t even = 0; even < 2; even++) {
        fill_times(even == 1);
        assert_in_range(risen(log_law, 0.95, 0.01 * log_law(0.95), false), SEEDS * 95 / 100, SEEDS);
        assert_in_range(risen(rate_of_log_law, 0.95, 0.01 * rate_of_log_law(0.95), true),
                        SEEDS * 95 / 100, SEEDS);
    }
    fill(log_law, 0.95, 0, 0.0);
    const lac_trend exact = find(N, false);
    assert_true(exact.answer == LAC_DOES && exact.rise > exact.error && exact.rate > 0.0);
    assert_true(exact.n <= N && exact.start == times[N - exact.n]);
    assert_true(exact.p < 0.01);
}

// Twenty standard deviations, at the end, before it, in the middle: raw, so that none is taken out.
static void one_bad_reading_makes_no_rise(void **state)
{
    (void)state;
    static const size_t places[] = {N - 1, N - 2, N / 2, 0};
    const double noise = 0.01;
    fill_times(true);
    for (size_t k = 0; k < test_some(sizeof places / sizeof *places); k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            size_t count = 0;
            for (size_t draw = 0; draw < SEEDS; draw++) {
                fill(line, 1.0, draw, noise);
                values[places[k]] += 20.0 * sign * noise;
                count += find(N, false).answer == LAC_DOES;
            }
            assert_in_range(count, 0, SEEDS * 4 / 100);
        }
    }
}

static void few_readings_cannot_tell(void **state)
{
    (void)state;
    fill_times(true);
    fill(log_law, 0.95, 0, 0.0);
    const lac_trend found = find(5, false);
    assert_int_equal(found.answer, LAC_CANNOT_TELL);
    assert_string_equal(found.reason, "too few readings: 5, at least 6");
    assert_true(isnan(found.p) && isnan(found.rise));
    assert_int_equal(find(1, false).answer, LAC_CANNOT_TELL);
    assert_int_equal(find(5, true).answer, LAC_CANNOT_TELL);
}

// What noise hides is said, and how much more would be needed.
static void noise_that_hides_is_told(void **state)
{
    (void)state;
    fill_times(true);
    fill(line, 1.0, 3, 0.3);
    const lac_trend found = find(N, false);
    assert_int_equal(found.answer, LAC_CANNOT_TELL);
    assert_true(found.p > 0.0 && found.p <= 1.0 && found.error > 0.0);
    assert_non_null(strstr(found.reason, "would not be seen in the noise"));
    assert_non_null(strstr(found.reason, "more readings would show"));
    assert_null(strstr(found.reason, "nan"));
}

static double runaway(double part) { return exp(10.0 * (part - 1.0)); }

// By half or more in every window, in noise as large as all that moved: "no" is said of it at most
// once in twenty, though many windows are asked; a few more by chance.
static void a_rise_that_noise_hides_is_not_excluded(void **state)
{
    (void)state;
    fill_times(true);
    size_t count = 0;
    for (size_t draw = 0; draw < SEEDS; draw++) {
        fill(runaway, 1.0, draw, 1.0);
        count += find(N, false).answer == LAC_DOES_NOT;
    }
    assert_in_range(count, 0, SEEDS * 8 / 100);
}

// With noise that a window may mistake, one in a hundred; with little, none.
static void what_slows_does_not_rise(void **state)
{
    (void)state;
    static double (*const laws[])(double) = {slowing, relaxing};
    for (size_t even = 0; even < 2; even++) {
        fill_times(even == 1);
        for (size_t k = 0; k < 2; k++) {
            assert_int_equal(risen(laws[k], 1.0, 1e-3, false), 0);
            for (size_t n = 6; n <= N; n += test_few() ? 9 : 1) {
                fill(laws[k], 1.0, 0, 0.0);
                assert_int_not_equal(find(n, false).answer, LAC_DOES);
            }
        }
        assert_int_equal(risen(rate_that_falls, 1.0, 0.01, true), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_steady_line_does_not_rise),
        cmocka_unit_test(noise_about_a_line_seldom_rises),
        cmocka_unit_test(a_law_that_ends_in_failure_rises),
        cmocka_unit_test(one_bad_reading_makes_no_rise),
        cmocka_unit_test(few_readings_cannot_tell),
        cmocka_unit_test(noise_that_hides_is_told),
        cmocka_unit_test(a_rise_that_noise_hides_is_not_excluded),
        cmocka_unit_test(what_slows_does_not_rise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
