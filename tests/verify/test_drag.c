// SPDX-License-Identifier: GPL-3.0-or-later
// How cells of different pressures share what the waves of their mean take off them.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <stdio.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/test.h"
#include "support/tree.h"

static void ramp_up(const lac_load *load, double t, lac_load_state *sum)
{
    double rate = *(const double *)load->params;
    sum->ratio += rate * t;
    sum->ratio_rate += rate;
}

// By hand, of cells that nothing ties: p f(v, theta) + eta v + eta (L^2/(n r^2) - 1) p/(mean p) V.
static void carried(const tree *t, const tree_def *def, const double *u, const double *w, double *q)
{
    size_t n = t->domain->n;
    double idle = (double)lac_grid_cells(&t->domain->grid) / (double)n - 1.0;
    double rate = 0.0;
    double pressure = 0.0;
    for (size_t i = 0; i < n; i++) {
        rate += exp(u[i]) / (double)n;
        pressure += t->domain->pressure[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        double p = t->domain->pressure[i];
        double f = def->f0 + def->a * (u[i] - log(def->v0)) +
                   def->b * (w[i] + log(def->v0) - log(def->dc));
        q[i] = p * f + def->damping * (exp(u[i]) + idle * p / pressure * rate);
    }
}

// Cells of pressures from 0.05 to some 5 times the mean, each at a rate and in a state of its own:
// the mean damps each by its share of the normal force, and so it stays as time goes on.
static void drag_is_shared_by_pressure(void **state)
{
    static double rise = 0.7; // of the ratio, per second
    const lac_load_kind row = {.info = {.name = "rise"}, .add = ramp_up};
    lac_load load = {.kind = &row, .params = &rise};
    tree_def def = tree_default(4, 3);
    def.keep = 0.6;
    def.k0 = 0.0;
    def.slip_rate = 0.3;
    def.state = def.dc / def.slip_rate;
    def.formulation = chosen(state);
    def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
    tree t;
    tree_create(&def, &t);
    size_t n = t.domain->n;
    double y[2][512], u[3][256], w[256], q[3][256], ydot[512], v[256];
    double *work = calloc(lac_problem_work(t.problem), sizeof *work);
    const double h = 1e-9;
    lac_problem_initial(t.problem, y[0]);
    assert_true(n > 10 && n < 200 && lac_problem_derivative(t.problem, 0.0, y[0], ydot, work));
    for (int k = -1; k <= 1; k++) {
        for (size_t i = 0; i < 2 * n; i++) {
            y[1][i] = y[0][i] + k * h * ydot[i];
        }
        lac_problem_rates(t.problem, k * h, y[1], v, work);
        for (size_t i = 0; i < n; i++) {
            u[k + 1][i] = log(v[i]);
            w[i] = y[1][n + i];
        }
        carried(&t, &def, u[k + 1], w, q[k + 1]);
    }
    lac_problem_traction(t.problem, 0.0, memset(v, 0, sizeof v), u[0], work);
    for (size_t i = 0; i < n; i++) {
        double p = t.domain->pressure[i];
        double pulled = (q[2][i] - q[0][i]) / (2.0 * h);
        assert_true(fabs(q[1][i] - u[0][i]) < 1e-10 * p);
        if (!(fabs(pulled - p * rise) < 1e-4 * p * rise)) {
            fail_msg("cell %zu of %g Pa: pulled by %g Pa/s, not %g", i, p, pulled, p * rise);
        }
    }
    free(work);
    tree_clear(&t);
}

// Cells held by their neighbours less than they weaken, so that each fails as a micro-slip of its
// own, among some that are pressed 20 times less than the mean: none of these is turned back, which
// ln v as the unknown could not follow, and all formulations find the same time of failure.
static void cells_slip_one_by_one(void **state)
{
    (void)state;
    const lac_formulation all[] = {LAC_FORMULATION_RATE, LAC_FORMULATION_TRACTION,
                                   LAC_FORMULATION_SLIP};
    for (uint64_t seed = 1; seed <= 3; seed++) {
        double times[3];
        for (size_t k = 0; k < 3; k++) {
            tree_def def = tree_default(5, seed);
            def.keep = 0.5;
            def.k0 = 2e9; // k_crit of the mean cell: 2.5e10 Pa/m
            def.state = 3.0 * def.dc / def.slip_rate;
            def.formulation = all[k];
            tree t;
            lac_error err = {""};
            lac_run_result result;
            tree_create(&def, &t);
            lac_run_def how = lac_run_default();
            how.rtol = 1e-7;
            how.end = 1e9;
            how.failure_rate = INFINITY;
            how.failure_slip = 1e-2;
            if (lac_run(t.problem, &how, NULL, &result, &err) != LAC_OK) {
                fail_msg("seed %d, formulation %zu: %s", (int)seed, k, err.message);
            }
            assert_true(result.failed);
            times[k] = result.failure_origin + result.failure_local;
            printf("seed %d: %zu cells, %lld steps, fails at %.10g s\n", (int)seed, t.domain->n,
                   (long long)result.steps, times[k]);
            assert_true(fabs(times[k] / times[0] - 1.0) < 1e-4);
            tree_clear(&t);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOR_EACH_FORMULATION(drag_is_shared_by_pressure),
        cmocka_unit_test(cells_slip_one_by_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
