// SPDX-License-Identifier: GPL-3.0-or-later
// The exact Newton solve of the creep problem against a dense solve with a Jacobian by finite
// differences, for every friction law and form, with and without cut-offs and the response to
// normal stress, under every kind of load at once.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <gsl/gsl_linalg.h>
#include <math.h>

#include "base/rng.h"
#include "support/tree.h"

// Everything that can pull at a cell: ratio, force, spring and a changing pore pressure.
static void pull(const lac_load *load, double t, lac_load_state *sum)
{
    (void)load;
    sum->ratio += 1e-5 * t;
    sum->ratio_rate += 1e-5;
    sum->stress += 10.0 * t;
    sum->stress_rate += 10.0;
    sum->spring_stiffness += 1e9;
    sum->spring_stress += 1e9 * 3e-9 * t;
    sum->spring_rate += 1e9 * 3e-9;
    sum->pore += 1e5 + 20.0 * t;
    sum->pore_rate += 20.0;
}

static const lac_load_kind pull_kind = {.about = {.name = "pull"}, .add = pull};

// One row of J by central differences: stepping one unknown moves all rates.
static void jacobian(const lac_problem *problem, double t, const double *y, gsl_matrix *j)
{
    size_t m = 2 * lac_problem_cells(problem);
    double *work = malloc(lac_problem_work(problem) * sizeof *work);
    double *at = malloc(3 * m * sizeof *at);
    double *up = at + m;
    double *down = up + m;
    for (size_t k = 0; k < m; k++) {
        const double h = 1e-6;
        memcpy(at, y, m * sizeof *at);
        at[k] = y[k] + h;
        assert_true(lac_problem_derivative(problem, t, at, up, work));
        at[k] = y[k] - h;
        assert_true(lac_problem_derivative(problem, t, at, down, work));
        for (size_t i = 0; i < m; i++) {
            gsl_matrix_set(j, i, k, (up[i] - down[i]) / (2.0 * h));
        }
    }
    free(at);
    free(work);
}

static void check_solve(const lac_problem *problem, const double *y, double t, double gamma)
{
    size_t m = 2 * lac_problem_cells(problem);
    gsl_matrix *a = gsl_matrix_alloc(m, m);
    gsl_vector *b = gsl_vector_alloc(m);
    gsl_vector *x = gsl_vector_alloc(m);
    gsl_permutation *p = gsl_permutation_alloc(m);
    double *mine = malloc(m * sizeof *mine);
    double *work = malloc(lac_problem_work(problem) * sizeof *work);
    int sign;

    jacobian(problem, t, y, a);
    gsl_matrix_scale(a, -gamma);
    for (size_t i = 0; i < m; i++) {
        gsl_matrix_set(a, i, i, 1.0 + gsl_matrix_get(a, i, i));
        mine[i] = lac_random_uniform(7, LAC_STREAM_TEST, i, 0) - 0.5;
        gsl_vector_set(b, i, mine[i]);
    }
    gsl_linalg_LU_decomp(a, p, &sign);
    gsl_linalg_LU_solve(a, p, b, x);
    assert_true(lac_problem_newton(problem, t, y, gamma, mine, work));
    double most = gsl_vector_max(x) > -gsl_vector_min(x) ? gsl_vector_max(x) : -gsl_vector_min(x);
    for (size_t i = 0; i < m; i++) {
        if (!(fabs(mine[i] - gsl_vector_get(x, i)) < 1e-6 * most)) {
            fail_msg("component %zu: %g, dense %g (gamma %g)", i, mine[i], gsl_vector_get(x, i),
                     gamma);
        }
    }
    free(work);
    free(mine);
    gsl_permutation_free(p);
    gsl_vector_free(x);
    gsl_vector_free(b);
    gsl_matrix_free(a);
}

// Every form of a law, without and with what a case may add to it.
static void check_law(const char *law, uint64_t seed)
{
    const double gammas[] = {1e-3, 1.0, 1e2, 1e3};
    for (int i = 0; i < 8; i++) {
        size_t steps = i / 2 % 2 == 1 ? 3 : 4; // beyond v1 the longest is too long
        tree_def def = tree_default(3, seed);
        def.law = law;
        def.form = i % 2;
        def.v1 = i / 2 % 2 == 1 ? 1e-9 : 0.0; // where the cells slide
        def.v2 = i / 2 % 2 == 1 ? 2e-9 : 0.0;
        def.alpha = i / 4 == 1 ? 0.3 : 0.0;
        def.keep = 0.4;
        def.ratio = 0.7;
        def.state = 4e3;
        lac_load load = {.kind = &pull_kind};
        def.loads = (lac_load_set){.shear = &load, .shear_count = 1};
        tree t;
        tree_create(&def, &t);
        double y[128];
        lac_problem_initial(t.problem, y);
        for (size_t g = 0; g < steps; g++) {
            check_solve(t.problem, y, 5.0, gammas[g]);
        }
        tree_clear(&t);
    }
}

static void newton_solve_is_exact(void **state)
{
    (void)state;
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_at(l)) != NULL; l++) {
        for (uint64_t seed = 1; seed <= 3; seed++) {
            check_law(law->about.name, seed);
        }
    }
}

// A step longer than a weakening cell allows is refused, not solved wrongly.
static void too_long_a_step_is_refused(void **state)
{
    (void)state;
    tree_def def = tree_default(2, 1);
    def.state = 1e6; // theta v/dc = 100: weakening fast
    def.k0 = 0.0;
    tree t;
    tree_create(&def, &t);
    double y[64];
    double b[64] = {0};
    double *work = malloc(lac_problem_work(t.problem) * sizeof *work);
    lac_problem_initial(t.problem, y);
    assert_true(lac_problem_newton(t.problem, 0.0, y, 1.0, b, work));
    assert_false(lac_problem_newton(t.problem, 0.0, y, 1e6, b, work));
    free(work);
    tree_clear(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(newton_solve_is_exact),
        cmocka_unit_test(too_long_a_step_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
