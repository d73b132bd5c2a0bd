// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "base/statistics.h"
#include "series/motion.h"
#include "support/test.h"

enum { MOST = 400 };

static double times[MOST], values[MOST];

static lac_motion *move(lac_motion_def def, size_t n)
{
    const lac_readings readings = {.n = n, .time = times, .displacement = values};
    lac_motion *m = NULL;
    lac_error err = {""};
    if (lac_motion_create(&def, &readings, &m, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return m;
}

// d = 3 t - 0.2 t^2 + 0.01 t^3 at uneven times
static void fill_cubic(size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const double t = (double)i + 0.3 * sin(5.0 * (double)i);
        times[i] = 1.4e9 + t;
        values[i] = 3.0 * t - 0.2 * t * t + 0.01 * t * t * t;
    }
}

static double slope_at(double time)
{
    const double t = time - 1.4e9;
    return 3.0 - 0.4 * t + 0.03 * t * t;
}

static double random_normal(size_t i)
{
    double pair[2];
    lac_random_normal(7, LAC_STREAM_TEST, i, 0, pair);
    return pair[0];
}

static void secants_stand_between_readings(void **state)
{
    (void)state;
    fill_cubic(30);
    lac_motion *m = move((lac_motion_def){.raw = true}, 30);
    assert_int_equal(m->velocities, 29);
    for (size_t i = 0; i < 29; i++) {
        const double step = times[i + 1] - times[i];
        assert_true(m->velocity_time[i] == times[i] + 0.5 * step);
        // of a cubic the secant is the slope in the middle but for a term of its step squared
        assert_true(fabs(m->velocity[i] - slope_at(m->velocity_time[i]) - 0.0025 * step * step) <
                    1e-5);
    }
    lac_motion_free(m);
}

static void polynomials_are_found_again_at_their_end(void **state)
{
    (void)state;
    fill_cubic(40);
    lac_motion *m = move(
        (lac_motion_def){.smoothing = LAC_SMOOTH_SAVGOL, .points = 9, .order = 3, .raw = true}, 40);
    assert_int_equal(m->velocities, 32);
    for (size_t i = 0; i < m->velocities; i++) {
        assert_true(m->velocity_time[i] == times[i + 8]);
        assert_true(fabs(m->velocity[i] - slope_at(times[i + 8])) < 1e-5);
    }
    lac_motion_free(m);
}

static void windows_reach_back(void **state)
{
    (void)state;
    for (size_t i = 0; i < 50; i++) {
        times[i] = 10.0 * (double)i;
        values[i] = 1.0 + 2.5 * times[i];
    }
    lac_motion *m =
        move((lac_motion_def){.smoothing = LAC_SMOOTH_WINDOW, .window = 40.0, .raw = true}, 50);
    assert_int_equal(m->velocities, 46); // from the first whole window
    for (size_t i = 0; i < m->velocities; i++) {
        assert_true(fabs(m->velocity[i] - 2.5) < 1e-12);
        assert_true(fabs(m->velocity_time[i] - (times[i + 4] - 20.0)) < 1e-9);
    }
    lac_motion_free(m);
}

static void averages_are_of_velocities(void **state)
{
    (void)state;
    for (size_t i = 0; i < 20; i++) {
        times[i] = (double)i;
        values[i] = (double)(i * i);
    }
    lac_motion *m =
        move((lac_motion_def){.smoothing = LAC_SMOOTH_AVERAGE, .points = 5, .raw = true}, 20);
    assert_int_equal(m->velocities, 15);
    for (size_t i = 0; i < m->velocities; i++) {
        assert_true(fabs(m->velocity_time[i] - ((double)i + 2.5)) < 1e-12);
        assert_true(fabs(m->velocity[i] - 2.0 * ((double)i + 2.5)) < 1e-12);
    }
    lac_motion_free(m);
}

static void velocities_alone_are_integrated(void **state)
{
    (void)state;
    double rates[10];
    for (size_t i = 0; i < 10; i++) {
        times[i] = 2.0 * (double)i;
        rates[i] = i == 4 ? NAN : times[i];
    }
    const lac_readings readings = {.n = 10, .time = times, .velocity = rates};
    const lac_motion_def def = {0};
    lac_motion *m = NULL;
    assert_int_equal(lac_motion_create(&def, &readings, &m, NULL), LAC_OK);
    assert_true(m->integrated && isnan(m->noise));
    assert_int_equal(m->velocities, 9);
    assert_true(fabs(m->displacement[8] - 0.5 * 18.0 * 18.0) < 1e-9);
    lac_motion_free(m);
}

static void fill_noisy(size_t n, double noise)
{
    for (size_t i = 0; i < n; i++) {
        times[i] = 3600.0 * (double)i;
        values[i] = 0.01 * (double)i + noise * random_normal(i);
    }
}

static void noise_is_measured(void **state)
{
    (void)state;
    fill_noisy(MOST, 2e-3);
    lac_motion *m = move((lac_motion_def){0}, MOST);
    assert_true(fabs(m->noise / 2e-3 - 1.0) < 0.1);
    assert_int_equal(m->outliers + m->resets + m->gaps, 0);
    assert_true(m->interval == 3600.0 && m->longest_gap == 3600.0);
    lac_motion_free(m);
}

// An extensometer that returns to its zero whenever it is set back, on a curve.
static void resets_are_found_on_steep_curves(void **state)
{
    (void)state;
    double zero = 0.0;
    for (size_t i = 0; i < 100; i++) {
        const double way = 3.3 * pow((double)i / 100.0, 3.0);
        zero = i == 60 || i == 90 ? way : zero;
        times[i] = 3600.0 * (double)i;
        values[i] = way - zero + 2e-3 * random_normal(i);
    }
    lac_motion *m = move((lac_motion_def){0}, 100);
    assert_true(m->resets == 2 && m->outliers == 0 && m->n == 100);
    for (size_t i = 0; i < 100; i++) {
        assert_true(fabs(m->displacement[i] - 3.3 * pow((double)i / 100.0, 3.0)) < 0.02);
    }
    lac_motion_free(m);
}

static void outliers_and_resets_are_taken_out(void **state)
{
    (void)state;
    fill_noisy(MOST, 1e-3);
    values[100] += 0.5;
    values[101] = values[101]; // the neighbours agree
    values[250] -= 0.3;
    for (size_t i = 300; i < MOST; i++) {
        values[i] -= 3.0; // back to the start
    }
    for (size_t i = 350; i < MOST; i++) {
        times[i] += 86400.0;
    }
    lac_motion *m = move((lac_motion_def){0}, MOST);
    assert_int_equal(m->outliers, 2);
    assert_int_equal(m->resets, 1);
    assert_int_equal(m->gaps, 1);
    assert_int_equal(m->n, MOST - 2);
    for (size_t i = 0; i < m->n; i++) {
        const size_t reading = i < 100 ? i : i < 249 ? i + 1 : i + 2;
        assert_true(fabs(m->displacement[i] - 0.01 * (double)reading) < 0.02);
    }
    lac_motion_free(m);
    m = move((lac_motion_def){.raw = true}, MOST);
    assert_true(m->n == MOST && m->displacement[100] == values[100]);
    lac_motion_free(m);
}

// Falls one after the other are the slope's, not the sensor's.
static void a_slope_that_goes_back_is_no_reset(void **state)
{
    (void)state;
    for (size_t days = 2; days <= 4; days++) {
        fill_noisy(MOST, 1e-3);
        for (size_t k = 1; k <= days; k++) {
            values[MOST - 1 - days + k] = values[MOST - 1 - days] - 1.5 * (double)k;
        }
        lac_motion *m = move((lac_motion_def){0}, MOST);
        assert_true(m->resets == 0 && m->outliers == 0 && m->n == MOST);
        assert_true(m->displacement[MOST - 1] == values[MOST - 1]);
        lac_motion_free(m);
    }
}

// The last reading fell: nobody knows yet why; a rise may be the failure.
static void the_last_reading_is_judged_by_the_past(void **state)
{
    (void)state;
    fill_noisy(100, 1e-3);
    values[99] = 0.0;
    lac_motion *m = move((lac_motion_def){0}, 100);
    assert_int_equal(m->n, 99);
    lac_motion_free(m);
    values[99] = 3.0;
    m = move((lac_motion_def){0}, 100);
    assert_int_equal(m->n, 100);
    lac_motion_free(m);
}

static lac_motion *mirror(lac_motion_def def, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        values[i] = -values[i];
    }
    return move(def, n);
}

// Whatever is done to a slope that rises is done to its mirror image, bit by bit.
static void what_falls_is_turned(void **state)
{
    (void)state;
    const lac_motion_def defs[] = {{0},
                                   {.raw = true},
                                   {.smoothing = LAC_SMOOTH_AVERAGE, .points = 5},
                                   {.smoothing = LAC_SMOOTH_WINDOW, .window = 36000.0},
                                   {.smoothing = LAC_SMOOTH_SAVGOL, .points = 9, .order = 2}};
    for (size_t k = 0; k < sizeof defs / sizeof *defs; k++) {
        fill_noisy(MOST, 1e-3);
        values[100] += 0.5;
        for (size_t i = 300; i < MOST; i++) {
            values[i] -= 2.0;
        }
        lac_motion *up = move(defs[k], MOST);
        lac_motion *down = mirror(defs[k], MOST);
        assert_true(!up->falling && down->falling);
        assert_true(up->n == down->n && up->velocities == down->velocities);
        assert_true(up->resets == down->resets && up->outliers == down->outliers);
        assert_memory_equal(up->displacement, down->displacement, up->n * sizeof(double));
        assert_memory_equal(up->velocity, down->velocity, up->velocities * sizeof(double));
        assert_int_equal(up->resets, k == 1 ? 0 : 1);
        lac_motion_free(up);
        lac_motion_free(down);
    }
}

static void velocities_of_what_falls_are_turned(void **state)
{
    (void)state;
    double rates[20];
    lac_readings readings = {.n = 20, .time = times, .velocity = rates};
    const lac_motion_def def = {0};
    for (int speeds = 0; speeds < 2; speeds++) {
        for (size_t i = 0; i < 20; i++) {
            times[i] = (double)i;
            values[i] = -(double)(i * i);
            rates[i] = (speeds ? 2.0 : -2.0) * (double)i;
        }
        readings.displacement = NULL; // rates that are below 0 alone, then speeds beside a fall
        for (int beside = speeds; beside < 2; beside++) {
            lac_motion *m = NULL;
            readings.displacement = beside ? values : NULL;
            assert_int_equal(lac_motion_create(&def, &readings, &m, NULL), LAC_OK);
            assert_true(m->falling);
            for (size_t i = 0; i < 20; i++) {
                assert_true(m->velocity[i] == 2.0 * (double)i);
                assert_true(m->displacement[i] == (double)(i * i));
            }
            lac_motion_free(m);
        }
    }
}

// Noise that goes nowhere, down by less than three errors of a difference of two readings.
static void standing_still_is_no_fall(void **state)
{
    (void)state;
    for (size_t i = 0; i < MOST; i++) {
        times[i] = 3600.0 * (double)i;
        values[i] = random_normal(i) - (double)i / MOST;
    }
    lac_motion *m = move((lac_motion_def){0}, MOST);
    assert_false(m->falling);
    lac_motion_free(m);
    m = mirror((lac_motion_def){0}, MOST);
    assert_false(m->falling);
    lac_motion_free(m);
}

// A sensor set back by 10 m at every twentieth reading has less than one reset in twenty; at every
// eighteenth, more.
static void too_many_resets_are_not_believed(void **state)
{
    (void)state;
    for (size_t tooth = 8; tooth <= 10; tooth += 2) {
        for (size_t i = 0; i < MOST; i++) {
            times[i] = 3600.0 * (double)i;
            values[i] = 0.01 * (double)i - 10.0 * (double)(i / tooth) + 1e-5 * random_normal(i);
        }
        lac_motion *m = move((lac_motion_def){0}, MOST);
        const bool believed = tooth == 10;
        assert_int_equal(m->resets, believed ? 39 : 0);
        assert_int_equal(m->disbelieved, believed ? 0 : 49);
        assert_int_equal(m->n, MOST);
        for (size_t i = 0; i < MOST; i++) {
            assert_true(fabs(m->displacement[i] - (believed ? 0.01 * (double)i : values[i])) <
                        (believed ? 2e-3 : 1e-300));
        }
        lac_motion_free(m);
    }
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    const lac_motion_def wrong[] = {
        {.smoothing = LAC_SMOOTH_AVERAGE, .points = 1},
        {.smoothing = LAC_SMOOTH_WINDOW, .window = 0.0},
        {.smoothing = LAC_SMOOTH_WINDOW, .window = NAN},
        {.smoothing = LAC_SMOOTH_SAVGOL, .points = 3, .order = 3},
        {.smoothing = LAC_SMOOTH_SAVGOL, .points = 30, .order = 20},
        {.smoothing = LAC_SMOOTH_SAVGOL, .points = 30, .order = 0},
    };
    const lac_readings readings = {.n = 3, .time = times, .displacement = values};
    const lac_readings none = {.n = 3, .time = times};
    const lac_motion_def def = {0};
    lac_motion *m = NULL;
    fill_noisy(3, 0.0);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lac_error err = {""};
        assert_int_equal(lac_motion_create(&wrong[i], &readings, &m, &err), LAC_EINPUT);
        assert_true(m == NULL && err.message[0] != '\0');
    }
    assert_int_equal(lac_motion_create(&def, &none, &m, NULL), LAC_EINPUT);
}

// Against the normal equations' solution of a quadratic through noisy points.
static void least_squares_solve(void **state)
{
    (void)state;
    enum { N = 12 };
    double columns[4 * N], y[N], kept[N], c[4];
    for (size_t i = 0; i < N; i++) {
        const double x = (double)i / N;
        columns[i] = 1.0;
        columns[N + i] = x;
        columns[2 * N + i] = x * x;
        columns[3 * N + i] = 2.0 - 3.0 * x; // depends on the first two
        y[i] = 1.0 - 2.0 * x + 0.5 * x * x + 0.1 * random_normal(i);
        kept[i] = y[i];
    }
    const double sum = lac_least_squares(N, 4, columns, y, c);
    double squares = 0.0;
    double along[3] = {0.0, 0.0, 0.0};
    assert_true(c[3] == 0.0);
    for (size_t i = 0; i < N; i++) {
        const double x = (double)i / N;
        const double r = kept[i] - c[0] - c[1] * x - c[2] * x * x;
        assert_true(fabs(r - y[i]) < 1e-13);
        squares += r * r;
        along[0] += r;
        along[1] += r * x;
        along[2] += r * x * x;
    }
    assert_true(fabs(squares - sum) < 1e-14);
    assert_true(fabs(along[0]) + fabs(along[1]) + fabs(along[2]) < 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(secants_stand_between_readings),
        cmocka_unit_test(polynomials_are_found_again_at_their_end),
        cmocka_unit_test(windows_reach_back),
        cmocka_unit_test(averages_are_of_velocities),
        cmocka_unit_test(velocities_alone_are_integrated),
        cmocka_unit_test(noise_is_measured),
        cmocka_unit_test(resets_are_found_on_steep_curves),
        cmocka_unit_test(outliers_and_resets_are_taken_out),
        cmocka_unit_test(a_slope_that_goes_back_is_no_reset),
        cmocka_unit_test(the_last_reading_is_judged_by_the_past),
        cmocka_unit_test(what_falls_is_turned),
        cmocka_unit_test(velocities_of_what_falls_are_turned),
        cmocka_unit_test(standing_still_is_no_fall),
        cmocka_unit_test(too_many_resets_are_not_believed),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(least_squares_solve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
