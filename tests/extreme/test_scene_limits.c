// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of extreme make: pressures, stiffness, number of cells, shape of the tree. Under a load
// that all cells share in proportion to their pressure, undamped, cells that start alike stay alike
// whatever ties them: the scene is one block, and support/one_cell.h tells its time exactly.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <sys/resource.h>

#include "base/rng.h"
#include "support/one_cell.h"
#include "support/slot.h"
#include "support/test.h"
#include "support/tree.h"
#include "support/trees.h"

#if defined(__SANITIZE_ADDRESS__)
enum { SANITIZED = 1 };
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif
#else
enum { SANITIZED = 0 };
#endif

static const lac_method methods[] = {LAC_BDF, LAC_ADAMS, LAC_ERK};
static const char *const method_names[] = {"bdf", "adams", "erk"};

// What a scene is made of.
typedef struct scene_def {
    size_t side;
    double (*pressure)(size_t place); // [Pa]; 0: no contact
    double k0, ratio;
    double spread; // ln v at the start is within this of ln slip_rate
    double slip_rate, state;
    lac_formulation formulation;
} scene_def;

typedef struct scene {
    tree parts;
    double *start; // ln v, ln theta
} scene;

static void scene_create(const scene_def *def, scene *s)
{
    lac_error err = {""};
    tree *t = &s->parts;
    *s = (scene){0};
    lac_grid grid = {.nx = def->side, .ny = def->side, .dx = 1.0, .dy = 1.0, .periodic = true};
    double *pressure = new_doubles(def->side * def->side);
    for (size_t i = 0; i < def->side * def->side; i++) {
        pressure[i] = def->pressure(i);
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &t->domain, &err), LAC_OK);
    free(pressure);
    t->hierarchy = hierarchy_of(t->domain);
    tree_def law = tree_default(0, 1);
    law.k0 = def->k0;
    law.ratio = def->ratio;
    tree_make_transfer(&law, t);
    tree_make_friction(&law, t);
    size_t n = t->domain->n;
    s->start = new_doubles(2 * n);
    for (size_t i = 0; i < n; i++) {
        double off = 2.0 * lac_random_uniform(5, LAC_STREAM_TEST, i, 0) - 1.0;
        s->start[i] = log(def->slip_rate) + def->spread * off;
        s->start[n + i] = log(def->state);
    }
    lac_problem_def problem = {.domain = t->domain,
                               .friction = t->friction,
                               .transfer = &t->transfer,
                               .log_rate = s->start,
                               .log_state = s->start + n,
                               .formulation = def->formulation};
    assert_int_equal(lac_problem_create(&problem, &t->problem, &err), LAC_OK);
}

static void scene_free(scene *s)
{
    tree_clear(&s->parts);
    free(s->start);
}

// The block that the scene is where its cells move as one from slip rate v.
static block_def as_one(const scene_def *def, double v)
{
    tree_def law = tree_default(0, 1);
    block_def one = block_default(law.b / law.a, 0.5);
    one.dc = law.dc;
    one.slip_rate = v;
    one.theta = def->state;
    return one;
}

static scene_def scene_default(void **state)
{
    return (scene_def){
        .side = 2, .ratio = 0.5, .slip_rate = 1e-9, .state = 2e4, .formulation = chosen(state)};
}

static lac_run_def to_rate(lac_method method, double rate, double rtol)
{
    lac_run_def how = lac_run_default();
    how.method = method;
    how.rtol = rtol;
    how.end = 1e12;
    how.failure_rate = rate;
    how.max_steps = 5000;
    return how;
}

// Stiff ties need a stiff method, and more digits than a double has where slip is the unknown.
static bool may_run_out(const scene_def *def, lac_method method)
{
    return method != LAC_BDF || def->formulation == LAC_FORMULATION_SLIP;
}

// The error of the time of failure; NaN where the run ended with an error, which it prints.
static double error_of(const scene_def *def, lac_method method, double exact)
{
    scene s;
    scene_create(def, &s);
    lac_run_def how = to_rate(method, 1.0, 1e-8);
    one_cell_outcome out = watched_run(s.parts.problem, &how);
    scene_free(&s);
    assert_true(out.finite);
    if (out.status != LAC_OK) {
        printf("%s, %s: %s\n", lac_formulation_name(def->formulation), method_names[method],
               out.message);
        assert_non_null(strstr(out.message, "t = "));
        return NAN;
    }
    assert_true(out.result.failed);
    return fabs((out.result.failure_origin + out.result.failure_local) / exact - 1.0);
}

static void compare(const scene_def *def, const char *what, bool stiff, double most)
{
    block_def one = as_one(def, def->slip_rate);
    double exact = one_cell_time(&one, 1.0);
    for (size_t i = 0; i < 3; i++) {
        double error = error_of(def, methods[i], exact);
        printf("%-30s %-9s %-5s %.1e\n", what, lac_formulation_name(def->formulation),
               method_names[i], error);
        assert_true(error <= most || (isnan(error) && stiff && may_run_out(def, methods[i])));
    }
}

// p (b - a)/dc at 50 MPa [Pa/m]
static const double critical = 50e6 * 0.005 / 1e-5;

static double common_pressure(size_t place)
{
    (void)place;
    return 50e6;
}

static double first_two(size_t place) { return place < 2 ? 50e6 : 0.0; }
static double first_alone(size_t place) { return place == 0 ? 50e6 : 0.0; }

static void few_cells(void **state)
{
    scene_def def = scene_default(state);
    def.k0 = critical;
    def.pressure = common_pressure;
    compare(&def, "n = 4", false, 1e-6);
    def.pressure = first_two;
    compare(&def, "n = 2", false, 1e-6);
    def.pressure = first_alone;
    compare(&def, "n = 1", false, 1e-6);
}

static void full_contact(void **state)
{
    scene_def def = scene_default(state);
    def.side = 16;
    def.pressure = common_pressure;
    def.k0 = critical;
    compare(&def, "full contact, 16 x 16", false, 1e-6);
}

// One cell, and a cell in each of two opposite corners: chains of ten blocks with a single child.
static double alone(size_t place) { return place == 777u * 1024 + 333 ? 50e6 : 0.0; }
static double corners(size_t place) { return place == 0 || place == 1024u * 1024 - 1 ? 50e6 : 0.0; }

static void one_cell_of_a_million(void **state)
{
    scene_def def = scene_default(state);
    def.side = 1024;
    def.k0 = critical;
    def.pressure = alone;
    compare(&def, "one cell of 1024 x 1024", false, 1e-6);
}

// Two cells that meet at the root alone are those of a grid of 2 x 2 with the root's stiffness.
static void a_chain_of_single_children(void **state)
{
    scene_def far = scene_default(state);
    far.side = 1024;
    far.pressure = corners;
    far.k0 = 20.0 * critical * 512.0;
    far.spread = 0.5;
    scene_def near = far;
    near.side = 2;
    near.pressure = first_two;
    near.k0 = 20.0 * critical;
    for (size_t i = 0; i < 3; i++) {
        double time[2];
        for (int k = 0; k < 2; k++) {
            scene s;
            scene_create(k == 0 ? &far : &near, &s);
            lac_run_def how = to_rate(methods[i], 1.0, 1e-8);
            one_cell_outcome out = watched_run(s.parts.problem, &how);
            assert_int_equal(out.status, LAC_OK);
            assert_true(out.finite && out.result.failed);
            time[k] = out.result.failure_origin + out.result.failure_local;
            scene_free(&s);
        }
        assert_true(fabs(time[0] / time[1] - 1.0) < 1e-9);
    }
}

// 1e-4 ... 1e8 Pa in one scene of 8 x 8 cells.
static double twelve_decades(size_t place) { return pow(10.0, -4.0 + 12.0 * (double)place / 63.0); }

static void pressures(void **state)
{
    scene_def def = scene_default(state);
    def.side = 8;
    def.pressure = twelve_decades;
    compare(&def, "pressures 1e-4 ... 1e8, k = 0", false, 1e-6);
    def.k0 = critical;
    compare(&def, "pressures 1e-4 ... 1e8, k > 0", true, 1e-6);
}

// Tied without end, cells that start apart move as one from exp of the mean of p ln v on.
static double tied_time(const scene_def *def)
{
    scene s;
    scene_create(def, &s);
    const lac_domain *domain = s.parts.domain;
    double sum = 0.0, weighted = 0.0;
    for (size_t i = 0; i < domain->n; i++) {
        sum += domain->pressure[i];
        weighted += domain->pressure[i] * s.start[i];
    }
    scene_free(&s);
    block_def one = as_one(def, exp(weighted / sum));
    return one_cell_time(&one, 1.0);
}

static double mixed(size_t place) { return 50e6 * (1.0 + (double)(place % 7)) / 4.0; }

// Without ties the fastest cell goes alone; from 1e3 k_crit on the cells are one, but for the slip
// a p/k of their coming together.
static void stiffness(void **state)
{
    scene_def def = scene_default(state);
    def.side = 4;
    def.pressure = mixed;
    def.spread = 0.3;
    def.ratio = 1.0;
    double tied = tied_time(&def);
    const double factors[] = {1e-6, 1e-3, 1e3, 1e4, 1e5, 1e6};
    for (size_t k = 0; k < 6; k++) {
        def.k0 = factors[k] * critical;
        for (size_t i = 0; i < 3; i++) {
            double error = error_of(&def, methods[i], tied);
            printf("k = %.0e k_crit %-9s %-5s off one block by %.1e\n", factors[k],
                   lac_formulation_name(def.formulation), method_names[i], error);
            if (factors[k] > 1.0) {
                assert_true(error < 10.0 / factors[k] + 1e-6 ||
                            (isnan(error) && may_run_out(&def, methods[i])));
            }
        }
    }
}

// Cells without ties: the first to reach the rate is the fastest at the start.
static void no_stiffness(void **state)
{
    scene_def def = scene_default(state);
    def.side = 4;
    def.pressure = mixed;
    def.spread = 0.3;
    scene s;
    scene_create(&def, &s);
    double fastest = -INFINITY;
    for (size_t i = 0; i < s.parts.domain->n; i++) {
        fastest = fmax(fastest, s.start[i]);
    }
    block_def one = as_one(&def, exp(fastest));
    double exact = one_cell_time(&one, 1.0);
    for (size_t i = 0; i < 3; i++) {
        lac_run_def how = to_rate(methods[i], 1e3, 1e-8);
        how.stop_rate = 1.0;
        one_cell_outcome out = watched_run(s.parts.problem, &how);
        assert_int_equal(out.status, LAC_OK);
        assert_int_equal(out.result.end, LAC_END_STOP);
        double error = fabs(out.result.time / exact - 1.0);
        printf("k = 0 %-9s %-5s error %.1e\n", lac_formulation_name(def.formulation),
               method_names[i], error);
        assert_true(error < 3e-6);
    }
    scene_free(&s);
}

static double patchy(size_t place)
{
    return 1e6 * (1.0 + 50.0 * lac_random_uniform(5, LAC_STREAM_TEST, place, 1));
}

// A million cells over the first hundredth of their way, in bounded memory.
static void a_million_cells(void **state)
{
    scene_def def = scene_default(state);
    def.side = SANITIZED ? 128 : 1024;
    def.pressure = patchy;
    def.k0 = critical;
    scene s;
    scene_create(&def, &s);
    lac_run_def how = to_rate(LAC_BDF, 1.0, 1e-5);
    how.max_steps = 60;
    how.stop_rate = 1.05 * def.slip_rate;
    how.record.steps = 60;
    one_cell_outcome out = watched_run(s.parts.problem, &how);
    size_t n = s.parts.domain->n;
    scene_free(&s);
    if (out.status != LAC_OK) {
        fail_msg("%s", out.message);
    }
    assert_true(out.finite && out.result.end == LAC_END_STOP);
    block_def one = as_one(&def, def.slip_rate);
    double exact = one_cell_time(&one, 1.05 * def.slip_rate);
    printf("n = %zu, %-9s %lld steps, error %.1e\n", n, lac_formulation_name(def.formulation),
           (long long)out.result.steps, fabs(out.result.time / exact - 1.0));
    assert_true(fabs(out.result.time / exact - 1.0) < 1e-3);
    struct rusage used;
    assert_int_equal(getrusage(RUSAGE_SELF, &used), 0);
    printf("memory so far %.0f MB\n", (double)used.ru_maxrss / 1024.0);
    assert_true(SANITIZED || used.ru_maxrss < 1024 * 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOR_EACH_FORMULATION(few_cells),
        FOR_EACH_FORMULATION(full_contact),
        FOR_EACH_FORMULATION(one_cell_of_a_million),
        FOR_EACH_FORMULATION(a_chain_of_single_children),
        FOR_EACH_FORMULATION(pressures),
        FOR_EACH_FORMULATION(stiffness),
        FOR_EACH_FORMULATION(no_stiffness),
        FOR_EACH_FORMULATION(a_million_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
