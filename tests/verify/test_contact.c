// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "contact/contact.h"
#include "support/benchmark_surface.h"
#include "support/npy.h"
#include "support/test.h"

static const double pi = 3.14159265358979323846;

// A problem on the unit square with E* = 1 and its solution.
typedef struct fixture {
    size_t n;
    double *h, *p, *gap;
    lac_contact_def def;
    lac_contact_stats report;
} fixture;

static fixture make(size_t n, double mean_pressure)
{
    fixture f = {.n = n, .def = lac_contact_default()};
    f.h = calloc(3 * n * n, sizeof(double));
    assert_non_null(f.h);
    f.p = f.h + n * n;
    f.gap = f.p + n * n;
    f.def.grid = (lac_grid){n, n, 1.0 / (double)n, 1.0 / (double)n, true};
    f.def.heights = f.h;
    f.def.e_star = 1.0;
    f.def.mean_pressure = mean_pressure;
    return f;
}

static void solve(fixture *f)
{
    lac_error err = {""};
    if (lac_contact_solve(&f->def, f->p, f->gap, &f->report, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
}

// h = D cos 2 pi x pressed with a fraction of p* = pi E* D / L
static fixture westergaard(size_t n, double fraction)
{
    const double amplitude = 0.01;
    fixture f = make(n, fraction * pi * amplitude);
    for (size_t i = 0; i < n * n; i++) {
        f.h[i] = amplitude * cos(2.0 * pi * (double)(i % n) / (double)n);
    }
    solve(&f);
    return f;
}

// p = 2 p_mean cos(psi) / s^2 sqrt(s^2 - sin^2(psi)), psi = pi x, s^2 = p_mean / p*
static double westergaard_pressure(double x, double fraction, double mean)
{
    double s2 = sin(pi * x) * sin(pi * x);
    double c = fabs(cos(pi * x));
    return s2 < fraction ? 2.0 * mean * c / fraction * sqrt(fraction - s2) : 0.0;
}

// rms difference from the exact pressure over its rms
static double westergaard_error(const fixture *f, double fraction)
{
    double difference = 0.0;
    double size = 0.0;
    for (size_t i = 0; i < f->n * f->n; i++) {
        double x = (double)(i % f->n) / (double)f->n;
        double exact = westergaard_pressure(x, fraction, f->def.mean_pressure);
        difference += (f->p[i] - exact) * (f->p[i] - exact);
        size += exact * exact;
    }
    return sqrt(difference / size);
}

// The edge of the contact falls anywhere between two nodes, so that errors do not fall step by
// step: it is their bound that does, with the width of a cell.
static void sinusoid_partial_at(size_t n, double fraction, double exact_area)
{
    fixture f = westergaard(n, fraction);
    double area = (double)f.report.n_cells / (double)(n * n);
    double error = westergaard_error(&f, fraction);
    double peak = f.report.max_pressure * sqrt(fraction) / (2.0 * f.def.mean_pressure);
    print_message("p/p* %.2f, %3zu^2: area %.5f (%.5f), pressure: rms error %.2e, peak %+.2e; "
                  "%lld iterations\n",
                  fraction, n, area, exact_area, error, peak - 1.0, (long long)f.report.iterations);
    assert_true(fabs(area - exact_area) < 1.5 / (double)n);
    assert_true(error < 2.3 / (double)n);
    if (n == 256) {
        assert_true(fabs(area / exact_area - 1.0) < 0.01);
        assert_true(fabs(peak - 1.0) < 0.01);
    }
    free(f.h);
}

static void sinusoid_partial(void **state)
{
    (void)state;
    for (size_t n = 32; n <= 256; n *= 2) {
        sinusoid_partial_at(n, 0.05, 0.14357);
        sinusoid_partial_at(n, 0.5, 0.5);
        sinusoid_partial_at(n, 0.9, 0.79517);
    }
}

static void sinusoid_full(void **state)
{
    (void)state;
    const double loads[] = {1.0000001, 1.5, 1e6};
    for (size_t k = 0; k < 3; k++) {
        fixture f = westergaard(256, loads[k]);
        assert_int_equal(f.report.n_cells, 256 * 256);
        assert_int_equal(f.report.iterations, 0);
        for (size_t i = 0; i < 256 * 256; i++) {
            double x = (double)(i % 256) / 256.0;
            double exact = f.def.mean_pressure + 0.01 * pi * cos(2.0 * pi * x);
            assert_true(fabs(f.p[i] - exact) < 1e-12 * f.def.mean_pressure);
            assert_true(f.gap[i] == 0.0);
        }
        free(f.h);
    }
}

// Squared distance of a node from the middle of the square
static double distance2(size_t n, size_t i)
{
    double x = (double)(i % n) / (double)n - 0.5;
    double y = (double)(i / n) / (double)n - 0.5;
    return x * x + y * y;
}

// rms difference from Hertz's pressure over its rms
static double hertz_error(const fixture *f, double a)
{
    double difference = 0.0;
    double size = 0.0;
    for (size_t i = 0; i < f->n * f->n; i++) {
        double inside = fmax(0.0, 1.0 - distance2(f->n, i) / (a * a));
        double exact = 2.0 * a / pi * sqrt(inside);
        difference += (f->p[i] - exact) * (f->p[i] - exact);
        size += exact * exact;
    }
    return sqrt(difference / size);
}

// A sphere of radius 1 among its periodic images at distance 1, which add 1.28e-3 to the peak.
static void sphere_at(size_t n, double a)
{
    fixture f = make(n, 4.0 / 3.0 * a * a * a);
    for (size_t i = 0; i < n * n; i++) {
        f.h[i] = -0.5 * distance2(n, i);
    }
    solve(&f);
    double cell = 1.0 / (double)n;
    double peak = f.report.max_pressure / (2.0 * a / pi * (1.0 + 1.28e-3)) - 1.0;
    double radius = sqrt((double)f.report.n_cells / pi) * cell / a - 1.0;
    double error = hertz_error(&f, a);
    print_message("a/L %.1f, %3zu^2: peak %+.2e, radius %+.2e, pressure rms error %.2e; %lld "
                  "iterations\n",
                  a, n, peak, radius, error, (long long)f.report.iterations);
    assert_true(fabs(peak) < 8.0 * cell * cell);
    assert_true(fabs(radius) < 2.5 * cell); // below 1 % at 256
    assert_true(error < 2.5 * cell);
    free(f.h);
}

static void sphere(void **state)
{
    (void)state;
    for (size_t n = 32; n <= 256; n *= 2) {
        sphere_at(n, 0.1);
    }
}

// A sphere of radius 1 on a free half-space: Hertz, nothing to be counted in.
static void free_sphere(void **state)
{
    (void)state;
    const double a = 0.2;
    for (size_t n = 32; n <= 256; n *= 2) {
        fixture f = make(n, 4.0 / 3.0 * a * a * a);
        f.def.grid.periodic = false;
        double mean = 0.0;
        for (size_t i = 0; i < n * n; i++) {
            f.h[i] = -0.5 * distance2(n, i);
            mean += f.h[i] / (double)(n * n);
        }
        solve(&f);
        double cell = 1.0 / (double)n;
        double peak = f.report.max_pressure / (2.0 * a / pi) - 1.0;
        double depth = -(f.report.approach + mean) / (a * a) - 1.0;
        double error = hertz_error(&f, a);
        print_message("free, a/L %.1f, %3zu^2: peak %+.2e, depth %+.2e, pressure rms error %.2e; "
                      "%lld iterations\n",
                      a, n, peak, depth, error, (long long)f.report.iterations);
        assert_true(fabs(peak) < 3.0 * cell * cell);
        assert_true(fabs(depth) < 3.0 * cell * cell);
        assert_true(error < 1.5 * cell);
        f.def.control = LAC_CONTROL_APPROACH;
        f.def.approach = -a * a - mean;
        solve(&f);
        double load = f.report.mean_pressure / (4.0 / 3.0 * a * a * a) - 1.0;
        print_message("  pushed down by a^2: load %+.2e; %lld iterations\n", load,
                      (long long)f.report.iterations);
        assert_true(fabs(load) < 5.0 * cell * cell);
        free(f.h);
    }
}

// The same count as other codes', cell by cell.
static void rough_surface_with_free_boundaries(void **state)
{
    (void)state;
    fixture f = make(256, 4.9e-3);
    f.def.grid.periodic = false;
    assert_int_equal(benchmark_surface(256, f.h), 0);
    solve(&f);
    print_message("A08 256^2 free: %zu cells, p_max %.7f; %lld iterations\n", f.report.n_cells,
                  f.report.max_pressure, (long long)f.report.iterations);
    assert_int_equal(f.report.n_cells, 6490);
    assert_true(fabs(f.report.max_pressure - 0.30200) < 5e-6);
    assert_true(f.report.iterations <= 24);
    free(f.h);
}

static fixture rough(size_t n, double tolerance)
{
    fixture f = make(n, 4.9e-3);
    assert_int_equal(benchmark_surface(n, f.h), 0);
    f.def.tolerance = tolerance;
    solve(&f);
    return f;
}

// Contact areas that several independent codes agree on cell by cell.
static void rough_surface(void **state)
{
    (void)state;
    fixture f = rough(256, 1e-13);
    double p2 = 0.0;
    for (size_t i = 0; i < 256 * 256; i++) {
        p2 += f.p[i] * f.p[i] / (256.0 * 256.0);
    }
    assert_int_equal(f.report.n_cells, 6869);
    assert_true(fabs(f.report.max_pressure - 0.1875640302) < 1e-10);
    assert_true(fabs(p2 - 3.28839352852e-4) < 1e-14);
    free(f.h);
}

static void rough_surface_at_default_tolerance(void **state)
{
    (void)state;
    const double fractions[] = {0.1048126, 0.1022530};
    const int64_t most[] = {20, 24};
    for (size_t k = 0; k < 2; k++) {
        size_t n = (size_t)256 << k;
        fixture f = rough(n, 1e-8);
        double area = (double)f.report.n_cells / (double)(n * n);
        print_message("A08 %zu^2: %lld iterations, contact fraction %.7f\n", n,
                      (long long)f.report.iterations, area);
        assert_true(fabs(area - fractions[k]) < 5e-8 + 2.0 / (double)(n * n));
        assert_true(f.report.iterations <= most[k]);
        free(f.h);
    }
}

// From a few cells to nearly all of them: no load takes long.
static void rough_surface_at_every_load(void **state)
{
    (void)state;
    const double loads[] = {5e-6, 5e-5, 5e-4, 5e-3, 1.5e-2, 3e-2, 5e-2, 8e-2, 0.12, 0.2, 0.3};
    fixture f = make(512, 1.0);
    assert_int_equal(benchmark_surface(512, f.h), 0);
    size_t cells = 0;
    for (size_t k = 0; k < sizeof loads / sizeof loads[0]; k++) {
        f.def.mean_pressure = loads[k];
        solve(&f);
        print_message("A08 512^2 at %g E*: contact fraction %.6f, %lld iterations\n", loads[k],
                      (double)f.report.n_cells / (512.0 * 512.0), (long long)f.report.iterations);
        assert_true(f.report.iterations <= 40);
        assert_true(f.report.n_cells >= cells);
        cells = f.report.n_cells;
    }
    assert_int_equal(cells, 512 * 512);
    free(f.h);
}

// Up to 20 % of the area and back in small steps, each from the solution before.
static void sequence_of_loads_from_warm_starts(void **state)
{
    (void)state;
    fixture cold = make(256, 1.0);
    fixture warm = make(256, 1.0);
    assert_int_equal(benchmark_surface(256, cold.h), 0);
    memcpy(warm.h, cold.h, 256 * 256 * sizeof(double));
    int64_t cold_steps = 0;
    int64_t warm_steps = 0;
    for (int k = 0; k < 24; k++) {
        double load = 4e-3 * pow(1.1, k < 12 ? k : 23 - k);
        cold.def.mean_pressure = warm.def.mean_pressure = load;
        solve(&cold);
        solve(&warm);
        warm.def.start = warm.p;
        cold_steps += cold.report.iterations;
        warm_steps += warm.report.iterations;
        assert_int_equal(cold.report.n_cells, warm.report.n_cells);
        for (size_t i = 0; i < 256 * 256; i++) {
            assert_true(fabs(cold.p[i] - warm.p[i]) < 1e-6 * cold.report.max_pressure);
        }
    }
    print_message("24 loads: %lld iterations cold, %lld warm\n", (long long)cold_steps,
                  (long long)warm_steps);
    assert_true(warm_steps < cold_steps);
    // the same load again: nothing left to do
    solve(&warm);
    assert_true(warm.report.iterations <= 1);
    free(cold.h);
    free(warm.h);
}

// Pressures of the same problem by other codes, where the reference is at hand:
// LACUNA_CONTACT_DATA, or shared/data/contact beside the source.
static void rough_surface_against_reference(void **state)
{
    (void)state;
    const char *folder = getenv("LACUNA_CONTACT_DATA");
    char path[1024];
    if (folder == NULL) {
        folder = LACUNA_SOURCE_DIR "/../shared/data/contact";
    }
    double *reference = malloc(256 * 256 * sizeof *reference);
    assert_non_null(reference);
    (void)snprintf(path, sizeof path, "%s/A08_256_pressure_pbar0.0049.npy", folder);
    if (npy_read(path, 256 * 256, reference) != 0) {
        free(reference);
        print_message("no reference pressures at %s\n", path);
        skip();
    }
    fixture f = rough(256, 1e-13);
    double worst = 0.0;
    for (size_t i = 0; i < 256 * 256; i++) {
        worst = fmax(worst, fabs(f.p[i] - reference[i]));
        assert_true((f.p[i] > 0.0) == (reference[i] > 0.0));
    }
    print_message("A08 256^2: largest difference of the pressures %.2e E*\n", worst);
    assert_true(worst < 1e-9);
    (void)snprintf(path, sizeof path, "%s/A08_256.npy", folder);
    assert_int_equal(npy_read(path, 256 * 256, reference), 0);
    for (size_t i = 0; i < 256 * 256; i++) {
        assert_true(fabs(f.h[i] - reference[i]) < 1e-15);
    }
    free(f.h);
    free(reference);
}

// A joint-like surface sampled ever coarser: contact fractions that other codes found.
static void joint_at_several_resolutions(void **state)
{
    (void)state;
    const double fractions[] = {0.104736, 0.086121, 0.068253, 0.055264};
    double *h = malloc((size_t)1024 * 1024 * sizeof *h);
    assert_non_null(h);
    assert_int_equal(joint_surface(1024, h), 0);
    for (size_t k = 0; k < 4; k++) {
        size_t n = (size_t)64 << k;
        size_t m = 1024 / n;
        fixture f = make(n, 1e-2);
        for (size_t i = 0; i < n * n; i++) {
            f.h[i] = h[i / n * m * 1024 + i % n * m];
        }
        solve(&f);
        double area = (double)f.report.n_cells / (double)(n * n);
        print_message("J07 at 1/%zu: contact fraction %.6f (%.6f)\n", n, area, fractions[k]);
        assert_true(fabs(area - fractions[k]) < 6e-7 + 2.0 / (double)(n * n));
        free(f.h);
    }
    free(h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sinusoid_partial),
        cmocka_unit_test(sinusoid_full),
        cmocka_unit_test(sphere),
        cmocka_unit_test(free_sphere),
        cmocka_unit_test(rough_surface_with_free_boundaries),
        cmocka_unit_test(rough_surface),
        cmocka_unit_test(rough_surface_at_default_tolerance),
        cmocka_unit_test(rough_surface_at_every_load),
        cmocka_unit_test(sequence_of_loads_from_warm_starts),
        cmocka_unit_test(rough_surface_against_reference),
        cmocka_unit_test(joint_at_several_resolutions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
