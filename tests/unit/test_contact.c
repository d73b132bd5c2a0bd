// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "contact/solve.h"
#include "support/pressed.h"
#include "support/test.h"
#include "surface/surface.h"

static void wrong_input_is_refused(void **state)
{
    fixture *f = *state;
    const double bad[] = {NAN, INFINITY, -INFINITY, 0.0, -1.0};
    const lac_contact_def good = f->def;
    for (size_t k = 0; k < 5; k++) {
        f->def.mean_pressure = bad[k];
        refuse(f, "pressure");
        f->def = good;
    }
    f->h[0] = 1.7e308;
    f->h[1] = -1.7e308;
    refuse(f, "rms height");
}

static void no_convergence_says_how_far_it_got(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){64, 64, 1.0, 1.0, true};
    fill_random(f, 1);
    f->def.max_iterations = 2;
    assert_int_equal(solve(f), LAC_ENUMERIC);
    assert_non_null(strstr(f->err.message, "after 2 iterations"));
    assert_non_null(strstr(f->err.message, "complementarity"));
}

static void flat_surface_is_in_full_contact(void **state)
{
    fixture *f = *state;
    const double heights[] = {0.0, 0.1, -1e300};
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < 64; i++) {
            f->h[i] = heights[k];
        }
        must_solve(f);
        for (size_t i = 0; i < 64; i++) {
            assert_true(fabs(f->p[i] - 1e6) < 1e-3);
        }
        assert_int_equal(f->report.n_cells, 64);
    }
}

static void one_cell_carries_everything(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){1, 1, 5.0, 5.0, true};
    f->h[0] = 3.0;
    must_solve(f);
    assert_true(f->p[0] == 1e6);
    assert_true(f->gap[0] == 0.0);
}

// One free cell: the pressure is the load, the approach its own sinking, 4 (a asinh(b/a) +
// b asinh(a/b)) p/(pi E*) with half sides a, b.
static void one_free_cell_carries_everything(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){1, 1, 2.0, 3.0, false};
    f->def.e_star = 1.0;
    f->def.mean_pressure = 5.0;
    must_solve(f);
    assert_true(fabs(f->p[0] - 5.0) < 1e-14 && f->gap[0] == 0.0);
    double sinks = 4.0 * (asinh(1.5) + 1.5 * asinh(1.0 / 1.5)) * 5.0 / 3.14159265358979;
    assert_true(fabs(f->report.approach + sinks) < 1e-12);
}

// Cells a million times longer than wide, free: hard to solve but not wrong.
static void needle_shaped_cells(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){48, 40, 1.0, 1e6, false};
    fill_random(f, 9);
    for (double load = 1e-9; load < 1e-2; load *= 100.0) {
        f->def.mean_pressure = load * f->def.e_star;
        must_solve(f);
        check_solution(f);
    }
}

// One cell stands out so far that it alone touches.
static void single_asperity(void **state)
{
    fixture *f = *state;
    const size_t sides[] = {2, 7, 8, 64, 96};
    for (size_t k = 0; k < 5; k++) {
        size_t n = sides[k];
        memset(f->h, 0, sizeof f->h);
        f->def.grid = (lac_grid){n, n, 1.0, 1.0, true};
        f->def.mean_pressure = 1.0;
        size_t peak = (n / 2) * n + n / 3;
        f->h[peak] = 1e-3;
        must_solve(f);
        check_solution(f);
        assert_int_equal(f->report.n_cells, 1);
        assert_true(fabs(f->p[peak] / (double)(n * n) - 1.0) < 1e-12);
        assert_true(f->gap[0] > 0.0);
    }
}

// Two peaks of nearly the same height: while one alone carries the load it is in balance, and
// only the penetration at the other shows that more is to come.
static void two_asperities(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){32, 32, 1.0, 1.0, true};
    for (double lower = 1e-7; lower < 1.0; lower *= 10.0) {
        memset(f->h, 0, sizeof f->h);
        f->h[5 * 32 + 5] = 1e-3;
        f->h[20 * 32 + 20] = 1e-3 * (1.0 - lower);
        for (double load = 1e-12; load < 1e-4; load *= 4.0) {
            f->def.mean_pressure = load * f->def.e_star;
            must_solve(f);
            check_solution(f);
        }
    }
}

// From one cell that carries everything: complementarity is perfect from the start, and only the
// penetration elsewhere shows that this is no solution.
static void penetration_alone_keeps_it_going(void **state)
{
    fixture *f = *state;
    lac_half_space *s = NULL;
    f->def.grid = (lac_grid){32, 32, 1.0, 1.0, true};
    fill_random(f, 2);
    for (size_t i = 0; i < 32 * 32; i++) {
        f->h[i] *= 1e3;
    }
    const lac_extent extent = {32, 32, 1.0, 1.0, true, lac_strip_rows(NULL, 32)};
    assert_int_equal(lac_half_space_create(&extent, &s, &f->err), LAC_OK);
    lac_descent d = {.heights = {f->h, 0.0, 1.0},
                     .mean_pressure = 0.5,
                     .tolerance = 1e-9,
                     .max_iterations = 300};
    f->p[100] = 0.5 * 32.0 * 32.0;
    assert_int_equal(lac_descend(s, &d, f->p, f->gap, &f->err), LAC_OK);
    assert_true(lac_residual_holds(&d.residual, 1e-9));
    assert_true(d.iterations > 0);
    f->def.mean_pressure = 0.5;
    f->report.n_cells = 0;
    for (size_t i = 0; i < 32 * 32; i++) {
        f->report.n_cells += f->p[i] > 0.0 ? 1 : 0;
    }
    f->report.approach = d.closest - mean(f->h, 32 * 32);
    assert_true(f->report.n_cells > 100);
    check_solution(f);
    lac_half_space_free(s);
}

// Uneven cells, odd and prime sides, lines along x and along y, at all loads.
static void every_shape_of_grid(void **state)
{
    fixture *f = *state;
    const lac_grid grids[] = {
        {96, 64, 1.0, 1.0, true}, {64, 64, 1.0, 0.3, true},  {48, 80, 0.5, 1.0, true},
        {31, 37, 1.0, 1.0, true}, {1000, 1, 1.0, 1.0, true}, {1, 512, 1.0, 1.0, true},
        {2, 2, 1.0, 1.0, true},   {128, 2, 1.0, 1.0, true},  {3, 1, 1.0, 9.0, true},
    };
    for (size_t k = 0; k < 2 * sizeof grids / sizeof grids[0]; k++) {
        f->def.grid = grids[k / 2];
        f->def.grid.periodic = k % 2 == 0;
        fill_random(f, k / 2);
        for (double load = 1e-9; load < 100.0; load *= test_few() ? 1e4 : 10.0) {
            f->def.mean_pressure = load * f->def.e_star * 1e-3;
            must_solve(f);
            check_solution(f);
        }
    }
}

// The integral of 1/r over a cell of sides dx, dy whose middle is at (x, y), by its midpoints.
static double potential(double x, double y, double dx, double dy)
{
    const int m = 200;
    double sum = 0.0;
    for (int j = 0; j < m; j++) {
        for (int i = 0; i < m; i++) {
            double xs = x + dx * ((i + 0.5) / m - 0.5);
            double ys = y + dy * ((j + 0.5) / m - 0.5);
            sum += 1.0 / hypot(xs, ys);
        }
    }
    return sum * dx * dy / (m * m);
}

// One loaded cell: the free surface sinks by p/(pi E*) times the integral of 1/r over the cell.
static void free_surface_around_one_cell(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){9, 12, 0.5, 2.0, false};
    f->def.e_star = 7.0;
    f->def.mean_pressure = 1e-6;
    f->h[3 * 9 + 2] = 1e-3;
    must_solve(f);
    assert_int_equal(f->report.n_cells, 1);
    double unit = f->p[3 * 9 + 2] / (3.14159265358979 * 7.0);
    assert_true(fabs(f->p[3 * 9 + 2] - 108e-6) < 1e-15);
    // the loaded cell itself: 4 (a asinh(b/a) + b asinh(a/b)), half sides a, b
    double self = 4.0 * (0.25 * asinh(4.0) + 1.0 * asinh(0.25)) * unit;
    for (size_t i = 0; i < 108; i++) {
        double x = ((double)(i % 9) - 2.0) * 0.5;
        double y = ((double)(i / 9) - 3.0) * 2.0;
        double gap = i == 3 * 9 + 2 ? 0.0 : potential(x, y, 0.5, 2.0) * unit - self + 1e-3;
        assert_true(fabs(f->gap[i] - gap) < 2e-5 * self);
    }
    // u = 0 far away
    assert_true(fabs(f->report.approach - (1e-3 - 1e-3 / 108.0 - self)) < 1e-12);
}

// A flat face: pressures grow to the border, alike on all four sides.
static void flat_free_face_is_a_punch(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){32, 32, 1.0, 1.0, false};
    must_solve(f);
    check_solution(f);
    assert_int_equal(f->report.n_cells, 32 * 32);
    for (size_t i = 0; i < 32 * 32; i++) {
        size_t turned = i % 32 * 32 + 31 - i / 32;
        assert_true(fabs(f->p[i] / f->p[turned] - 1.0) < 1e-5);
    }
    for (size_t i = 1; i < 16; i++) {
        assert_true(f->p[16 * 32 + i] < f->p[16 * 32 + i - 1]);
    }
    assert_true(f->p[0] == f->report.max_pressure || f->p[0] > 5e6);
}

// The solution of a line is that of the plane built by repeating it.
static void line_equals_grooved_plane(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){64, 1, 1.0, 1.0, true};
    f->def.tolerance = 1e-12;
    fill_random(f, 7);
    must_solve(f);
    double line[64];
    memcpy(line, f->p, sizeof line);
    f->def.grid.ny = 64;
    for (size_t i = 64; i < 64 * 64; i++) {
        f->h[i] = f->h[i % 64];
    }
    must_solve(f);
    for (size_t i = 0; i < 64 * 64; i++) {
        assert_true(fabs(f->p[i] - line[i % 64]) < 1e-6 * f->report.max_pressure);
    }
}

// Heights, modulus and load by any power of ten: the same contact.
static void units_do_not_matter(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){32, 32, 1.0, 1.0, true};
    fill_random(f, 3);
    f->def.mean_pressure = 2e-5 * f->def.e_star;
    must_solve(f);
    size_t cells = f->report.n_cells;
    assert_true(cells > 10 && cells < 900);
    const double scales[] = {1e-150, 1e-30, 1e30, 1e100};
    for (size_t k = 0; k < 4; k++) {
        fill_random(f, 3);
        for (size_t i = 0; i < 32 * 32; i++) {
            f->h[i] *= scales[k];
        }
        f->def.mean_pressure = 2e-5 * f->def.e_star * scales[k];
        must_solve(f);
        check_solution(f);
        assert_int_equal(f->report.n_cells, cells);
    }
}

// The least and the greatest loads that numbers hold.
static void absurd_loads(void **state)
{
    fixture *f = *state;
    const double loads[] = {1e-300, 1e-100, 1e-20, 1e100, 1e300};
    f->def.grid = (lac_grid){64, 64, 1.0, 1.0, true};
    for (size_t k = 0; k < 5; k++) {
        fill_random(f, 5);
        f->def.mean_pressure = loads[k];
        must_solve(f);
        check_solution(f);
        assert_int_equal(f->report.n_cells, loads[k] < 1.0 ? 1 : 64 * 64);
    }
}

// Random self-affine surfaces from a few cells in contact to all of them.
static void random_surfaces(void **state)
{
    fixture *f = *state;
    const lac_surface_source *source = lac_surface_source_get(0);
    lac_model model = {0};
    f->def.grid = (lac_grid){64, 64, 1.0, 1.0, true};
    assert_int_equal(lac_model_create(&source->info, &model, &f->err), LAC_OK);
    int64_t most = 0;
    for (int64_t seed = 1; seed <= (int64_t)test_some(12); seed++) {
        lac_self_affine *params = model.params;
        params->seed = seed;
        params->rms_height = 0.1;
        params->hurst = (double)seed / 12.0;
        params->rolloff = seed % 3 == 0 ? (double)NAN : 16.0;
        assert_int_equal(lac_surface_generate(&model, &f->def.grid, f->h, NULL, &f->err), LAC_OK);
        for (double load = 1e-5; load < 30.0; load *= 3.0) {
            f->def.mean_pressure = load * 0.1 * f->def.e_star;
            f->def.tolerance = seed % 2 == 0 ? 1e-8 : 1e-12;
            must_solve(f);
            check_solution(f);
            most = f->report.iterations > most ? f->report.iterations : most;
        }
        assert_int_equal(f->report.n_cells, 64 * 64);
    }
    lac_model_clear(&model);
    print_message("most iterations %lld\n", (long long)most);
    assert_true(most < 100);
}

static void report_and_gap_may_be_left_out(void **state)
{
    fixture *f = *state;
    fill_random(f, 1);
    assert_int_equal(lac_contact_solve(&f->def, f->p, NULL, NULL, NULL), LAC_OK);
    assert_true(fabs(mean(f->p, 64) - 1e6) < 1e-5);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(wrong_input_is_refused),
        TEST(no_convergence_says_how_far_it_got),
        TEST(flat_surface_is_in_full_contact),
        TEST(one_cell_carries_everything),
        TEST(one_free_cell_carries_everything),
        TEST(needle_shaped_cells),
        TEST(single_asperity),
        TEST(two_asperities),
        TEST(penetration_alone_keeps_it_going),
        TEST(every_shape_of_grid),
        TEST(free_surface_around_one_cell),
        TEST(flat_free_face_is_a_punch),
        TEST(line_equals_grooved_plane),
        TEST(units_do_not_matter),
        TEST(absurd_loads),
        TEST(random_surfaces),
        TEST(report_and_gap_may_be_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
