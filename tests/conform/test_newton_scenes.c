// SPDX-License-Identifier: GPL-3.0-or-later
// The exact Newton solve with what a scene adds to the cells' own balance: mechanisms of weakening,
// one by one and together, and a base that bends, with a lake at its toe and with mass.
#include <stdlib.h>

#include <math.h>

#include "base/rng.h"
#include "support/newton.h"
#include "support/slot.h"
#include "support/test.h"

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
        newton_near_balance(&t, def, 5.0, y);
    }
    weaken(&t, set, def->mass > 0.0 ? 0.01 : 1.0, y); // near balance, with a mass
    for (double gamma = 1e-3; gamma < (def->mass > 0.0 ? 20.0 : 200.0); gamma *= 10.0) {
        newton_check(t.problem, y, 5.0, gamma, NEWTON_EXACT);
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
        tree_def def = newton_tree(lac_friction_law_get(i % 2), (int)(i / 2 % 2), 1);
        const bool massive = i % 8 / 2 == 3;
        const int with = BY_RATIO | (massive ? BY_SPRING : BY_PORE);
        lac_load load = {.kind = &newton_pull, .params = &with};
        def.loads = (lac_load_set){.load = &load, .count = 1, .shear = 1};
        def.levels = 2;
        def.keep = 0.8;
        def.cohesion = 1e6;
        def.damping = 0.0;
        def.mass = massive ? 1e3 : 0.0;
        def.columns = 0.5;
        def.formulation = massive ? LAC_FORMULATION_INERTIA : newton_formulations[i % 8 / 2];
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
            tree_def def = newton_tree(law, (int)(i % 2), 1 + i % 4);
            lac_load load[] = {{.kind = &newton_pull, .params = &newton_pulls[i % 6]},
                               {.kind = &lake_row}};
            def.formulation = LAC_FORMULATION_SLIP;
            // the second half of the bases have a thickness
            def.loads = (lac_load_set){.load = load, .count = 1 + i / 4 % 2, .shear = 1};
            lay(&bases[i / 2 % 4], &def.loads);
            def.damping *= newton_dampings[i / 8].times;
            newton_check_tree(&def, true, newton_dampings[i / 8].left);
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
        tree_def def = newton_tree(lac_friction_law_get(0), (int)(i % 2), 1 + i % 4);
        lay(&bases[i / 2 % 4], &def.loads);
        def.slip_rate = 1e-2;
        def.state = 4e-4;
        def.mass = 1e9;
        def.columns = parts[i / 8];
        double y[192];
        tree t;
        tree_create(&def, &t);
        lac_problem_initial(t.problem, y);
        newton_near_balance(&t, &def, 0.0, y);
        for (double gamma = 1e-6; gamma < 2e-2; gamma *= 10.0) {
            newton_check(t.problem, y, 0.0, gamma, NEWTON_EXACT);
        }
        tree_clear(&t);
        lac_geometry_free(def.loads.geometry);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(newton_solve_is_exact_with_weakening),
        cmocka_unit_test(newton_solve_is_exact_on_a_bent_base),
        cmocka_unit_test(newton_solve_is_exact_round_a_bend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
