// SPDX-License-Identifier: GPL-3.0-or-later
// The benchmark surfaces against their definition, wave by wave.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "support/test.h"
#include "surface/surface.h"

static const double two_pi = 6.283185307179586476925286766559;

static const lac_model_info *benchmark(void)
{
    size_t i = 0;
    while (strcmp(lac_surface_source_get(i)->info.name, "benchmark") != 0) {
        i++;
    }
    return &lac_surface_source_get(i)->info;
}

static lac_grid square(size_t n, double side)
{
    return (lac_grid){n, n, side / (double)n, side / (double)n, true};
}

static const lac_benchmark a08 = {LAC_BENCHMARK_A08, NAN, NAN, INT64_MIN};
static const lac_benchmark j07 = {LAC_BENCHMARK_J07, NAN, NAN, INT64_MIN};

static double *heights(lac_benchmark params, lac_grid grid)
{
    lac_error err = {""};
    double *h = malloc(lac_grid_cells(&grid) * sizeof *h);
    assert_non_null(h);
    lac_model model = {benchmark(), &params};
    if (lac_surface_generate(&model, &grid, h, NULL, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return h;
}

// The definition, one wave at a time: phases from the step of splitmix64 written out.
static double direct(double hurst, double plateau, long most, uint64_t seed, long n, long i, long j)
{
    double sum = 0.0;
    for (long kx = 0; kx <= most; kx++) {
        for (long ky = -most; ky <= most; ky++) {
            long k2 = kx * kx + ky * ky;
            if (k2 > most * most || k2 == 0 || (kx == 0 && ky < 0)) {
                continue;
            }
            uint64_t z = seed * 11400714819323198485U + ((uint64_t)(kx + 1048576) << 32) +
                         (uint64_t)(ky + 1048576) + 11400714819323198485U;
            z = (z ^ (z >> 30)) * 13787848793156543929U;
            z = (z ^ (z >> 27)) * 10723151780598845931U;
            z = z ^ (z >> 31);
            double u = (double)(z >> 11) / 9007199254740992.0;
            double c = pow(fmax(sqrt((double)k2) / plateau, 1.0), -2.0 * (hurst + 1.0));
            sum += sqrt(c) * cos(two_pi * ((double)((kx * i + ky * j) % n) / (double)n + u));
        }
    }
    return sum;
}

static void heights_are_the_sum_of_the_waves(void **state)
{
    (void)state;
    double *h = heights(a08, square(32, 1.0));
    double scale = h[0] / direct(0.8, 4.0, 4, 1, 32, 0, 0);
    assert_true(scale > 0.0);
    for (long i = 0; i < 32; i++) {
        for (long j = 0; j < 32; j++) {
            double expected = scale * direct(0.8, 4.0, 4, 1, 32, i, j);
            assert_true(fabs(h[i * 32 + j] - expected) < 1e-15);
        }
    }
    free(h);
    if (test_few()) {
        return;
    }
    h = heights(j07, square(1024, 1.0));
    scale = h[0] / direct(0.7, 1.0, 511, 2, 1024, 0, 0);
    const long nodes[][2] = {{0, 1}, {1, 0}, {17, 900}, {1023, 511}};
    for (size_t k = 0; k < 4; k++) {
        long i = nodes[k][0];
        long j = nodes[k][1];
        double expected = scale * direct(0.7, 1.0, 511, 2, 1024, i, j);
        assert_true(fabs(h[i * 1024 + j] - expected) < 1e-13);
    }
    free(h);
}

static double rms(const double *h, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += h[i] * h[i];
    }
    return sqrt(sum / (double)n);
}

static void scales_are_as_stated(void **state)
{
    (void)state;
    const size_t n = 65536;
    double *h = heights(a08, square(256, 1.0));
    assert_true(fabs(rms(h, n) - 2.22699e-3) < 5e-9);
    free(h);
    h = heights(a08, square(256, 5.0)); // heights go with the side
    assert_true(fabs(rms(h, n) - 5.0 * 2.22699e-3) < 3e-8);
    free(h);
    lac_benchmark steep = a08;
    steep.rms_slope = 0.3;
    h = heights(steep, square(256, 1.0));
    assert_true(fabs(rms(h, n) - 3.0 * 2.22699e-3) < 2e-8);
    free(h);
    lac_benchmark high = a08;
    high.height_ratio = 0.02;
    h = heights(high, square(256, 5.0));
    assert_true(fabs(rms(h, n) - 0.1) < 1e-12);
    free(h);
    if (test_few()) {
        return;
    }
    h = heights(j07, square(1024, 1.0));
    assert_true(fabs(rms(h, 1048576) - 0.01) < 1e-14);
    free(h);
}

// Coarser: every m-th node. Finer: the same interface between the nodes.
static void joint_like_surface_is_sampled(void **state)
{
    (void)state;
    if (test_few()) {
        skip();
    }
    double *h = heights(j07, square(1024, 1.0));
    const size_t sides[] = {64, 128, 256, 512, 2048};
    for (size_t k = 0; k < 5; k++) {
        size_t n = sides[k];
        double *other = heights(j07, square(n, 1.0));
        size_t common = n < 1024 ? n : 1024;
        for (size_t c = 0; c < common * common; c++) {
            size_t i = c / common;
            size_t j = c % common;
            double there = h[i * (1024 / common) * 1024 + j * (1024 / common)];
            double here = other[i * (n / common) * n + j * (n / common)];
            assert_true(fabs(here - there) < 1e-15);
        }
        free(other);
    }
    free(h);
}

static void seeds_are_those_of_the_definition(void **state)
{
    (void)state;
    lac_benchmark given = a08;
    given.seed = 1;
    double *one = heights(a08, square(64, 1.0));
    double *same = heights(given, square(64, 1.0));
    assert_memory_equal(one, same, 4096 * sizeof *one);
    given.seed = 2;
    double *other = heights(given, square(64, 1.0));
    assert_memory_not_equal(one, other, 4096 * sizeof *one);
    free(one);
    free(same);
    free(other);
}

static void refuse(lac_benchmark params, lac_grid grid, const char *word)
{
    lac_error err = {""};
    double h[64 * 64];
    lac_model model = {benchmark(), &params};
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, &err), LAC_EINPUT);
    if (strstr(err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", err.message, word);
    }
}

static void what_is_not_defined_is_refused(void **state)
{
    (void)state;
    refuse((lac_benchmark){0, 0.1, 0.01, 1}, square(64, 1.0), "not both");
    refuse(a08, square(20, 1.0), "multiple of 8");
    refuse(j07, (lac_grid){1, 1, 1.0, 1.0, true}, "multiple of 8");
    refuse(a08, (lac_grid){64, 32, 1.0, 1.0, true}, "square");
    refuse(j07, (lac_grid){64, 64, 1.0, 0.5, true}, "square");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_the_sum_of_the_waves),
        cmocka_unit_test(scales_are_as_stated),
        cmocka_unit_test(joint_like_surface_is_sampled),
        cmocka_unit_test(seeds_are_those_of_the_definition),
        cmocka_unit_test(what_is_not_defined_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
