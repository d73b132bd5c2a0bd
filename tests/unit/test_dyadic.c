// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of all levels, and the load at which they count a stated dimension.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "fractal/fractal.h"
#include "support/pressed.h"
#include "support/test.h"

static lac_dyadic count(const lac_grid *grid, const double *pressure)
{
    lac_domain *domain = NULL;
    lac_error err = {""};
    assert_int_equal(lac_domain_create(grid, pressure, &domain, &err), LAC_OK);
    lac_dyadic d = lac_dyadic_count(domain);
    lac_domain_free(domain);
    return d;
}

// Box by box, with a fit of its own: sums of x, y, xx and xy.
static double dimension_of(const lac_grid *grid, const double *pressure)
{
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, n = 0.0;
    size_t longest = grid->nx > grid->ny ? grid->nx : grid->ny;
    for (size_t side = 1, last = 0; last == 0; side *= 2) {
        double boxes = 0.0;
        for (size_t top = 0; top < grid->ny; top += side) {
            for (size_t left = 0; left < grid->nx; left += side) {
                bool any = false;
                for (size_t i = 0; i < side * side; i++) {
                    size_t row = top + i / side;
                    size_t column = left + i % side;
                    any = any || (row < grid->ny && column < grid->nx &&
                                  pressure[row * grid->nx + column] > 0.0);
                }
                boxes += any ? 1.0 : 0.0;
            }
        }
        double l = log((double)side);
        n += 1.0;
        x += l;
        xx += l * l;
        y += log(boxes);
        xy += l * log(boxes);
        last = side >= longest;
    }
    return (x * y - n * xy) / (n * xx - x * x);
}

static void blocks_are_those_of_a_count_box_by_box(void **state)
{
    fixture *f = *state;
    const size_t sides[][2] = {{2, 2}, {8, 8}, {16, 4}, {12, 20}, {32, 32}, {33, 1}, {1, 9}};
    for (size_t k = 0; k < sizeof sides / sizeof sides[0]; k++) {
        lac_grid grid = {.nx = sides[k][0], .ny = sides[k][1], .dx = 1.0, .dy = 1.0};
        for (uint64_t seed = 0; seed < 20; seed++) {
            f->def.grid = grid;
            fill_random(f, seed);
            double threshold = 1e-3 * (double)seed / 25.0;
            for (size_t i = 0; i < lac_grid_cells(&grid); i++) {
                f->p[i] = f->h[i] > threshold ? 1.0 : 0.0;
            }
            f->p[seed % lac_grid_cells(&grid)] = 1.0;
            assert_true(fabs(count(&grid, f->p).dimension - dimension_of(&grid, f->p)) < 1e-12);
        }
    }
}

static void a_plane_a_line_and_a_point(void **state)
{
    (void)state;
    double p[256];
    for (size_t i = 0; i < 256; i++) {
        p[i] = 1.0;
    }
    const lac_grid plane = {.nx = 16, .ny = 16, .dx = 1.0, .dy = 1.0};
    const lac_grid line = {.nx = 256, .ny = 1, .dx = 1.0, .dy = 1.0};
    const lac_grid cell = {.nx = 1, .ny = 1, .dx = 1.0, .dy = 1.0};
    assert_true(fabs(count(&plane, p).dimension - 2.0) < 1e-14);
    assert_true(fabs(count(&line, p).dimension - 1.0) < 1e-14);
    assert_true(isnan(count(&cell, p).dimension));
    memset(p, 0, sizeof p);
    p[37] = 1.0;
    lac_dyadic one = count(&plane, p);
    assert_int_equal(one.levels, 4);
    assert_true(one.dimension == 0.0);
    assert_true(one.count[0] == 1.0 && one.count[4] == 1.0);
}

// A surface of 32 x 32 cells with waves of all lengths.
static void make_rough(fixture *f)
{
    f->def.grid = (lac_grid){.nx = 32, .ny = 32, .dx = 1.0, .dy = 1.0, .periodic = true};
    fill_random(f, 5);
    for (size_t i = 0; i < 1024; i++) {
        double x = 2.0 * M_PI * (double)(i % 32) / 32.0;
        double y = 2.0 * M_PI * (double)(i / 32) / 32.0;
        f->h[i] += 4e-3 * (cos(x) + cos(y + 1.0)) + 1e-3 * cos(3.0 * x + 2.0 * y);
    }
}

static void the_load_gives_the_dimension(void **state)
{
    fixture *f = *state;
    double afresh[1024];
    double before = 0.0;
    for (double target = 0.6; target < 1.96; target += 0.15) {
        make_rough(f);
        lac_status status = lac_dimension_solve(&f->def, target, f->p, f->gap, &f->report, &f->err);
        assert_string_equal(f->err.message, "");
        assert_int_equal(status, LAC_OK);
        double dimension = dimension_of(&f->def.grid, f->p);
        assert_true(fabs(dimension - target) < 0.02);
        assert_true(f->report.mean_pressure > before);
        before = f->report.mean_pressure;
        check_solution_at(f, before);
        // The load alone tells the contact.
        lac_contact_def def = f->def;
        def.mean_pressure = before;
        assert_int_equal(lac_contact_solve(&def, afresh, NULL, NULL, &f->err), LAC_OK);
        for (size_t i = 0; i < 1024; i++) {
            assert_true((afresh[i] > 0.0) == (f->p[i] > 0.0));
            assert_true(fabs(afresh[i] - f->p[i]) <= 1e-9 * f->report.max_pressure);
        }
    }
}

static void refuse_dimension(fixture *f, double dimension, const char *word)
{
    lac_status status = lac_dimension_solve(&f->def, dimension, f->p, f->gap, &f->report, &f->err);
    assert_int_equal(status, LAC_EINPUT);
    assert_non_null(strstr(f->err.message, word));
    f->err.message[0] = '\0';
}

static void what_no_load_gives_is_refused(void **state)
{
    fixture *f = *state;
    refuse_dimension(f, 1.5, "flat");
    make_rough(f);
    const double bad[] = {0.0, -1.0, 2.0, 3.0, NAN, INFINITY};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        refuse_dimension(f, bad[k], "must be > 0 and < 2");
    }
    refuse_dimension(f, 0.05, "jumps from 0 (1 cells)");
    // Columns that touch together, all along the interface.
    for (size_t i = 0; i < 1024; i++) {
        f->h[i] = i % 32 == 3 ? 1.0 : 1e-3 * (double)(i % 7);
    }
    refuse_dimension(f, 0.5, "at least 1");
    // A line holds no more than a line.
    f->def.grid.nx = 1024;
    f->def.grid.ny = 1;
    refuse_dimension(f, 1.2, "at most 1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(blocks_are_those_of_a_count_box_by_box, set_up, tear_down),
        cmocka_unit_test(a_plane_a_line_and_a_point),
        cmocka_unit_test_setup_teardown(the_load_gives_the_dimension, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_no_load_gives_is_refused, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
