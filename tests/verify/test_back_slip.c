// SPDX-License-Identifier: GPL-3.0-or-later
// Rock that stays behind: a slab is a spring to uniform slip; creeping surroundings load a patch.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/simulation.h"
#include "support/fault.h"
#include "support/test.h"
#include "support/trees.h"

static const double plate_rate = 1e-9;

// A1 of the peers: sigma 10 MPa, a 0.010, b 0.015, dc 0.1 mm, v(0) 1e-10 m/s, theta(0) 1e5 s; slabs
// of 150 m are as stiff as its spring, G/(2 H) = 1e8 Pa/m.
static void patch_create(lac_grid grid, bool line, bool antiplane, bool creeping, double scatter,
                         fault *f)
{
    size_t n = lac_grid_cells(&grid);
    double *a = new_doubles(n), *u = new_doubles(n), *w = new_doubles(n);
    for (size_t i = 0; i < n; i++) {
        a[i] = 0.010;
        u[i] = log(1e-10) + scatter * draw_uniform(3, i, -1, 1);
        w[i] = log(1e5);
    }
    fault_def def = {.grid = grid,
                     .line = line,
                     .antiplane = antiplane,
                     .creeping = creeping,
                     .thickness = creeping ? (double)NAN : 150,
                     .plate_rate = plate_rate,
                     .pressure = 10e6,
                     .b = 0.015,
                     .dc = 1e-4,
                     .a = a,
                     .log_rate = u,
                     .log_state = w,
                     .newton_tolerance = 1e-3};
    fault_create(&def, f);
    free(a);
    free(u);
    free(w);
}

static void slabs_load_uniform_slip_as_a_spring_does(void **state)
{
    (void)state;
    const double first_event = 5.615967767843e6; // of the spring slider, to all digits
    const lac_grid grids[] = {{16, 1, 0.01, 1, true}, {4, 3, 0.01, 0.02, true}};
    for (int k = 0; k < 3; k++) {
        fault f;
        patch_create(grids[k / 2], k < 2, k == 1, false, 0, &f);
        fault_events observation;
        lac_run_result result = fault_run(&f, LAC_BDF, 6e6, 1e-8, &observation);
        print_message("first event %.10g s, off by %.1e; balance %.1e, %lld steps\n",
                      observation.time[0], observation.time[0] / first_event - 1,
                      result.balance_residual, (long long)result.steps);
        assert_true(fabs(observation.time[0] / first_event - 1) < 1e-6);
        assert_true(result.balance_residual < 1e-5);
        fault_free(&f);
    }
}

// What the balance holds in slip it holds in rates: the residual, and the force of the cells.
static void creeping_surroundings_load_a_patch(void **state)
{
    (void)state;
    fault f;
    patch_create((lac_grid){8, 8, 0.02, 0.02, false}, false, false, true, 1, &f);
    fault_events observation;
    lac_run_result result = fault_run(&f, LAC_BDF, 2e6, 1e-7, &observation);
    print_message("mean slip %.4g m of %.4g m, balance %.1e\n", result.mean_slip, 2e6 * plate_rate,
                  result.balance_residual);
    // so stiff a patch follows what surrounds it
    assert_true(fabs(result.mean_slip / (2e6 * plate_rate) - 1) < 0.1);
    assert_true(result.balance_residual < 1e-4);

    size_t n = f.parts.domain->n;
    double *slip = new_doubles(n), *traction = new_doubles(n), *y = new_doubles(2 * n);
    double *work = new_doubles(lac_problem_work(f.parts.problem)), sum = 0;
    for (size_t i = 0; i < n; i++) {
        slip[i] = draw_uniform(4, i, 0, 1e-3);
    }
    lac_observation look;
    lac_problem_initial(f.parts.problem, y);
    lac_problem_observe(f.parts.problem, 1e5, y, slip, false, &look, work);
    lac_problem_traction(f.parts.problem, 1e5, slip, traction, work);
    for (size_t i = 0; i < n; i++) {
        sum += traction[i] * 4e-4;
    }
    assert_true(fabs(sum / look.shear_force - 1) < 1e-12);
    free(slip);
    free(traction);
    free(y);
    free(work);
    fault_free(&f);
}

// At the plate's rate and steady, nothing changes; faster, it is held, slower, driven.
static void plates_draw_towards_their_own_rate(void **state)
{
    (void)state;
    fault f;
    patch_create((lac_grid){6, 5, 1, 1, false}, false, false, true, 0, &f);
    size_t n = f.parts.domain->n;
    double *y = new_doubles(2 * n), *rate = new_doubles(2 * n);
    double *work = new_doubles(lac_problem_work(f.parts.problem));
    for (int k = -1; k <= 1; k++) {
        for (size_t i = 0; i < n; i++) {
            y[i] = log(plate_rate) + k;
            y[n + i] = log(1e-4) - y[i];
        }
        assert_true(lac_problem_derivative(f.parts.problem, 1, y, rate, work));
        for (size_t i = 0; i < 2 * n; i++) {
            bool moves = i < n && k != 0;
            assert_true(moves ? rate[i] * k < -1e-9 : fabs(rate[i]) < 1e-18);
        }
    }
    free(y);
    free(rate);
    free(work);
    fault_free(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slabs_load_uniform_slip_as_a_spring_does),
        cmocka_unit_test(creeping_surroundings_load_a_patch),
        cmocka_unit_test(plates_draw_towards_their_own_rate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
