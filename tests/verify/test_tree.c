// SPDX-License-Identifier: GPL-3.0-or-later
// Many strongly coupled cells: stiff, so that BDF with the exact solve needs few steps, whatever n.
#include <stdio.h>

#include <math.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/test.h"
#include "support/tree.h"

static lac_run_result run_tree(const tree_def *def, lac_method method, double rtol,
                               const lac_sink *sink)
{
    tree t;
    lac_error err = {""};
    lac_run_result result;
    tree_create(def, &t);
    lac_run_def how = lac_run_default();
    how.method = method;
    how.rtol = rtol;
    how.end = 1e10;
    how.failure_rate = INFINITY;
    how.stop_rate = 0.05;
    if (sink == NULL) {
        how.record.steps = 0;
    }
    lac_status status = lac_run(t.problem, &how, sink, &result, &err);
    tree_clear(&t);
    if (status != LAC_OK || result.end != LAC_END_STOP) {
        fail_msg("run: %s (end %d)", err.message, (int)result.end);
    }
    return result;
}

static tree_def runaway(int levels, uint64_t seed)
{
    tree_def def = tree_default(levels, seed);
    def.state *= 3.0; // above steady state everywhere: k_0 = 400 k_crit holds the cells together
    return def;
}

static void bdf_takes_twenty_times_fewer_steps(void **state)
{
    (void)state;
    tree_def def = runaway(6, 14);
    lac_run_result bdf = run_tree(&def, LAC_BDF, 1e-5, NULL);
    lac_run_result adams = run_tree(&def, LAC_ADAMS, 1e-5, NULL);
    lac_run_result erk = run_tree(&def, LAC_ERK, 1e-5, NULL);
    printf("steps at rtol 1e-5, 1 261 cells: BDF %lld, Adams %lld, ERK %lld\n",
           (long long)bdf.steps, (long long)adams.steps, (long long)erk.steps);
    assert_true(erk.steps >= 20 * bdf.steps);
    // All three meet at the time that a tight run gives, each within its tolerance's reach.
    lac_run_result tight = run_tree(&def, LAC_BDF, 1e-10, NULL);
    assert_true(fabs(bdf.time / tight.time - 1.0) < 1e-3);
    assert_true(fabs(adams.time / tight.time - 1.0) < 1e-3);
    assert_true(fabs(erk.time / tight.time - 1.0) < 1e-3);
}

static void steps_do_not_grow_with_cells(void **state)
{
    (void)state;
    tree_def small = runaway(6, 14);
    tree_def large = runaway(8, 3);
    lac_run_result few = run_tree(&small, LAC_BDF, 1e-5, NULL);
    lac_run_result many = run_tree(&large, LAC_BDF, 1e-5, NULL);
    printf("BDF steps: %lld and %lld\n", (long long)few.steps, (long long)many.steps);
    assert_true((double)many.steps <= 1.5 * (double)few.steps);
}

// The integrated balance drifts with the tolerance and no more.
static void balance_holds(void **state)
{
    (void)state;
    tree_def def = runaway(4, 2);
    double residual[3];
    for (int i = 0; i < 3; i++) {
        history h = {0};
        lac_sink sink = history_sink(&h);
        residual[i] = run_tree(&def, LAC_BDF, pow(10.0, -5 - 2 * i), &sink).balance_residual;
        printf("rtol 1e-%d: worst balance residual %.2e\n", 5 + 2 * i, residual[i]);
        history_clear(&h);
    }
    assert_true(residual[1] < 0.1 * residual[0] && residual[2] < 0.1 * residual[1]);
    assert_true(residual[2] < 1e-6);
}

// A sparse 8 x 8 domain whose cells all carry the block's pressure and start in its state.
static void alike(const block_def *one, const double start[2], double k0, tree *out)
{
    lac_error err;
    lac_grid grid = {.nx = 8, .ny = 8, .dx = 0.125, .dy = 0.125, .periodic = true};
    double pressure[64];
    double y[64];
    for (size_t i = 0; i < 64; i++) {
        pressure[i] = i % 3 == 0 ? one->pressure : 0.0;
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &out->domain, &err), LAC_OK);
    assert_int_equal(lac_hierarchy_create(out->domain, &out->hierarchy, &err), LAC_OK);
    tree_def def = tree_default(3, 1);
    def.k0 = k0;
    tree_make_transfer(&def, out);
    def.f0 = one->f0;
    def.a = one->a;
    def.b = one->b;
    def.dc = one->dc;
    def.v0 = one->v0;
    tree_make_friction(&def, out);
    size_t n = out->domain->n;
    for (size_t i = 0; i < n; i++) {
        y[i] = start[0];
        y[n + i] = start[1];
    }
    lac_problem_def problem = {.domain = out->domain,
                               .friction = out->friction,
                               .transfer = &out->transfer,
                               .log_rate = y,
                               .log_state = y + n};
    assert_int_equal(lac_problem_create(&problem, &out->problem, &err), LAC_OK);
}

// Cells that all start alike under pressures that are all alike are one block.
static void alike_cells_are_one_block(void **state)
{
    (void)state;
    block_def one = block_default(1.5, 0.7);
    block b;
    tree t = {0};
    double start[2];
    lac_error err;
    block_create(&one, &b);
    lac_problem_initial(b.problem, start);
    alike(&one, start, 1e9, &t);
    lac_run_def how = lac_run_default();
    how.rtol = 1e-9;
    how.end = 1e9;
    how.failure_rate = 1e6;
    lac_run_result many;
    lac_run_result single;
    assert_int_equal(lac_run(t.problem, &how, NULL, &many, &err), LAC_OK);
    assert_int_equal(lac_run(b.problem, &how, NULL, &single, &err), LAC_OK);
    assert_true(many.failed && single.failed);
    assert_true(fabs(many.time / single.time - 1.0) < 1e-8);
    tree_clear(&t);
    block_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bdf_takes_twenty_times_fewer_steps),
        cmocka_unit_test(steps_do_not_grow_with_cells),
        cmocka_unit_test(balance_holds),
        cmocka_unit_test(alike_cells_are_one_block),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
