// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of surfaces whose measures are known.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "support/height_files.h"
#include "support/test.h"
#include "surface/surface.h"

enum { N = 256, SEEDS = 60 };
static const double two_pi = 6.283185307179586476925286766559;
static double h[N * N];

// On n x n cells; a free surface is a corner of one twice as long.
static void synthesise(double hurst, int64_t seed, lac_grid grid)
{
    lac_self_affine p = {.hurst = hurst,
                         .rms_height = 0.3,
                         .rms_slope = NAN,
                         .rolloff = NAN,
                         .shortest = NAN,
                         .seed = seed,
                         .anisotropy = 1.0};
    lac_model model = {&surface_source("self-affine")->info, &p};
    const size_t nx = grid.nx, ny = grid.ny;
    grid.nx *= grid.periodic ? 1 : 2;
    grid.ny *= grid.periodic ? 1 : 2;
    grid.periodic = true;
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, NULL), LAC_OK);
    for (size_t j = 1; j < ny; j++) {
        memmove(h + j * nx, h + j * grid.nx, nx * sizeof *h);
    }
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

// The stated error holds for periodic and for free surfaces, small ones too.
static void hurst_is_found_within_its_error(void **state)
{
    (void)state;
    const double hursts[] = {0.3, 0.7, 0.95};
    for (size_t k = 0; k < 12; k++) {
        size_t n = k < 6 ? 64 : 128;
        lac_grid grid = {n, n, 0.5, 0.5, k % 2 == 0};
        double hurst = hursts[k / 2 % 3];
        int within = 0;
        int within_two = 0;
        double sum = 0.0;
        double error = 0.0;
        for (int64_t seed = 1; seed <= SEEDS; seed++) {
            synthesise(hurst, seed, grid);
            lac_surface_measures m = measure(grid, NULL);
            within += fabs(m.hurst - hurst) < m.hurst_error;
            within_two += fabs(m.hurst - hurst) < 2.0 * m.hurst_error;
            sum += m.hurst / SEEDS;
            error += m.hurst_error / SEEDS;
        }
        print_message("%zu, %s, H %g: %.4f, error %.4f; %d and %d of %d within one and two\n", n,
                      grid.periodic ? "periodic" : "free", hurst, sum, error, within, within_two,
                      SEEDS);
        assert_true(10 * within > 6 * SEEDS);
        assert_true(10 * within_two >= 9 * SEEDS);
        assert_true(fabs(sum - hurst) < 0.4 * error);
        assert_true(error < (n == 64 ? 0.16 : 0.06));
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

// Slopes at the usual steps, in closed form, and what is made of them.
static void profiles_at_the_usual_steps(void **state)
{
    (void)state;
    for (size_t i = 0; i < N * N; i++) {
        h[i] = 1e-3 * sin(two_pi * 6.0 * (double)(i % N) / N);
    }
    lac_surface_measures m = measure((lac_grid){N, N, 0.13e-3, 0.13e-3, true}, NULL);
    assert_int_equal(m.profiles, 3);
    const double lags[] = {2.0, 4.0, 8.0};
    for (size_t k = 0; k < 3; k++) {
        const lac_profile_measure *p = &m.profile[k];
        double z2 = sqrt(2.0) * 1e-3 * sin(two_pi * 3.0 * lags[k] / N) / (lags[k] * 0.13e-3);
        assert_true(fabs(p->step - lags[k] * 0.13e-3) < 1e-12);
        assert_true(fabs(p->z2 - z2) < 1e-12);
        assert_true(fabs(p->jrc - (32.2 + 32.47 * log(z2) / log(10.0))) < 1e-9);
        assert_true(k == 0 ? fabs(p->jrc_yu - (60.32 * z2 - 4.51)) < 1e-9 : isnan(p->jrc_yu));
    }
    // a step that no whole number of cells makes is left out, and one as long as the profile
    m = measure((lac_grid){N, N, 0.35e-3, 0.35e-3, true}, NULL);
    assert_int_equal(m.profiles, 1);
    assert_true(fabs(m.profile[0].step - 1.05e-3) < 1e-12);
    assert_int_equal(measure((lac_grid){2, 2, 0.5e-3, 0.5e-3, false}, NULL).profiles, 1);
    // where the ends do not meet, the last cells have no partner: a parabola, its plane taken off
    double sum = 0.0;
    for (size_t i = 0; i < N; i++) {
        h[i] = 1e-9 * (double)(i * i);
    }
    for (size_t i = 0; i + 2 < N; i++) {
        double d = 1e-9 * (4.0 * (double)i + 4.0 - 2.0 * (N - 1.0));
        sum += d * d;
    }
    m = measure((lac_grid){N, 1, 0.5e-3, 1.0, false}, NULL);
    assert_int_equal(m.profiles, 2);
    assert_true(fabs(m.profile[1].z2 - sqrt(sum / (N - 2)) / 1e-3) < 1e-9 * m.profile[1].z2);
}

// A synthesised surface is fitted where it is a power law, whatever the default range.
static void known_bands_are_fitted(void **state)
{
    (void)state;
    lac_self_affine p = {.hurst = 0.8,
                         .rms_height = 0.3,
                         .rms_slope = NAN,
                         .rolloff = 16.0,
                         .shortest = 3.0,
                         .seed = 1,
                         .anisotropy = 1.0};
    lac_grid grid = {N, N, 0.5, 0.5, true};
    lac_model model = {&surface_source("self-affine")->info, &p};
    lac_surface_stats r;
    assert_int_equal(lac_surface_generate(&model, &grid, h, &r, NULL), LAC_OK);
    assert_true(r.measured == LAC_MEASURED_INTERFACE && r.files == 0);
    assert_true(r.measures.fit_longest == 16.0 && r.measures.fit_shortest == 3.0);
    assert_true(fabs(r.measures.hurst - 0.8) < 3.0 * r.measures.hurst_error);
    assert_true(r.measures.hurst_misfit < 3.0);
    // with the flat part of the spectrum and what is beyond it there is no one power law
    lac_surface_measures m = measure(grid, NULL);
    assert_true(m.hurst_misfit > 10.0);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hurst_is_found_within_its_error),
        cmocka_unit_test(slopes_and_jrc_of_waves),
        cmocka_unit_test(profiles_at_the_usual_steps),
        cmocka_unit_test(known_bands_are_fitted),
        cmocka_unit_test(a_plane_is_flat_where_it_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
