// SPDX-License-Identifier: GPL-3.0-or-later
// The exact Newton solve of the creep problem against a dense solve with a Jacobian by finite
// differences, for every friction law, form and formulation, with and without cut-offs and the
// response to normal stress, under every kind of load, one by one and all at once, for cells that
// slide backwards, for those that carry the mass of a block, and for slip in two directions, each
// cell in its own.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "base/rng.h"
#include "support/newton.h"
#include "support/test.h"

// What a case may add to a law: cut-offs where the cells slide, and the response to normal stress.
static void add_all(tree_def *def)
{
    def->v1 = 1e-9;
    def->v2 = 2e-9;
    def->alpha = 0.3;
}

static void newton_solve_is_exact(void **state)
{
    (void)state;
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_get(l)) != NULL; l++) {
        for (uint64_t i = 0; i < 2 * 3 * 6 * 3; i += test_few() ? 7 : 1) {
            tree_def def = newton_tree(law, (int)(i % 2), 1 + i % 4);
            lac_load load = {.kind = &newton_pull, .params = &newton_pulls[i / 6 % 6]};
            def.formulation = newton_formulations[i / 2 % 3];
            def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
            double times = newton_dampings[i / 36].times;
            def.damping *= times;
            newton_check_tree(&def, times > 1.0, newton_dampings[i / 36].left);
            add_all(&def);
            newton_check_tree(&def, times > 1.0, newton_dampings[i / 36].left);
        }
    }
}

// A load that has turned back: every cell slides backwards, at 1e-9 m/s and at nearly nothing.
static void newton_solve_is_exact_backwards(void **state)
{
    (void)state;
    const double shares[] = {-1.0, -1e-3};
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_get(l)) != NULL; l++) {
        for (size_t s = 0; s < 2; s++) {
            tree_def def = newton_tree(law, LAC_FORM_REGULARISED, 1 + s);
            def.formulation = LAC_FORMULATION_TRACTION;
            tree t;
            tree_create(&def, &t);
            double y[128];
            double v[64];
            lac_problem_initial(t.problem, y);
            for (size_t i = 0; i < t.domain->n; i++) {
                y[i] *= shares[s];
            }
            double *work = calloc(lac_problem_work(t.problem), sizeof *work);
            lac_problem_rates(t.problem, 0.0, y, v, work);
            free(work);
            assert_true(v[0] < 0.0);
            newton_check(t.problem, y, 0.0, 10.0, NEWTON_EXACT);
            tree_clear(&t);
        }
    }
}

// Masses from one that hardly counts to one that holds everything, of a block and in columns,
// sliding forwards and, where friction allows it, backwards.
static void newton_solve_is_exact_with_mass(void **state)
{
    (void)state;
    const double masses[] = {1e-3, 1e3, 1e9};
    const double parts[] = {0.01, 0.5, 1.0};
    const int with = BY_RATIO | BY_SPRING;
    for (uint64_t i = 0; i < 3 * 3 * 3; i++) {
        bool back = i % 3 == 2;
        tree_def def = newton_tree(lac_friction_law_get(0), i % 3 > 0, 1 + i % 4);
        lac_load load = {.kind = &newton_pull, .params = back ? &newton_pulls[1] : &with};
        def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
        def.mass = masses[i / 3 % 3];
        def.columns = parts[i / 9];
        double time = back ? -1.27e5 : 5.0;
        double y[192];
        tree t;
        tree_create(&def, &t);
        lac_problem_initial(t.problem, y);
        newton_near_balance(&t, &def, time, y);
        assert_true(back == (y[0] < 0.0) || def.form == LAC_FORM_PLAIN);
        for (double gamma = 1e-3; gamma < 20.0; gamma *= 10.0) {
            newton_check(t.problem, y, time, gamma, NEWTON_EXACT);
        }
        tree_clear(&t);
    }
}

// Puts every cell of slip in two directions at its own place, so that each is pulled its own way,
// and into the state in which it slides at some 1e-9 m/s under that, some at 1e-22.
static void scatter(const tree *t, double time, double *y)
{
    const size_t n = t->domain->n;
    double *work = calloc(lac_problem_work(t->problem), sizeof *work);
    double traction[64];
    for (size_t k = 0; k < n; k++) {
        y[k] = 2e-6 * (lac_random_uniform(9, LAC_STREAM_TEST, k, 0) - 0.5);
        y[2 * n + k] = 2e-6 * (lac_random_uniform(9, LAC_STREAM_TEST, k, 1) - 0.5);
    }
    lac_problem_traction(t->problem, time, y + 2 * n, traction, work);
    for (size_t k = 0; k < n; k++) {
        const double u = log(1e-9) + (k % 5 == 0 ? -30.0 : 2.0 * (double)(k % 3));
        y[n + k] = lac_friction_state_for(t->friction, k, u, traction[k] / t->domain->pressure[k]);
        assert_true(isfinite(y[n + k]));
    }
    // They do go different ways.
    double v[64];
    lac_problem_rates(t->problem, time, y, v, work);
    const lac_components of = lac_problem_components(t->problem, y + 2 * n, work);
    double least = INFINITY, most = -INFINITY;
    for (size_t k = 0; k < n; k++) {
        const double way = atan2(of.rate[1][k], of.rate[0][k]);
        least = fmin(least, way);
        most = fmax(most, way);
        assert_true(fabs(hypot(of.rate[0][k], of.rate[1][k]) / v[k] - 1.0) < 1e-14);
    }
    assert_true(most - least > 0.3);
    free(work);
}

// Which way loads and tractions go changes from test to test.
static void newton_solve_is_exact_in_two_directions(void **state)
{
    (void)state;
    const int with[] = {0, BY_RATIO | BY_FORCE, BY_SPRING, BY_RATIO | BY_SPRING};
    for (uint64_t i = 0; i < 2 * 4 * 3; i += test_few() ? 5 : 1) {
        tree_def def = newton_tree(lac_friction_law_get(i % 3), (int)(i % 2), 1 + i % 4);
        lac_load load = {
            .kind = &newton_pull, .params = &with[i / 2 % 4], .azimuth = 0.3 * (double)i};
        def.keep = 0.7;
        def.formulation = LAC_FORMULATION_VECTOR;
        def.heading = 0.7 * (double)i;
        def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
        def.damping *= newton_dampings[i / 8].times;
        double y[192];
        tree t;
        tree_create(&def, &t);
        assert_true(t.domain->n > 4 && t.domain->n <= 64);
        lac_problem_initial(t.problem, y);
        scatter(&t, 5.0, y);
        for (double gamma = 1e-3; gamma < 20.0; gamma *= 10.0) {
            newton_check(t.problem, y, 5.0, gamma, newton_dampings[i / 8].left);
        }
        tree_clear(&t);
    }
}

// A step longer than a weakening cell allows is refused, not solved wrongly.
static void too_long_a_step_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        tree_def def = tree_default(2, 1);
        def.formulation = newton_formulations[i];
        def.state = 1e6; // theta v/dc = 100: weakening fast
        def.k0 = 0.0;
        tree t;
        tree_create(&def, &t);
        double y[64];
        double b[64] = {0};
        double *work = calloc(lac_problem_work(t.problem), sizeof *work);
        lac_problem_initial(t.problem, y);
        assert_true(lac_problem_newton(t.problem, 0.0, y, 1.0, b, work));
        assert_false(lac_problem_newton(t.problem, 0.0, y, 1e6, b, work));
        free(work);
        tree_clear(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(newton_solve_is_exact),
        cmocka_unit_test(newton_solve_is_exact_backwards),
        cmocka_unit_test(newton_solve_is_exact_with_mass),
        cmocka_unit_test(newton_solve_is_exact_in_two_directions),
        cmocka_unit_test(too_long_a_step_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
