// SPDX-License-Identifier: GPL-3.0-or-later
// The exact Newton solve of the creep problem against a dense solve with a Jacobian by finite
// differences, for every friction law, form and formulation, with and without cut-offs and the
// response to normal stress, under every kind of load, one by one and all at once, for cells that
// slide backwards, for those that carry the mass of a block, and for slip in two directions, each
// cell in its own.
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>
#include <math.h>

#include "base/rng.h"
#include "support/slot.h"
#include "support/test.h"
#include "support/tree.h"

// What pulls at the cells.
typedef enum pull_kind { BY_RATIO = 1, BY_FORCE = 2, BY_SPRING = 4, BY_PORE = 8 } pull_kind;

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

static const lac_load_kind pull_row = {.info = {.name = "pull"}, .add = pull};
static const int pulls[] = {0, BY_RATIO, BY_FORCE, BY_SPRING, BY_PORE, 15};
static const lac_formulation formulations[] = {LAC_FORMULATION_RATE, LAC_FORMULATION_TRACTION,
                                               LAC_FORMULATION_SLIP};

#define EXACT 1e-6 // but for the differences that J is made of

// Damping: none; of the mean so weak that the solve leaves it out, its error then a thousandth; so
// strong that it holds as much as friction.
static const struct {
    double times, left;
} dampings[] = {{0.0, EXACT}, {1.0, 1e-3}, {1e7, EXACT}};

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

// @param left  of the largest component, that the solve may be off by
static void check_solve(const lac_problem *problem, const double *y, double t, double gamma,
                        double left)
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

// A tree of few cells for one law and form.
static tree_def small(const lac_friction_law *law, int form, uint64_t seed)
{
    tree_def def = tree_default(3, seed);
    def.law = law->info.name;
    def.form = form;
    def.keep = 0.4;
    def.ratio = 0.7;
    def.state = 4e3;
    return def;
}

// What a case may add to a law: cut-offs where the cells slide, and the response to normal stress.
static void add_all(tree_def *def)
{
    def->v1 = 1e-9;
    def->v2 = 2e-9;
    def->alpha = 0.3;
}

static void check_tree(const tree_def *def, bool damped, double left)
{
    const double gammas[] = {1e-3, 1.0, 1e2, 1e3};
    const size_t steps = def->v1 > 0 || damped ? 3 : 4; // the longest is too long then
    tree t;
    tree_create(def, &t);
    double y[128];
    lac_problem_initial(t.problem, y);
    for (size_t g = 0; g < steps; g++) {
        check_solve(t.problem, y, 5.0, gammas[g], left);
    }
    tree_clear(&t);
}

static void newton_solve_is_exact(void **state)
{
    (void)state;
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_get(l)) != NULL; l++) {
        for (uint64_t i = 0; i < 2 * 3 * 6 * 3; i++) {
            tree_def def = small(law, (int)(i % 2), 1 + i % 4);
            lac_load load = {.kind = &pull_row, .params = &pulls[i / 6 % 6]};
            def.formulation = formulations[i / 2 % 3];
            def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
            double times = dampings[i / 36].times;
            def.damping *= times;
            check_tree(&def, times > 1.0, dampings[i / 36].left);
            add_all(&def);
            check_tree(&def, times > 1.0, dampings[i / 36].left);
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
            tree_def def = small(law, LAC_FORM_REGULARISED, 1 + s);
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
            check_solve(t.problem, y, 0.0, 10.0, EXACT);
            tree_clear(&t);
        }
    }
}

// Puts every cell of a block with mass up to a tenth of an e-fold off the rate that balances it.
static void put_near_balance(const tree *t, const tree_def *def, double time, double *y)
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
        tree_def def = small(lac_friction_law_get(0), i % 3 > 0, 1 + i % 4);
        lac_load load = {.kind = &pull_row, .params = back ? &pulls[1] : &with};
        def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
        def.mass = masses[i / 3 % 3];
        def.columns = parts[i / 9];
        double time = back ? -1.27e5 : 5.0;
        double y[192];
        tree t;
        tree_create(&def, &t);
        lac_problem_initial(t.problem, y);
        put_near_balance(&t, &def, time, y);
        assert_true(back == (y[0] < 0.0) || def.form == LAC_FORM_PLAIN);
        for (double gamma = 1e-3; gamma < 20.0; gamma *= 10.0) {
            check_solve(t.problem, y, time, gamma, EXACT);
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
    for (uint64_t i = 0; i < 2 * 4 * 3; i++) {
        tree_def def = small(lac_friction_law_get(i % 3), (int)(i % 2), 1 + i % 4);
        lac_load load = {.kind = &pull_row, .params = &with[i / 2 % 4], .azimuth = 0.3 * (double)i};
        def.keep = 0.7;
        def.formulation = LAC_FORMULATION_VECTOR;
        def.heading = 0.7 * (double)i;
        def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
        def.damping *= dampings[i / 8].times;
        double y[192];
        tree t;
        tree_create(&def, &t);
        assert_true(t.domain->n > 4 && t.domain->n <= 64);
        lac_problem_initial(t.problem, y);
        scatter(&t, 5.0, y);
        for (double gamma = 1e-3; gamma < 20.0; gamma *= 10.0) {
            check_solve(t.problem, y, 5.0, gamma, dampings[i / 8].left);
        }
        tree_clear(&t);
    }
}

// Mechanisms of weakening in the middle of their ranges, in numbers that act on cells at 50 MPa.
static void choose_weakening(lac_model models[LAC_MOST_WEAKENINGS])
{
    static const struct {
        const char *key;
        double value;
    } numbers[] = {{"rate", 1e-3},
                   {"stress", 4e7},
                   {"exponent", 12},
                   {"dilatancy", 1e-3},
                   {"compressibility", 1e-10},
                   {"drainage_time", 30},
                   {"thickness", 1e-3},
                   {"pressurization", 1e9},
                   {"hydraulic_diffusivity", 3e-6}};
    for (size_t k = 0; lac_weakening_get(k) != NULL; k++) {
        assert_true(k < LAC_MOST_WEAKENINGS);
        assert_int_equal(lac_model_create(&lac_weakening_get(k)->info, &models[k], NULL), LAC_OK);
        for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
            if (lac_param_find(models[k].info->params, models[k].info->param_count,
                               numbers[i].key) != NULL) {
                test_slot_set(&models[k], numbers[i].key, numbers[i].value);
            }
        }
    }
}

// Unknowns that have taken up to a tenth of the pressure and broken bridges, of some cells all.
// @param part  of that
static void weaken(const tree *t, const lac_weakening_set *set, double part, double *y)
{
    const size_t n = t->domain->n;
    double *x = y + lac_problem_unknowns(t->problem) - set->modes * n;
    for (size_t k = 0; k < set->count; k++) {
        const lac_weakening_modes *modes = &set->item[k].modes;
        for (size_t j = 0; j < modes->n * n; j++, x++) {
            double random = lac_random_uniform(9, LAC_STREAM_TEST, j, k);
            *x = part * (set->item[k].kind->pore ? 1e6 * (random - 0.3) / (double)modes->n
                                                 : (random > 0.7 ? 1.2 : random));
        }
    }
}

static void check_weakened(tree_def *def, const lac_weakening_set *set)
{
    tree t;
    def->weakening = set;
    tree_create(def, &t);
    double *y = malloc(lac_problem_unknowns(t.problem) * sizeof *y);
    lac_problem_initial(t.problem, y);
    if (def->mass > 0.0) {
        put_near_balance(&t, def, 5.0, y);
    }
    weaken(&t, set, def->mass > 0.0 ? 0.01 : 1.0, y); // near balance, with a mass
    for (double gamma = 1e-3; gamma < (def->mass > 0.0 ? 20.0 : 200.0); gamma *= 10.0) {
        check_solve(t.problem, y, 5.0, gamma, EXACT);
    }
    free(y);
    tree_clear(&t);
}

// Each mechanism by itself, and all together, in every formulation.
static void newton_solve_is_exact_with_weakening(void **state)
{
    (void)state;
    lac_model models[LAC_MOST_WEAKENINGS];
    choose_weakening(models);
    for (size_t i = 0; i < 2 * 4 * (LAC_MOST_WEAKENINGS + 1); i++) {
        const size_t k = i / 8;
        const bool all = k == LAC_MOST_WEAKENINGS;
        lac_weakening_set set;
        assert_int_equal(lac_weakening_set_create(all ? models : &models[k],
                                                  all ? LAC_MOST_WEAKENINGS : 1, &set, NULL),
                         LAC_OK);
        tree_def def = small(lac_friction_law_get(i % 2), (int)(i / 2 % 2), 1);
        const bool massive = i % 8 / 2 == 3;
        const int with = BY_RATIO | (massive ? BY_SPRING : BY_PORE);
        lac_load load = {.kind = &pull_row, .params = &with};
        def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
        def.levels = 2;
        def.keep = 0.8;
        def.cohesion = 1e6;
        def.damping = 0.0;
        def.mass = massive ? 1e3 : 0.0;
        def.columns = 0.5;
        def.formulation = massive ? LAC_FORMULATION_INERTIA : formulations[i % 8 / 2];
        check_weakened(&def, &set);
    }
    for (size_t k = 0; k < LAC_MOST_WEAKENINGS; k++) {
        lac_model_clear(&models[k]);
    }
}

// What a base that bends does to cells within a step's slip: it falls, or rises, and thins.
static const lac_geometry_def bases[] = {
    {.angles = 1, .angle = {0.5}, .radius = 2e-4},
    {.angles = 1, .angle = {0.5}, .radius = 1e-2},
    {.nodes = 3,
     .angles = 3,
     .thicknesses = 3,
     .slip = {-1e-3, 1e-5, 1e-3},
     .angle = {0.7, 0.5, -0.1},
     .thickness = {20.0, 30.0, 80.0},
     .radius = NAN},
    {.nodes = 2,
     .angles = 1,
     .thicknesses = 2,
     .slip = {-1e-4, 1e-4},
     .angle = {0.5},
     .thickness = {20.0, 60.0},
     .radius = NAN},
};

// A lake that covers a part of what lies on them.
static void flood(const lac_load *load, double t, lac_load_state *sum)
{
    (void)load, (void)t;
    sum->lake = (lac_lake){.level = 15.0, .foot = 1.0, .unit_weight = 1e5, .angle = NAN};
}

static const lac_load_kind lake_row = {.info = {.name = "lake"}, .add = flood};

static void lay(const lac_geometry_def *base, lac_load_set *loads)
{
    loads->length = 40.0;
    lac_error err = {""};
    assert_int_equal(lac_geometry_create(base, &loads->geometry, &err), LAC_OK);
}

// Friction that differs from cell to cell too, so that no two of them feel the base alike.
static void newton_solve_is_exact_on_a_bent_base(void **state)
{
    (void)state;
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_get(l)) != NULL; l++) {
        for (uint64_t i = 0; i < 2 * 4 * 3; i++) {
            tree_def def = small(law, (int)(i % 2), 1 + i % 4);
            lac_load load[] = {{.kind = &pull_row, .params = &pulls[i % 6]}, {.kind = &lake_row}};
            def.formulation = LAC_FORMULATION_SLIP;
            // the second half of the bases have a thickness
            def.loads = (lac_load_set){.load = load, .count = 1 + i / 4 % 2, .shear = 1};
            lay(&bases[i / 2 % 4], &def.loads);
            def.damping *= dampings[i / 8].times;
            check_tree(&def, true, dampings[i / 8].left);
            lac_geometry_free(def.loads.geometry);
        }
    }
}

// And what presses a block that slides round a bend, here by as much as its weight.
static void newton_solve_is_exact_round_a_bend(void **state)
{
    (void)state;
    const double parts[] = {0.01, 1.0};
    for (uint64_t i = 0; i < 2 * 4 * 2; i++) {
        tree_def def = small(lac_friction_law_get(0), (int)(i % 2), 1 + i % 4);
        lay(&bases[i / 2 % 4], &def.loads);
        def.slip_rate = 1e-2;
        def.state = 4e-4;
        def.mass = 1e9;
        def.columns = parts[i / 8];
        double y[192];
        tree t;
        tree_create(&def, &t);
        lac_problem_initial(t.problem, y);
        put_near_balance(&t, &def, 0.0, y);
        for (double gamma = 1e-6; gamma < 2e-2; gamma *= 10.0) {
            check_solve(t.problem, y, 0.0, gamma, EXACT);
        }
        tree_clear(&t);
        lac_geometry_free(def.loads.geometry);
    }
}

// A step longer than a weakening cell allows is refused, not solved wrongly.
static void too_long_a_step_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        tree_def def = tree_default(2, 1);
        def.formulation = formulations[i];
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
        cmocka_unit_test(newton_solve_is_exact_with_weakening),
        cmocka_unit_test(newton_solve_is_exact_on_a_bent_base),
        cmocka_unit_test(newton_solve_is_exact_round_a_bend),
        cmocka_unit_test(too_long_a_step_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
