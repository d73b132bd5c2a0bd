// SPDX-License-Identifier: GPL-3.0-or-later
// Iterations of the contact solver on fine grids and grids of any sides; threads.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <omp.h>
#include <stdbool.h>

#include "contact/contact.h"
#include "support/benchmark_surface.h"
#include "support/test.h"

#if defined(__SANITIZE_ADDRESS__)
#define CHECKED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CHECKED 1
#endif
#endif
#ifndef CHECKED
#define CHECKED 0
#endif

// A problem with E* = 1 and its solution.
typedef struct fixture {
    size_t cells;
    double *h, *p, *gap;
    lac_contact_def def;
    lac_contact_stats report;
} fixture;

static fixture make(size_t nx, size_t ny)
{
    fixture f = {.cells = nx * ny, .def = lac_contact_default()};
    f.h = calloc(3 * f.cells, sizeof *f.h);
    assert_non_null(f.h);
    f.p = f.h + f.cells;
    f.gap = f.p + f.cells;
    f.def.grid = (lac_grid){nx, ny, 1.0 / (double)nx, 1.0 / (double)nx, true};
    f.def.heights = f.h;
    f.def.e_star = 1.0;
    f.def.mean_pressure = 4.9e-3;
    return f;
}

static void solve(fixture *f)
{
    lac_error err = {""};
    if (lac_contact_solve(&f->def, f->p, f->gap, &f->report, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
}

// p >= 0, no penetration and no gap under pressure to the tolerance, and the load to rounding
static void check(const fixture *f)
{
    const double h_rms = 2.3e-3; // of A08, at most
    double limit = f->def.tolerance * h_rms;
    double pg = 0.0;
    double load = 0.0;
    for (size_t i = 0; i < f->cells; i++) {
        assert_true(f->p[i] >= 0.0);
        assert_true(f->p[i] > 0.0 || f->gap[i] > -limit);
        pg += f->p[i] * fabs(f->gap[i]) / (double)f->cells;
        load += f->p[i] / (double)f->cells;
    }
    assert_true(pg < load * limit);
    assert_true(fabs(load / f->def.mean_pressure - 1.0) < 1e-12);
}

// The contact fraction is that of other codes.
static void a_fine_grid_in_few_iterations(void **state)
{
    (void)state;
    if (CHECKED) {
        skip(); // minutes under a sanitizer
    }
    fixture f = make(1024, 1024);
    assert_int_equal(benchmark_surface(1024, f.h), 0);
    solve(&f);
    check(&f);
    double area = (double)f.report.n_cells / (double)f.cells;
    print_message("A08 1024^2: %lld iterations, contact fraction %.7f\n",
                  (long long)f.report.iterations, area);
    assert_true(f.report.iterations <= 30);
    assert_true(fabs(area - 0.1003618) < 2e-6);
    free(f.h);
}

// A08_512 sampled at the nearest node.
static void sample(const double *fine, fixture *f)
{
    size_t nx = f->def.grid.nx;
    size_t ny = f->def.grid.ny;
    for (size_t i = 0; i < f->cells; i++) {
        f->h[i] = fine[i / nx * 512 / ny * 512 + i % nx * 512 / nx];
    }
}

// Sides of any factors, primes too, find as good a guess on coarser grids as powers of two do.
static void any_sides_in_few_iterations(void **state)
{
    (void)state;
    const size_t sides[][2] = {{243, 135}, {500, 300}, {375, 225}, {251, 127}, {512, 40}};
    double *fine = malloc((size_t)512 * 512 * sizeof *fine);
    assert_non_null(fine);
    assert_int_equal(benchmark_surface(512, fine), 0);
    for (size_t k = 0; k < 4 * sizeof sides / sizeof sides[0]; k += 3) { // all sides, all ways
        fixture f = make(sides[k / 4][0], sides[k / 4][1]);
        f.def.grid.periodic = k % 2 == 0;
        f.def.grid.dy *= k % 4 < 2 ? 1.0 : 0.6;
        sample(fine, &f);
        solve(&f);
        check(&f);
        print_message("%zu x %zu, dy/dx %.1f, %s: %lld iterations\n", f.def.grid.nx, f.def.grid.ny,
                      f.def.grid.dy / f.def.grid.dx, f.def.grid.periodic ? "periodic" : "free",
                      (long long)f.report.iterations);
        assert_true(f.report.iterations <= (sides[k / 4][0] % 2 == 1 ? 24 : 26));
        free(f.h);
    }
    free(fine);
}

// Single-precision steps get to any tolerance that double precision can.
static void tight_tolerances(void **state)
{
    (void)state;
    for (int periodic = 0; periodic < 2; periodic++) {
        fixture f = make(256, 256);
        f.def.grid.periodic = periodic == 1;
        assert_int_equal(benchmark_surface(256, f.h), 0);
        for (double tolerance = 1e-4; tolerance > 5e-15; tolerance *= 1e-5) {
            f.def.tolerance = tolerance;
            solve(&f);
            print_message("tolerance %.0e: %lld iterations, complementarity %.1e\n", tolerance,
                          (long long)f.report.iterations, f.report.complementarity_error);
            assert_true(f.report.complementarity_error < tolerance);
            assert_true(f.report.iterations < 50);
        }
        free(f.h);
    }
}

// The same bits whatever the number of threads: a grid that is large enough for three.
static void threads_do_not_matter(void **state)
{
    (void)state;
    const int before = omp_get_max_threads();
    const size_t bytes = 3 * (size_t)384 * 270 * sizeof(double);
    for (int k = 0; k < 2; k++) {
        fixture one = make(384, 270);
        fixture more = make(384, 270);
        for (size_t i = 0; i < one.cells; i++) {
            double x = (double)(i % 384);
            double y = (double)(i / 384);
            one.h[i] = more.h[i] = sin(0.131 * x + 0.4 * sin(0.2 * y)) + sin(0.173 * y);
        }
        one.def.mean_pressure = more.def.mean_pressure = 2.0;
        one.def.control = more.def.control = k == 0 ? LAC_CONTROL_LOAD : LAC_CONTROL_APPROACH;
        one.def.approach = more.def.approach = 0.5;
        one.def.grid.periodic = more.def.grid.periodic = k == 0;
        omp_set_num_threads(1);
        solve(&one);
        assert_true(one.report.iterations > 3);
        for (int threads = 2; threads <= 3; threads++) {
            omp_set_num_threads(threads);
            solve(&more);
            assert_memory_equal(one.h, more.h, bytes);
            assert_memory_equal(&one.report, &more.report, sizeof one.report);
        }
        free(one.h);
        free(more.h);
    }
    omp_set_num_threads(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fine_grid_in_few_iterations),
        cmocka_unit_test(any_sides_in_few_iterations),
        cmocka_unit_test(tight_tolerances),
        cmocka_unit_test(threads_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
