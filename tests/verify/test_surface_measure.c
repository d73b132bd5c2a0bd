// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of surfaces whose measures are known.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>

#include "lacuna/surface.h"

enum { N = 256, SEEDS = 60 };
static const double two_pi = 6.283185307179586476925286766559;
static double h[N * N];

static void synthesise(double hurst, int64_t seed)
{
    lac_self_affine p = {.hurst = hurst,
                         .rms_height = 0.3,
                         .rms_slope = NAN,
                         .rolloff = NAN,
                         .shortest = NAN,
                         .seed = seed,
                         .anisotropy = 1.0};
    lac_grid grid = {N, N, 0.5, 0.5, true};
    lac_slot slot = {&lac_surface_source_at(0)->about, &p};
    assert_int_equal(lac_surface_generate(&slot, &grid, h, NULL), LAC_OK);
}

static lac_surface_measures measure(lac_grid grid, const lac_wave_range *range)
{
    lac_error err = {""};
    lac_surface_measures m;
    if (lac_surface_measure(&grid, h, range, &m, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return m;
}

// Periodic, and the middle half of it as a measured patch.
static void hurst_is_found_within_its_error(void **state)
{
    (void)state;
    const double hursts[] = {0.5, 0.8};
    for (size_t k = 0; k < 4; k++) {
        bool patch = k >= 2;
        int within = 0;
        int within_two = 0;
        double sum = 0.0;
        double error = 0.0;
        for (int64_t seed = 1; seed <= SEEDS; seed++) {
            synthesise(hursts[k % 2], seed);
            for (size_t i = 0; patch && i < N / 2 * N / 2; i++) {
                h[i] = h[(i / (N / 2)) * N + i % (N / 2)];
            }
            size_t n = patch ? N / 2 : N;
            lac_surface_measures m = measure((lac_grid){n, n, 0.5, 0.5, !patch}, NULL);
            within += fabs(m.hurst - hursts[k % 2]) < m.hurst_error;
            within_two += fabs(m.hurst - hursts[k % 2]) < 2.0 * m.hurst_error;
            sum += m.hurst / SEEDS;
            error += m.hurst_error / SEEDS;
        }
        print_message("%s H %g: %.4f, error %.4f; %d and %d of %d within one and two\n",
                      patch ? "patch" : "periodic", hursts[k % 2], sum, error, within, within_two,
                      SEEDS);
        assert_true(10 * within > 5 * SEEDS);
        assert_true(10 * within_two > 8 * SEEDS);
        assert_true(error < 0.1);
    }
}

// Sine waves: rms heights and the slopes of their chords in closed form.
static void slopes_and_jrc_of_waves(void **state)
{
    (void)state;
    for (size_t i = 0; i < N * N; i++) {
        h[i] = 3.0 + 0.2 * sin(two_pi * 8.0 * (double)(i % N) / N) +
               0.1 * cos(two_pi * 4.0 * (double)(i / N) / N);
    }
    lac_surface_measures m = measure((lac_grid){N, N, 0.5, 0.25, true}, NULL);
    double z2 = 0.2 * sqrt(2.0) * sin(two_pi * 4.0 / N) / 0.5;
    assert_true(fabs(m.rms_height - sqrt(0.025)) < 1e-12);
    assert_true(fabs(m.rms_slope_x - z2) < 1e-12);
    assert_true(fabs(m.rms_slope_y - 0.1 * sqrt(2.0) * sin(two_pi * 2.0 / N) / 0.25) < 1e-12);
    assert_true(m.z2 == m.rms_slope_x && m.z2_step == 0.5);
    assert_true(fabs(m.jrc - (32.2 + 32.47 * log(z2) / log(10.0))) < 1e-9);
}

static void a_plane_is_flat_where_it_ends(void **state)
{
    (void)state;
    for (size_t i = 0; i < N * N; i++) {
        h[i] = 2.0 + 0.1 * (double)(i % N) - 0.3 * (double)(i / N);
    }
    lac_surface_measures m = measure((lac_grid){N, N, 0.5, 0.5, false}, NULL);
    assert_true(m.rms_height < 1e-12 && m.z2 < 1e-12);
    memset(h, 0, sizeof h);
    m = measure((lac_grid){N, N, 0.5, 0.5, false}, NULL);
    assert_true(m.rms_height == 0.0 && isnan(m.jrc) && isnan(m.hurst));
    m = measure((lac_grid){1, 1, 0.5, 0.5, false}, NULL);
    assert_true(isnan(m.hurst) && m.rms_slope_x == 0.0);
}

static void what_is_no_surface_is_refused(void **state)
{
    (void)state;
    lac_surface_measures m;
    lac_error err = {""};
    lac_grid grid = {N, N, 0.5, 0.5, true};
    lac_wave_range empty = {1.0, 2.0};
    synthesise(0.5, 1);
    assert_int_equal(lac_surface_measure(&grid, h, &empty, &m, &err), LAC_EINPUT);
    h[300] = NAN;
    assert_int_equal(lac_surface_measure(&grid, h, NULL, &m, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "(44, 1)"));
    assert_int_equal(lac_surface_measure(&(lac_grid){0}, h, NULL, &m, &err), LAC_EINPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hurst_is_found_within_its_error),
        cmocka_unit_test(slopes_and_jrc_of_waves),
        cmocka_unit_test(a_plane_is_flat_where_it_ends),
        cmocka_unit_test(what_is_no_surface_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
