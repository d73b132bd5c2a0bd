// SPDX-License-Identifier: GPL-3.0-or-later
// What the options of `self-affine` promise, and that without them nothing changes.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <omp.h>

#include "base/fft.h"
#include "support/test.h"
#include "surface/surface.h"

static const double side = 64.0;
static const double two_pi = 6.283185307179586476925286766559;

static const lac_self_affine usual = {
    .hurst = 0.7,
    .rms_height = 0.3,
    .rms_slope = NAN,
    .rolloff = 16.0,
    .shortest = 2.0,
    .seed = 5,
    .anisotropy = 1.0,
};

static const lac_model_info *info(void)
{
    size_t i = 0;
    while (strcmp(lac_surface_source_get(i)->info.name, "self-affine") != 0) {
        i++;
    }
    return &lac_surface_source_get(i)->info;
}

static lac_grid square(size_t n)
{
    return (lac_grid){n, n, side / (double)n, side / (double)n, true};
}

static double *heights(lac_self_affine params, lac_grid grid)
{
    lac_error err = {""};
    double *h = malloc(lac_grid_cells(&grid) * sizeof *h);
    assert_non_null(h);
    lac_model model = {info(), &params};
    if (lac_surface_generate(&model, &grid, h, NULL, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return h;
}

static void refuse(lac_self_affine params, lac_grid grid, const char *word)
{
    lac_error err = {""};
    double h[64 * 64];
    lac_model model = {info(), &params};
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, &err), LAC_EINPUT);
    if (strstr(err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", err.message, word);
    }
}

// FNV-1a of the heights in millionths of the rms: libraries may differ in the last bits.
static uint64_t checksum(const double *h, size_t n, double rms)
{
    uint64_t sum = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < n; i++) {
        uint64_t v = (uint64_t)llround(h[i] / rms * 1e6);
        for (int byte = 0; byte < 8; byte++) {
            sum = (sum ^ (v >> (8 * byte) & 0xFF)) * UINT64_C(1099511628211);
        }
    }
    return sum;
}

// The sums are those of the first version, which had none of the options.
static void without_options_nothing_changes(void **state)
{
    (void)state;
    double *h = heights(usual, square(128));
    assert_int_equal(checksum(h, 16384, 0.3), UINT64_C(0x46FD0931E6F6DD50));
    free(h);
    h = heights(usual, (lac_grid){100, 36, 0.64, 1.0, true});
    assert_int_equal(checksum(h, 3600, 0.3), UINT64_C(0xF5DF79BE28718777));
    free(h);
    lac_self_affine wide = usual; // so wide that part of the band is integrated
    wide.shortest = 0.01;
    wide.rolloff = NAN;
    h = heights(wide, square(64));
    assert_int_equal(checksum(h, 4096, 0.3), UINT64_C(0x0E993FB19391C5B3));
    free(h);
}

static void every_option_alone(lac_self_affine all[4])
{
    for (size_t i = 0; i < 4; i++) {
        all[i] = usual;
    }
    all[0].rms_height = NAN;
    all[0].rms_slope = 0.2;
    all[1].anisotropy = 3.0;
    all[1].direction = 0.6;
    all[2].skewness = 1.0;
    all[3] = all[1];
    all[3].rms_height = NAN;
    all[3].rms_slope = 0.2;
    all[3].skewness = -0.8;
}

static void same_bytes_for_any_threads(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    lac_self_affine all[4];
    every_option_alone(all);
    for (size_t k = 0; k < 4; k++) {
        omp_set_num_threads(1);
        double *one = heights(all[k], square(256));
        omp_set_num_threads(4);
        double *four = heights(all[k], square(256));
        assert_memory_equal(one, four, 65536 * sizeof *one);
        free(one);
        free(four);
    }
    omp_set_num_threads(threads);
}

// Grids that resolve the band share the heights at their common nodes; skewed ones up to a
// constant, for each has zero mean over its own nodes.
static void same_interface_at_every_resolution(void **state)
{
    (void)state;
    lac_self_affine all[4];
    every_option_alone(all);
    for (size_t k = 0; k < 4; k++) {
        double *coarse = heights(all[k], square(96));
        double *fine = heights(all[k], square(288));
        double shift = coarse[0] - fine[0];
        assert_true(all[k].skewness != 0.0 ? fabs(shift) < 1e-2 : fabs(shift) < 1e-12);
        for (size_t c = 0; c < 96 * 96; c++) {
            double there = fine[c / 96 * 3 * 288 + c % 96 * 3];
            assert_true(fabs(coarse[c] - there - shift) < 1e-12);
        }
        free(coarse);
        free(fine);
    }
}

static lac_fft *spectrum(const double *h, size_t n)
{
    lac_fft *fft = NULL;
    assert_int_equal(lac_fft_create(n, n, &fft, NULL), LAC_OK);
    memcpy(fft->real, h, n * n * sizeof *h);
    lac_fft_forward(fft);
    for (size_t k = 0; k < fft->nkx * n; k++) {
        fft->spectrum[k] /= (double)(n * n);
    }
    return fft;
}

// Mean square of the gradient along (x, y), of the waves themselves.
static double square_slope(const double *h, size_t n, double x, double y)
{
    lac_fft *fft = spectrum(h, n);
    double sum = 0.0;
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < fft->nkx; i++) {
            double k = (double)i * x + lac_fft_frequency(j, n) * y;
            double a = cabs(fft->spectrum[j * fft->nkx + i]) * k * two_pi / side;
            sum += (i == 0 || 2 * i == n ? 1.0 : 2.0) * a * a;
        }
    }
    lac_fft_free(fft);
    return sum;
}

static void rms_slope_is_as_stated(void **state)
{
    (void)state;
    const int64_t seeds = (int64_t)test_some(40);
    const struct {
        double skewness, anisotropy;
    } kinds[] = {{0.0, 1.0}, {1.0, 1.0}, {0.0, 2.5}};
    for (size_t k = 0; k < 3; k++) {
        double sum = 0.0;
        for (int64_t seed = 1; seed <= seeds; seed++) {
            lac_self_affine p = usual;
            p.rms_height = NAN;
            p.rms_slope = 0.2;
            p.seed = seed;
            p.skewness = kinds[k].skewness;
            p.anisotropy = kinds[k].anisotropy;
            p.direction = 0.4;
            double *h = heights(p, square(192));
            sum += square_slope(h, 192, 1.0, 0.0) + square_slope(h, 192, 0.0, 1.0);
            free(h);
        }
        double ratio = sqrt(sum / (double)seeds) / 0.2;
        print_message("skewness %g, anisotropy %g: rms slope / stated %.4f\n", kinds[k].skewness,
                      kinds[k].anisotropy, ratio);
        assert_true(fabs(ratio - 1.0) < 0.02);
    }
}

// Sum of C |q|^2 over that of C, wave by wave, against the source's, part of which is integrated:
// the same amplitudes, scaled by the rms height or by the rms slope.
static void slopes_of_waves_far_below_the_grid_count(void **state)
{
    (void)state;
    lac_self_affine p = usual;
    p.anisotropy = 2.0;
    p.direction = 0.6;
    p.hurst = 0.5;
    p.rolloff = NAN;
    p.shortest = side / 500.0;
    double *by_height = heights(p, square(32));
    p.rms_height = NAN;
    p.rms_slope = 1.0;
    double *by_slope = heights(p, square(32));
    double c0 = 0.0;
    double c2 = 0.0;
    for (int ky = -500; ky <= 500; ky++) {
        for (int kx = ky > 0 ? 0 : 1; // half plane: every wave once
             kx <= 500; kx++) {
            double x = kx;
            double y = ky;
            double k = hypot(2.0 * (x * cos(0.6) + y * sin(0.6)), y * cos(0.6) - x * sin(0.6));
            if (k <= 500.0) {
                double c = pow(fmax(k, 1.0), -3.0);
                c0 += c;
                c2 += c * (x * x + y * y);
            }
        }
    }
    double expected = sqrt(c0 / c2) * side / two_pi / 0.3;
    assert_true(fabs(by_slope[7] / by_height[7] / expected - 1.0) < 1e-4);
    free(by_height);
    free(by_slope);
}

// Gradients along and across the direction stand as 1 to the anisotropy.
static void anisotropy_is_as_stated(void **state)
{
    (void)state;
    const int64_t seeds = (int64_t)test_some(40); // of a tenth of them the spread is larger
    const double within = 0.12 * sqrt(40.0 / (double)seeds);
    const double directions[] = {0.0, 0.6, 1.5707963267948966, -2.0};
    for (size_t k = 0; k < 4; k++) {
        double c = cos(directions[k]);
        double s = sin(directions[k]);
        double along = 0.0;
        double across = 0.0;
        for (int64_t seed = 1; seed <= seeds; seed++) {
            lac_self_affine p = usual;
            p.seed = seed;
            p.anisotropy = 3.0;
            p.direction = directions[k];
            double *h = heights(p, square(96));
            along += square_slope(h, 96, c, s);
            across += square_slope(h, 96, -s, c);
            free(h);
        }
        double ratio = sqrt(across / along);
        print_message("direction %.2f: across / along %.3f (3)\n", directions[k], ratio);
        assert_true(fabs(ratio - 3.0) < within);
    }
}

typedef struct moments {
    double m2, m3, m4;
} moments;

// Over the band, and the variance beyond it.
enum { SHELLS = 8 };
typedef struct power {
    double in[SHELLS], beyond;
} power;

static void add(const double *h, size_t n, moments *m, power *pw)
{
    for (size_t i = 0; i < n * n; i++) {
        double h2 = h[i] * h[i];
        m->m2 += h2;
        m->m3 += h2 * h[i];
        m->m4 += h2 * h2;
    }
    lac_fft *fft = spectrum(h, n);
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < fft->nkx; i++) {
            double k = hypot((double)i, lac_fft_frequency(j, n));
            double a = cabs(fft->spectrum[j * fft->nkx + i]);
            double both = i == 0 || 2 * i == n ? 1.0 : 2.0;
            if (k > 32.0) {
                pw->beyond += both * a * a;
            } else if (k > 0.0) {
                pw->in[(size_t)(1.5 * log2(k))] += both * a * a;
            }
        }
    }
    lac_fft_free(fft);
}

static void skewness_is_as_stated(void **state)
{
    (void)state;
    enum { N = 128 };
    const double seeds = (double)test_some(100);
    const double wide = sqrt(100.0 / seeds), cells = seeds * (double)(N * N);
    const double skewnesses[] = {1.0, -1.0};
    for (size_t k = 0; k < test_some(2); k++) {
        moments gauss = {0.0, 0.0, 0.0};
        moments skewed = gauss;
        power before = {{0.0}, 0.0};
        power after = before;
        for (int64_t seed = 1; seed <= (int64_t)seeds; seed++) {
            lac_self_affine p = usual;
            p.rolloff = 8.0; // many waves of the longest kind: samples near the ensemble
            p.seed = seed;
            double *h = heights(p, square(N));
            add(h, N, &gauss, &before);
            free(h);
            p.skewness = skewnesses[k];
            h = heights(p, square(N));
            add(h, N, &skewed, &after);
            free(h);
        }
        double variance = skewed.m2 / cells;
        double skewness = skewed.m3 / cells / pow(variance, 1.5);
        double kurtosis = skewed.m4 / cells / (variance * variance);
        print_message("skewness %.3f (%g), kurtosis %.3f (4.83), rms %.4f (0.3), beyond %.4f\n",
                      skewness, skewnesses[k], kurtosis, sqrt(variance),
                      after.beyond / seeds / variance);
        assert_true(fabs(skewness - skewnesses[k]) < 0.06 * wide);
        assert_true(fabs(kurtosis - 4.83) < 0.25 * wide);
        assert_true(fabs(sqrt(variance) / 0.3 - 1.0) < 0.01 * wide);
        for (size_t s = 0; s < SHELLS - 1; s++) {
            if (before.in[s] > 0.0) {
                print_message("  shell %zu: %.3f\n", s, after.in[s] / before.in[s]);
                assert_true(fabs(after.in[s] / before.in[s] - 1.0) < 0.1 * wide);
            }
        }
        assert_true(after.beyond / seeds < 0.005 * variance);
    }
}

// The transform is monotone: high stays high.
static void skewness_keeps_the_order(void **state)
{
    (void)state;
    lac_self_affine p = usual;
    double *gauss = heights(p, square(64));
    const double skewnesses[] = {2.0, -2.0, 1e-300};
    for (size_t k = 0; k < 3; k++) {
        p.skewness = skewnesses[k];
        double *h = heights(p, square(64));
        for (size_t i = 1; i < 4096; i++) {
            assert_true((gauss[i] > gauss[i - 1]) == (h[i] > h[i - 1]));
        }
        assert_true(k < 2 || fabs(h[9] - gauss[9]) < 1e-12);
        free(h);
    }
    free(gauss);
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    lac_self_affine p = usual;
    p.rms_slope = 0.1;
    refuse(p, square(64), "not both");
    p.rms_height = NAN;
    p.rms_slope = NAN;
    refuse(p, square(64), "rms_slope");
    p = usual;
    p.anisotropy = 40.0; // along a line no wave is left
    refuse(p, (lac_grid){64, 1, 1.0, 1.0, true}, "anisotropy");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_options_nothing_changes),
        cmocka_unit_test(same_bytes_for_any_threads),
        cmocka_unit_test(same_interface_at_every_resolution),
        cmocka_unit_test(rms_slope_is_as_stated),
        cmocka_unit_test(slopes_of_waves_far_below_the_grid_count),
        cmocka_unit_test(anisotropy_is_as_stated),
        cmocka_unit_test(skewness_is_as_stated),
        cmocka_unit_test(skewness_keeps_the_order),
        cmocka_unit_test(wrong_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
