// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/newton.h"

#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>
#include <math.h>

#include "base/rng.h"
#include "support/test.h"

static void pull(const lac_load *load, double t, lac_load_state *sum)
{
    int with = *(const int *)load->params;
    if (with & BY_RATIO) {
        sum->ratio += 1e-5 * t;
        sum->ratio_rate += 1e-5;
    }
    if (with & BY_FORCE) {
        sum->stress += 10.0 * t;
        sum->stress_rate += 10.0;
    }
    if (with & BY_SPRING) {
        sum->spring_stiffness += 1e9;
        sum->spring_stress += 1e9 * 3e-9 * t;
        sum->spring_rate += 1e9 * 3e-9;
    }
    if (with & BY_PORE) {
        sum->pore += 1e5 + 20.0 * t;
        sum->pore_rate += 20.0;
    }
}

const lac_load_kind newton_pull = {.info = {.name = "pull"}, .add = pull};
const int newton_pulls[6] = {0, BY_RATIO, BY_FORCE, BY_SPRING, BY_PORE, 15};
const lac_formulation newton_formulations[3] = {LAC_FORMULATION_RATE, LAC_FORMULATION_TRACTION,
                                                LAC_FORMULATION_SLIP};

const newton_damping newton_dampings[3] = {{0.0, NEWTON_EXACT}, {1.0, 1e-3}, {1e7, NEWTON_EXACT}};

// What of unknown k is worth an e-fold of v or theta.
static double *scales(const lac_problem *problem)
{
    size_t m = lac_problem_unknowns(problem);
    double *scale = malloc(m * sizeof *scale);
    double *nothing = calloc(m, sizeof *nothing);
    lac_problem_weights(problem, nothing, 1.0, scale);
    free(nothing);
    for (size_t i = 0; i < m; i++) {
        scale[i] = 1.0 / scale[i];
    }
    return scale;
}

// One column of J by central differences of fourth order: stepping one unknown moves all rates.
// Rows and columns are scaled, so that all unknowns count alike.
static void jacobian(const lac_problem *problem, double t, const double *y, const double *scale,
                     gsl_matrix *j)
{
    size_t m = lac_problem_unknowns(problem);
    double *work = calloc(lac_problem_work(problem), sizeof *work);
    double *at = malloc(5 * m * sizeof *at);
    const double offset[] = {-2.0, -1.0, 1.0, 2.0};
    for (size_t k = 0; k < m; k++) {
        double h = 1e-3 * scale[k];
        for (size_t s = 0; s < 4; s++) {
            memcpy(at, y, m * sizeof *at);
            at[k] = y[k] + offset[s] * h;
            assert_true(lac_problem_derivative(problem, t, at, at + (s + 1) * m, work));
        }
        for (size_t i = 0; i < m; i++) {
            const double *d = at + m + i;
            double slope = (8.0 * (d[2 * m] - d[m]) - (d[3 * m] - d[0])) / (12.0 * h);
            gsl_matrix_set(j, i, k, slope * scale[k] / scale[i]);
        }
    }
    free(at);
    free(work);
}

void newton_check(const lac_problem *problem, const double *y, double t, double gamma, double left)
{
    size_t m = lac_problem_unknowns(problem);
    gsl_matrix *a = gsl_matrix_alloc(m, m);
    gsl_vector *b = gsl_vector_alloc(m);
    gsl_vector *x = gsl_vector_alloc(m);
    gsl_permutation *p = gsl_permutation_alloc(m);
    double *scale = scales(problem);
    double *mine = malloc(m * sizeof *mine);
    double *work = calloc(lac_problem_work(problem), sizeof *work);
    int sign;

    jacobian(problem, t, y, scale, a);
    gsl_matrix_scale(a, -gamma);
    for (size_t i = 0; i < m; i++) {
        gsl_matrix_set(a, i, i, 1.0 + gsl_matrix_get(a, i, i));
        double random = lac_random_uniform(7, LAC_STREAM_TEST, i, 0) - 0.5;
        mine[i] = random * scale[i];
        gsl_vector_set(b, i, random);
    }
    gsl_linalg_LU_decomp(a, p, &sign);
    gsl_linalg_LU_solve(a, p, b, x);
    if (!lac_problem_newton(problem, t, y, gamma, mine, work)) {
        fail_msg("%s, gamma %g: no solution", lac_problem_unknown(problem), gamma);
    }
    double most = gsl_vector_max(x) > -gsl_vector_min(x) ? gsl_vector_max(x) : -gsl_vector_min(x);
    for (size_t i = 0; i < m; i++) {
        if (!(fabs(mine[i] / scale[i] - gsl_vector_get(x, i)) < left * most)) {
            fail_msg("%s, component %zu: %g, dense %g (gamma %g)", lac_problem_unknown(problem), i,
                     mine[i] / scale[i], gsl_vector_get(x, i), gamma);
        }
    }
    free(work);
    free(mine);
    free(scale);
    gsl_permutation_free(p);
    gsl_vector_free(x);
    gsl_vector_free(b);
    gsl_matrix_free(a);
}

tree_def newton_tree(const lac_friction_law *law, int form, uint64_t seed)
{
    tree_def def = tree_default(3, seed);
    def.law = law->info.name;
    def.form = form;
    def.keep = 0.4;
    def.ratio = 0.7;
    def.state = 4e3;
    return def;
}

void newton_check_tree(const tree_def *def, bool damped, double left)
{
    const double gammas[] = {1e-3, 1.0, 1e2, 1e3};
    const size_t steps = def->v1 > 0 || damped ? 3 : 4; // the longest is too long then
    tree t;
    tree_create(def, &t);
    double y[128];
    lac_problem_initial(t.problem, y);
    for (size_t g = 0; g < steps; g++) {
        newton_check(t.problem, y, 5.0, gammas[g], left);
    }
    tree_clear(&t);
}

void newton_near_balance(const tree *t, const tree_def *def, double time, double *y)
{
    size_t n = t->domain->n;
    double *work = calloc(lac_problem_work(t->problem), sizeof *work);
    double v[64];
    double traction[64];
    for (size_t k = 0; k < n; k++) {
        y[2 * n + k] = 1e-9 * (double)(k % 7);
    }
    lac_problem_rates(t->problem, time, y, v, work);
    lac_problem_traction(t->problem, time, y + 2 * n, traction, work);
    for (size_t k = 0; k < n; k++) {
        traction[k] -= lac_problem_cohesion(t->problem, k);
        double u = lac_friction_rate_for(t->friction, k, y[n + k], fabs(traction[k]),
                                         t->domain->pressure[k], def->damping);
        double off = 0.2 * def->columns * (lac_random_uniform(8, LAC_STREAM_TEST, k, 0) - 0.5);
        assert_true(isfinite(u));
        y[k] += u + off - log(v[k]);
        y[k] *= traction[k] < 0.0 ? -1.0 : 1.0;
    }
    free(work);
}
