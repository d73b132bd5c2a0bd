// SPDX-License-Identifier: GPL-3.0-or-later
// The noise of readings, however steep they are, and what it makes of velocities.
#include <stdlib.h>

#include <math.h>

#include "base/rng.h"
#include "series/motion.h"
#include "support/test.h"

enum { MOST = 400, DRAWS = 60, FEW = 57 };

static double times[MOST], values[MOST];

static double random_normal(size_t i)
{
    double pair[2];
    lac_random_normal(7, LAC_STREAM_TEST, i, 0, pair);
    return pair[0];
}

static lac_motion *move(lac_motion_def def, size_t n)
{
    const lac_readings readings = {.n = n, .time = times, .displacement = values};
    lac_motion *m = NULL;
    assert_int_equal(lac_motion_create(&def, &readings, &m, NULL), LAC_OK);
    return m;
}

static double drawn_noise(size_t n, size_t draw, double noise, double (*law)(double))
{
    for (size_t i = 0; i < n; i++) {
        const double part = ((double)i + 0.3 * sin(3.0 * (double)i)) / (double)n;
        times[i] = 1.4e9 + 8e7 * part;
        values[i] = law(part) + noise * random_normal(draw * MOST + i);
    }
    lac_motion *m = move((lac_motion_def){.raw = true}, n);
    const double found = m->noise / noise;
    lac_motion_free(m);
    return found;
}

static double level(double part) { return 0.0 * part; }
static double log_law(double part) { return -1.5 * log1p(-0.995 * part); }
static double steep(double part) { return 6.6 * part * part * part; }

// Where the signal bends by more than its noise from one reading to the next it is found as on a
// line, where it is as it ever was: the mean of many draws, and most of them, to 30 %.
static void noise_is_measured_on_steep_curves(void **state)
{
    (void)state;
    static const struct {
        double (*law)(double);
        double noise, within;
    } slopes[] = {
        {level, 1.0, 0.05}, {log_law, 2e-2, 0.1}, {log_law, 3e-3, 0.3}, {steep, 2e-3, 0.1}};
    for (size_t k = 0; k < sizeof slopes / sizeof *slopes; k++) {
        double mean = 0.0;
        size_t off = 0;
        for (size_t draw = 0; draw < DRAWS; draw++) {
            const double found = drawn_noise(FEW, draw, slopes[k].noise, slopes[k].law);
            mean += found / DRAWS;
            off += fabs(found - 1.0) > 0.3 ? 1 : 0;
        }
        assert_true(fabs(mean - 1.0) < slopes[k].within && off <= DRAWS / 4);
    }
}

static double squares_off(const lac_motion *m, double rate, double *told)
{
    double squares = 0.0;
    for (size_t i = 0; i < m->velocities; i++) {
        squares += (m->velocity[i] - rate) * (m->velocity[i] - rate);
        *told += m->velocity_error[i] * m->velocity_error[i];
    }
    return squares;
}

// Velocities of a line, uneven in time, scatter by what is told of each, however they are smoothed;
// so do those that are given.
static void errors_of_velocities_are_told(void **state)
{
    (void)state;
    static const lac_motion_def defs[] = {
        {.raw = true},
        {.smoothing = LAC_SMOOTH_AVERAGE, .points = 5},
        {.smoothing = LAC_SMOOTH_WINDOW, .window = 36000.0},
        {.smoothing = LAC_SMOOTH_SAVGOL, .points = 9, .order = 1},
        {.smoothing = LAC_SMOOTH_SAVGOL, .points = 9, .order = 3},
        {.smoothing = LAC_SMOOTH_AVERAGE, .points = 5, .raw = true}};
    for (size_t k = 0; k < 7; k++) {
        const bool given = k >= 5;
        double off = 0.0;
        double told = 0.0;
        for (size_t draw = 0; draw < DRAWS; draw++) {
            for (size_t i = 0; i < MOST; i++) {
                const double noise = random_normal(draw * MOST + i);
                times[i] = 3600.0 * ((double)i + 0.3 * sin(5.0 * (double)i));
                values[i] = given ? 1e-3 + 1e-5 * noise : 1e-6 * times[i] + 1e-3 * noise;
            }
            const lac_readings readings = {.n = MOST,
                                           .time = times,
                                           .displacement = given ? NULL : values,
                                           .velocity = given ? values : NULL};
            lac_motion *m = NULL;
            assert_int_equal(lac_motion_create(&defs[k % 6], &readings, &m, NULL), LAC_OK);
            assert_true(isnan(m->velocity_noise) == !given);
            assert_true(!given || fabs(m->velocity_noise / 1e-5 - 1.0) < 0.2);
            off += squares_off(m, given ? 1e-3 : 1e-6, &told);
            lac_motion_free(m);
        }
        assert_true(fabs(sqrt(told / off) - 1.0) < 0.1);
    }
}

// Rates over six decades, exact: where they are low they have not the noise that high ones seem to.
static void exact_rates_have_next_to_no_error(void **state)
{
    (void)state;
    for (size_t i = 0; i < 120; i++) {
        const double left = pow(1e-6, (double)i / 119.0);
        times[i] = 1e6 * (1.0 - left);
        values[i] = 1e-9 / left;
    }
    const lac_readings readings = {.n = 120, .time = times, .velocity = values};
    const lac_motion_def def = {0};
    lac_motion *m = NULL;
    assert_int_equal(lac_motion_create(&def, &readings, &m, NULL), LAC_OK);
    for (size_t i = 0; i < 120; i++) {
        assert_true(m->velocity_error[i] < 0.02 * m->velocity[i]);
    }
    lac_motion_free(m);
}

// A line has no noise but that of its last digit, or of a double.
static void noise_is_at_least_the_last_digit(void **state)
{
    (void)state;
    const lac_motion_def def = {0};
    for (size_t i = 0; i < 50; i++) {
        times[i] = 1800.0 * (double)(i + i / 7);
        values[i] = 1.0 + 7e-4 * (double)(i + i / 7);
    }
    for (int digits = 0; digits < 2; digits++) {
        const lac_readings readings = {.n = 50,
                                       .time = times,
                                       .displacement = values,
                                       .displacement_digit = digits ? 1e-6 : 0.0};
        const double least = digits ? 1e-6 : ldexp(values[49], -52);
        lac_motion *m = NULL;
        assert_int_equal(lac_motion_create(&def, &readings, &m, NULL), LAC_OK);
        assert_true(m->resolution == least && m->noise == least);
        for (size_t i = 0; i < m->velocities; i++) { // half a digit at either end of a secant
            const double bound = least / (times[i + 1] - times[i]);
            assert_true(m->rounding[i] >= bound && m->rounding[i] < bound + 1e-20);
        }
        lac_motion_free(m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_measured_on_steep_curves),
        cmocka_unit_test(errors_of_velocities_are_told),
        cmocka_unit_test(exact_rates_have_next_to_no_error),
        cmocka_unit_test(noise_is_at_least_the_last_digit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
