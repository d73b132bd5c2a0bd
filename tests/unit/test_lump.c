// SPDX-License-Identifier: GPL-3.0-or-later
// Few cells that stand for all: the quadrature, the tree of weighted classes, and runs of lumped
// scenes against those of all cells.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/cubature.h"
#include "simulation/lumped.h"
#include "support/test.h"

enum { POINTS = 3000, FUNCTIONS = 15, NODES = 9, LEAVES = 5 };

// Products of two variables up to degree 4, at points of a Weyl sequence.
static void values(const void *context, size_t point, double *value)
{
    (void)context;
    const double x = fmod(0.7548776662466927 * (double)(point + 1), 1.0) * 2.0 - 1.0;
    const double y = fmod(0.5698402909980532 * (double)(point + 1), 1.0) * 2.0 - 1.0;
    double px = 1.0;
    for (int i = 0; i <= 4; i++, px *= x) {
        double py = 1.0;
        for (int j = 0; i + j <= 4; j++, py *= y) {
            *value++ = px * py;
        }
    }
}

// At most as many points as functions stay, with weights > 0, and every sum is kept.
static void test_cubature(void **state)
{
    (void)state;
    static uint32_t kept[POINTS];
    static double weight[POINTS];
    const lac_cubature of = {.points = POINTS, .functions = FUNCTIONS, .at = values};
    double all[FUNCTIONS] = {0.0}, few[FUNCTIONS] = {0.0}, value[FUNCTIONS];
    size_t count = 0;
    assert_int_equal(lac_cubature_thin(&of, kept, weight, &count, NULL), LAC_OK);
    assert_true(count <= FUNCTIONS);
    for (size_t i = 0; i < POINTS; i++) {
        values(NULL, i, value);
        for (size_t j = 0; j < FUNCTIONS; j++) {
            all[j] += value[j];
        }
    }
    for (size_t i = 0; i < count; i++) {
        assert_true(weight[i] > 0.0);
        assert_true(i == 0 || kept[i] > kept[i - 1]);
        values(NULL, kept[i], value);
        for (size_t j = 0; j < FUNCTIONS; j++) {
            few[j] += weight[i] * value[j];
        }
    }
    for (size_t j = 0; j < FUNCTIONS; j++) {
        assert_true(fabs(few[j] - all[j]) < 1e-9 * POINTS);
    }
}

// Of fewer points than functions all stay as they are.
static void test_few_points(void **state)
{
    (void)state;
    uint32_t kept[FUNCTIONS];
    double weight[FUNCTIONS];
    const lac_cubature of = {.points = 7, .functions = FUNCTIONS, .at = values};
    size_t count = 0;
    assert_int_equal(lac_cubature_thin(&of, kept, weight, &count, NULL), LAC_OK);
    assert_int_equal(count, 7);
    for (size_t i = 0; i < count; i++) {
        assert_true(kept[i] == i && weight[i] == 1.0);
    }
}

// Five leaves, two of them in a block of their own, three in another:   8 = (6 = (0 1), 7 = (2 3
// 4))
static lac_classes *five_leaves(double k_inner)
{
    static const uint32_t parent[NODES] = {6, 6, 7, 7, 7, 0, 8, 8, 8};
    static const double weight[NODES] = {2.5, 1.0, 0.3, 4.0, 2.2, 0.0, 3.5, 6.5, 10.0};
    lac_classes *classes = NULL;
    assert_int_equal(lac_classes_create(LEAVES, NODES - 1, &classes, NULL), LAC_OK);
    for (size_t i = 0, c = 0; i < NODES; i++) {
        if (i == LEAVES) {
            continue; // no such node
        }
        classes->parent[c] = parent[i] > LEAVES ? parent[i] - 1 : parent[i];
        classes->weight[c] = weight[i];
        classes->k[c++] = i == 6 ? k_inner : i == 7 ? 0.5 * k_inner : i == 8 ? 3.0 : 0.0;
    }
    return classes;
}

// (D + K + k_mean mean) x gives back what x was solved for, also where the ties are rigid.
static void test_solve(void **state)
{
    (void)state;
    const double diagonal[LEAVES] = {1.0, 2.0, 0.5, 3.0, -0.1}, y[LEAVES] = {1, -2, 3, 0.5, 4};
    for (double k = 1.0; k < 1e16; k *= 1e3) {
        lac_classes *classes = five_leaves(k);
        double x[LEAVES], force[LEAVES], work[4 * NODES], mean = 0.0;
        const double k_mean = 0.7;
        assert_true(lac_classes_solve(classes, k_mean, diagonal, y, x, work));
        lac_classes_apply(classes, x, force, work);
        double off = 0.0, sum = 0.0;
        for (size_t i = 0; i < LEAVES; i++) {
            mean += classes->weight[i] * x[i] / 10.0;
            sum += classes->weight[i] * force[i];
        }
        for (size_t i = 0; i < LEAVES; i++) {
            off = fmax(off, fabs(diagonal[i] * x[i] + force[i] + k_mean * mean - y[i]));
        }
        assert_true(off < 1e-14 * fmax(k, 1.0) * 40.0); // rounding of k times differences
        assert_true(fabs(sum) < 1e-13 * fmax(k, 1.0) * 40.0);
        // the balance of all, which no tie touches
        double all = 0.0;
        for (size_t i = 0; i < LEAVES; i++) {
            all += classes->weight[i] * (diagonal[i] * x[i] + k_mean * mean - y[i]);
        }
        assert_true(fabs(all) < 1e-11);
        lac_classes_free(classes);
    }
}

// A dense matrix of the same, column by column: K is symmetric by weight, and its row sums are 0.
static void test_dense(void **state)
{
    (void)state;
    lac_classes *classes = five_leaves(7.0);
    double matrix[LEAVES][LEAVES], work[4 * NODES], unit[LEAVES], force[LEAVES];
    for (size_t j = 0; j < LEAVES; j++) {
        memset(unit, 0, sizeof unit);
        unit[j] = 1.0;
        lac_classes_apply(classes, unit, force, work);
        for (size_t i = 0; i < LEAVES; i++) {
            matrix[i][j] = force[i];
        }
    }
    for (size_t i = 0; i < LEAVES; i++) {
        double row = 0.0;
        for (size_t j = 0; j < LEAVES; j++) {
            row += matrix[i][j];
            assert_true(fabs(classes->weight[i] * matrix[i][j] -
                             classes->weight[j] * matrix[j][i]) < 1e-14);
        }
        assert_true(fabs(row) < 1e-14);
    }
    // two leaves of one block: k_inner times how far each is from their mean, and the block's share
    assert_true(fabs(matrix[0][1] - (-7.0 / 3.5 + 3.0 * (1.0 / 3.5 - 0.1))) < 1e-14);
    lac_classes_free(classes);
}

static const char scene_text[] = "lacuna: 1\n"
                                 "interface: {size: 64 m, levels: 5, DOMAIN}\n"
                                 "load: {normal: {pressure: 3 MPa}LOADS}\n"
                                 "friction:\n"
                                 "  LAW: {f0: 0.6, a: 0.010, b: 0.015, dc: 1 mm, v0: 1 um/s}\n"
                                 "  spread: {dc: {lognormal: {sigma: 0.5, seed: 2}}SPREAD}\n"
                                 "initial: {slip_rate: 1 cm/day, state: {ratio_to_steady: 0.6}}\n"
                                 "transfer: {hierarchy: {k0: K0, ratio: 0.5}}\n"
                                 "time: {end: 200 day}\n"
                                 "solver: {fidelity: lumped, rtol: 1e-8NODES}\n";

typedef struct scene_def {
    const char *domain, *loads, *law, *spread, *k0, *nodes;
} scene_def;

static lac_case *read_scene(const scene_def *def)
{
    const struct {
        const char *word, *by;
    } words[] = {{"DOMAIN", def->domain}, {"LOADS", def->loads}, {"LAW", def->law},
                 {"SPREAD", def->spread}, {"K0", def->k0},       {"NODES", def->nodes}};
    char text[2048];
    (void)snprintf(text, sizeof text, "%s", scene_text);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char rest[2048];
        char *at = strstr(text, words[i].word);
        assert_non_null(at);
        (void)snprintf(rest, sizeof rest, "%s", at + strlen(words[i].word));
        (void)snprintf(at, sizeof text - (size_t)(at - text), "%s%s", words[i].by, rest);
    }
    lac_case *c = NULL;
    lac_case_issues report = {0};
    if (lac_case_read_text("lump.yaml", text, strlen(text), NULL, &c, &report, NULL) != LAC_OK) {
        fail_msg("%s: %s\n%s", report.issue[0].key, report.issue[0].message, text);
    }
    lac_case_issues_clear(&report);
    return c;
}

// Time of failure of all cells, or of the few that stand for them, and what it is estimated off by.
static double failure_of(const lac_case *c, bool lumped, double *error, size_t *cells)
{
    lac_case own = *c;
    lac_simulation *simulation = NULL;
    lac_error err = {""};
    own.run.fidelity = lumped ? LAC_FIDELITY_LUMPED : LAC_FIDELITY_ODE;
    if (lac_simulation_create(&own, NULL, &simulation, &err) != LAC_OK ||
        lac_simulation_run(simulation, NULL, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    const lac_run_result *result = lac_simulation_result(simulation);
    const lac_lump *lump = lac_simulation_outcome(simulation)->scene->lump;
    assert_true(result->failed);
    assert_true((lump != NULL) == lumped);
    const double time = result->failure_origin + result->failure_local;
    *error = result->lump_error_estimated;
    *cells = lump != NULL ? lump->domain->n : 0;
    lac_simulation_free(simulation);
    return time;
}

// Scenes of several laws and loads: the error is within what the run says and not far below it, and
// few cells do.
static void test_runs(void **state)
{
    (void)state;
    static const struct {
        scene_def def;
        double most; // error, relative
        size_t cells;
    } scenes[] = {
        {{"domain: {full: {}}", "", "aging", "", "1e12", ", lump: {level: 5}"}, 2e-5, 40},
        {{"domain: {full: {}}", "", "aging", "", "1e12",
          ", lump: {nodes: 20, level: 5, error: 0.5}"},
         2e-2,
         20},
        {{"domain: {full: {}}", "", "aging", "", "1e9", ""}, 3e-4, 100},
        {{"domain: {cascade: {dimension: 1.7, seed: 3}}", ", shear: [{ramp: {rate: 1 Pa/s}}]",
          "slip", ", a: {uniform: {half_width: 0.1, seed: 5}}", "3e10", ""},
         1e-3,
         200},
        {{"domain: {full: {}}", ", pore_pressure: [{step: {value: 10 kPa, at: 1 hour}}]", "aging",
          ", f0: {normal: {sigma: 0.01, seed: 4}}", "3e10", ""},
         1e-3,
         100},
    };
    for (size_t i = 0; i < test_some(sizeof scenes / sizeof *scenes); i++) {
        lac_case *c = read_scene(&scenes[i].def);
        double estimated, none;
        size_t cells, all;
        const double few = failure_of(c, true, &estimated, &cells);
        const double whole = failure_of(c, false, &none, &all);
        const double error = fabs(few / whole - 1.0);
        if (error > estimated || estimated > 10.0 * fmax(error, 1e-5) || error > scenes[i].most ||
            cells > scenes[i].cells) {
            fail_msg("scene %zu: error %g, estimated %g, most %g, %zu cells", i, error, estimated,
                     scenes[i].most, cells);
        }
        assert_true(none == 0.0);
        lac_case_free(c);
    }
}

// A small error is kept by leaves that are tied as tightly as all cells are, not by more leaves.
static void test_ties(void **state)
{
    (void)state;
    const scene_def def = {
        "domain: {full: {}}", "", "slip", ", f0: {normal: {sigma: 0.01, seed: 4}}", "1e9", ""};
    lac_case *c = read_scene(&def);
    double estimated, rough, none;
    size_t cells, all;
    const double whole = failure_of(c, false, &none, &all);
    const double before = fabs(failure_of(c, true, &rough, &cells) / whole - 1.0);
    c->lump.error = 3e-4;
    const double after = fabs(failure_of(c, true, &estimated, &cells) / whole - 1.0);
    if (after > 0.1 * before || after > estimated || estimated > 0.5 * rough || cells > 50) {
        fail_msg("error %g, then %g, estimated %g, then %g, %zu cells", before, after, rough,
                 estimated, cells);
    }
    lac_case_free(c);
}

// Cells that slip one by one: refused before anything is computed in time.
static void test_one_by_one(void **state)
{
    (void)state;
    const scene_def def = {"domain: {full: {}}", "", "aging", "", "2e7", ""};
    lac_case *c = read_scene(&def);
    lac_simulation *simulation = NULL;
    lac_error err = {""};
    assert_int_equal(lac_simulation_create(c, NULL, &simulation, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "k_0/k_crit is"));
    lac_simulation_free(simulation);
    lac_case_free(c);
}

// A level too coarse for what it is to keep: the run says so, and has no time.
static void test_too_soft(void **state)
{
    (void)state;
    const scene_def def = {"domain: {full: {}}", "", "aging", "", "1e8", ", lump: {level: 5}"};
    lac_case *c = read_scene(&def);
    lac_simulation *simulation = NULL;
    lac_error err = {""};
    assert_int_equal(lac_simulation_create(c, NULL, &simulation, &err), LAC_OK);
    assert_int_equal(lac_simulation_run(simulation, NULL, &err), LAC_ENUMERIC);
    assert_non_null(strstr(err.message, "solver.fidelity lumped"));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    assert_string_equal(of->status, "failed");
    assert_true(!of->run.failed && isnan(of->run.failure_local));
    assert_true(of->run.lump_error_estimated > 0.01);
    lac_simulation_free(simulation);
    lac_case_free(c);
}

// Level 0: every cell by itself, as without lumping.
static void test_no_blocks(void **state)
{
    (void)state;
    const scene_def def = {"domain: {full: {}}", "", "aging", "", "1e10", ", lump: {level: 0}"};
    lac_case *c = read_scene(&def);
    double estimated, none;
    size_t cells, all;
    const double few = failure_of(c, true, &estimated, &cells);
    assert_int_equal(cells, 1024);
    assert_true(fabs(few / failure_of(c, false, &none, &all) - 1.0) < 1e-9);
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cubature),   cmocka_unit_test(test_few_points),
        cmocka_unit_test(test_solve),      cmocka_unit_test(test_dense),
        cmocka_unit_test(test_runs),       cmocka_unit_test(test_ties),
        cmocka_unit_test(test_one_by_one), cmocka_unit_test(test_too_soft),
        cmocka_unit_test(test_no_blocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
