// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "support/pressed.h"
#include "support/test.h"

static void wrong_approach_is_refused(void **state)
{
    fixture *f = *state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    f->def.control = LAC_CONTROL_APPROACH;
    f->def.mean_pressure = NAN; // not looked at
    for (size_t k = 0; k < 3; k++) {
        f->def.approach = bad[k];
        refuse(f, "approach");
    }
    f->def.approach = 0.0;
    refuse(f, "> 0");
    f->def.approach = -1.0;
    refuse(f, "> 0");
}

static void bodies_apart_do_not_touch(void **state)
{
    fixture *f = *state;
    f->def.control = LAC_CONTROL_APPROACH;
    f->def.approach = 2.0;
    f->h[9] = 1.0;
    for (int periodic = 0; periodic < 2; periodic++) {
        f->def.grid.periodic = periodic == 1;
        must_solve(f);
        assert_int_equal(f->report.n_cells, 0);
        assert_true(f->report.mean_pressure == 0.0 && f->report.max_pressure == 0.0);
        assert_true(fabs(f->gap[9] - (1.0 + 1.0 / 64.0)) < 1e-15);
        assert_true(fabs(f->gap[10] - (2.0 + 1.0 / 64.0)) < 1e-15);
    }
}

// One peak pushed down by a given depth: the closed form of a loaded square, 1 m wide.
static void one_cell_by_approach(void **state)
{
    fixture *f = *state;
    f->def.grid = (lac_grid){8, 8, 1.0, 1.0, false};
    f->def.e_star = 7.0;
    f->h[3 * 8 + 2] = 1.0;
    f->def.control = LAC_CONTROL_APPROACH;
    f->def.approach = 1.0 - 1.0 / 64.0 - 1e-2;
    must_solve(f);
    assert_int_equal(f->report.n_cells, 1);
    double expected = 1e-2 * 3.14159265358979 * 7.0 / (4.0 * asinh(1.0));
    assert_true(fabs(f->p[3 * 8 + 2] / expected - 1.0) < 1e-8);
    assert_true(fabs(f->report.mean_pressure * 64.0 / expected - 1.0) < 1e-8);
    assert_true(f->report.approach == f->def.approach);
}

// The approach that a load brings about brings about that load.
static void approach_and_load_agree(void **state)
{
    fixture *f = *state;
    double p[32 * 48];
    int64_t most = 0;
    for (int k = 0; k < 40; k++) {
        f->def.grid = (lac_grid){32, 48, 1.0, 0.7, k % 2 == 0};
        f->def.tolerance = 1e-11;
        f->def.control = LAC_CONTROL_LOAD;
        f->def.mean_pressure = 1e-9 * pow(2.0, k / 2) * f->def.e_star;
        fill_random(f, (uint64_t)k);
        must_solve(f);
        lac_contact_stats by_load = f->report;
        if (by_load.n_cells == 32 * 48 && f->def.grid.periodic) {
            continue; // no gap left to be given
        }
        memcpy(p, f->p, sizeof p);
        f->def.control = LAC_CONTROL_APPROACH;
        f->def.approach = by_load.approach;
        must_solve(f);
        most = f->report.iterations > most ? f->report.iterations : most;
        assert_true(fabs(f->report.mean_pressure / f->def.mean_pressure - 1.0) < 1e-6);
        assert_int_equal(f->report.n_cells, by_load.n_cells);
        for (size_t i = 0; i < 32 * 48; i++) {
            assert_true(fabs(f->p[i] - p[i]) < 1e-6 * by_load.max_pressure);
        }
        f->def.tolerance =
            1e-10; // free faces are judged by the depth here, a little more than the dent
        check_solution_at(f, f->report.mean_pressure);
    }
    print_message("most iterations by approach %lld\n", (long long)most);
    assert_true(most < 60);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(wrong_approach_is_refused),
        TEST(bodies_apart_do_not_touch),
        TEST(one_cell_by_approach),
        TEST(approach_and_load_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
