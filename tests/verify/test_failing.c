// SPDX-License-Identifier: GPL-3.0-or-later
// When a joint has failed whose cells slip one by one: not when one of them carries the mean slip
// rate past a p/eta and stops again, but when all go. Against an integration of the test's own.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <stdio.h>

#include "lacuna/simulation.h"
#include "run/sensitivity.h"
#include "support/block.h"
#include "support/test.h"
#include "support/tree.h"

// One cell in each of 4 x 4 fields of 8 x 8 cells, under one pressure.
enum { SIDE = 32, FIELD = 8, N = 16, UNKNOWNS = 2 * N + 1 };

typedef struct joint {
    tree_def def;
    double k_cell, k_quarter; // what ties a cell to its quarter's mean, and that to the whole's
    double loading;           // of each cell [Pa/s]
    double start[2 * N];      // ln v, ln theta
} joint;

// @param stiffness  of the ties, in k_crit
static joint make_joint(double stiffness)
{
    const double b = 0.015;
    joint j = {.def = tree_default(5, 1)};
    j.def.a = 0.01;
    j.def.b = b;
    j.def.dc = 1e-4;
    j.def.pressure = 3e6 * (SIDE * SIDE) / N;
    j.def.damping = 2e10 / 6e3;
    j.def.k0 = stiffness * (b - j.def.a) * j.def.pressure / j.def.dc;
    j.def.ratio = 1.0;
    j.k_cell = j.k_quarter = j.def.k0;
    j.loading = 3.0;
    for (size_t i = 0; i < N; i++) {
        j.start[i] = log(1e-9) + 1.5 * sin(7.0 * (double)(i + 1));
        j.start[N + i] = log(0.8 * j.def.dc) - j.start[i];
    }
    return j;
}

// The same about to go: at 1e5 times the rate, above steady state.
static joint make_late_joint(double a)
{
    joint j = make_joint(0.5);
    j.def.a = a;
    for (size_t i = 0; i < N; i++) {
        j.start[i] += log(1e5);
        j.start[N + i] -= log(1e5 / 2.5);
    }
    return j;
}

// The quarter that cell i, row by row, is in.
static size_t quarter(size_t i) { return i / 8 * 2 + i % 4 / 2; }

// What slip, or its rate, takes off each cell.
static void hold(const joint *j, const double *x, double *force)
{
    double mean[4] = {0.0};
    double all = 0.0;
    for (size_t i = 0; i < N; i++) {
        mean[quarter(i)] += x[i] / 4.0;
        all += x[i] / N;
    }
    for (size_t i = 0; i < N; i++) {
        double m = mean[quarter(i)];
        force[i] = j->k_cell * (x[i] - m) + j->k_quarter * (m - all);
    }
}

// d(ln v, ln theta, mean slip)/dt of the aging law: the balance
//     q - K slip = p (f0 + a ln v + b ln theta + ...) + eta v + eta (SIDE^2/N - 1) mean(v)
// differentiated, solved for d(mean v)/dt.
static void rates(const joint *j, const double *y, double *dy)
{
    double eta = j->def.damping;
    double common = eta * ((double)(SIDE * SIDE) / N - 1.0);
    double v[N], held[N], free[N];
    double push = 0.0, give = 0.0, mean = 0.0;
    for (size_t i = 0; i < N; i++) {
        v[i] = exp(y[i]);
        mean += v[i] / N;
    }
    hold(j, v, held);
    for (size_t i = 0; i < N; i++) {
        dy[N + i] = exp(-y[N + i]) - v[i] / j->def.dc;
        double stiff = j->def.a * j->def.pressure + eta * v[i];
        free[i] = (j->loading - held[i] - j->def.b * j->def.pressure * dy[N + i]) / stiff;
        push += v[i] * free[i] / N;
        give += v[i] / stiff / N;
        held[i] = stiff;
    }
    double rise = push / (1.0 + common * give);
    for (size_t i = 0; i < N; i++) {
        dy[i] = free[i] - common * rise / held[i];
    }
    dy[2 * N] = mean;
}

// A step by Bogacki and Shampine's pair. @return  its error over the tolerance
static double try_step(const joint *j, double h, const double *y, double *next, double tolerance)
{
    double k[4][UNKNOWNS], at[UNKNOWNS];
    double worst = 0.0;
    rates(j, y, k[0]);
    for (size_t i = 0; i < UNKNOWNS; i++) {
        at[i] = y[i] + h / 2.0 * k[0][i];
    }
    rates(j, at, k[1]);
    for (size_t i = 0; i < UNKNOWNS; i++) {
        at[i] = y[i] + 0.75 * h * k[1][i];
    }
    rates(j, at, k[2]);
    for (size_t i = 0; i < UNKNOWNS; i++) {
        next[i] = y[i] + h / 9.0 * (2.0 * k[0][i] + 3.0 * k[1][i] + 4.0 * k[2][i]);
    }
    rates(j, next, k[3]);
    for (size_t i = 0; i + 1 < UNKNOWNS; i++) {
        double off = h / 72.0 * (-5.0 * k[0][i] + 6.0 * k[1][i] + 8.0 * k[2][i] - 9.0 * k[3][i]);
        worst = fmax(worst, fabs(off) / tolerance);
    }
    return isfinite(worst) ? worst : 1e9;
}

static double mean_rate(const double *y)
{
    double sum = 0.0;
    for (size_t i = 0; i < N; i++) {
        sum += exp(y[i]) / N;
    }
    return sum;
}

// What happens to the joint, by the test's own integration.
typedef struct fate {
    double first;   // the mean slip rate first passes v_f [s]
    int passes;     // how often it does so
    double rest;    // the last time at which it was below a thousandth of that [s]
    double failure; // it and the rate of all as one are beyond v_f [s]
    double slip;    // mean slip then [m]
} fate;

// ln of the rate at which all would slide as one, over v_f: v/v_f + ln v/v_f of theirs add up.
static double as_one(const double *y, double v_f)
{
    double sum = mean_rate(y) / v_f - 1.0;
    for (size_t i = 0; i < N; i++) {
        sum += (y[i] - log(v_f)) / N;
    }
    return sum;
}

// It goes on a tenth of the slip beyond failure, to see whether the joint comes to rest again.
static fate follow(const joint *j, double tolerance)
{
    double y[UNKNOWNS] = {0.0}, next[UNKNOWNS];
    double v_f = j->def.a * 3e6 / j->def.damping;
    double t = 0.0, h = 1.0;
    bool above = false;
    fate seen = {.first = NAN, .failure = NAN};
    memcpy(y, j->start, sizeof j->start);
    while (isnan(seen.failure) || y[2 * N] < 1.1 * seen.slip) {
        double error = try_step(j, h, y, next, tolerance);
        if (error <= 1.0) {
            double before = fmin(log(mean_rate(y) / v_f), as_one(y, v_f));
            double now = fmin(log(mean_rate(next) / v_f), as_one(next, v_f));
            if (isnan(seen.failure) && now >= 0.0) {
                seen.failure = t - h * before / (now - before);
                seen.slip = next[2 * N];
            }
            t += h;
            memcpy(y, next, sizeof y);
            double mean = mean_rate(y);
            seen.passes += mean >= v_f && !above;
            seen.first = isnan(seen.first) && mean >= v_f ? t : seen.first;
            seen.rest = mean < 1e-3 * v_f ? t : seen.rest;
            above = mean >= v_f;
        }
        h *= fmin(5.0, fmax(0.2, 0.9 * cbrt(1.0 / fmax(error, 1e-9))));
    }
    return seen;
}

static void grow(const lac_load *load, double t, lac_load_state *sum)
{
    double rate = *(const double *)load->params;
    sum->ratio += rate * t;
    sum->ratio_rate += rate;
}

static const lac_load_kind growing = {.info = {.name = "growing"}, .add = grow, .linear = true};

// The same joint, for the library.
typedef struct scene {
    tree made;
    double per_pressure;
    lac_load load;
} scene;

static void scene_create(const joint *j, lac_formulation formulation, scene *s)
{
    lac_error err = {""};
    const lac_grid grid = {.nx = SIDE, .ny = SIDE, .dx = 1.0, .dy = 1.0, .periodic = true};
    double pressure[SIDE * SIDE] = {0.0};
    for (size_t i = 0; i < N; i++) {
        pressure[(i / 4 * FIELD + 3) * SIDE + i % 4 * FIELD + 5] = j->def.pressure;
    }
    *s = (scene){.per_pressure = j->loading / j->def.pressure};
    s->load = (lac_load){.kind = &growing, .params = &s->per_pressure};
    assert_int_equal(lac_domain_create(&grid, pressure, &s->made.domain, &err), LAC_OK);
    assert_int_equal(lac_hierarchy_create(s->made.domain, &s->made.hierarchy, &err), LAC_OK);
    tree_make_transfer(&j->def, &s->made);
    tree_make_friction(&j->def, &s->made);
    // cells in the domain's own order
    double start[2 * N];
    for (size_t i = 0; i < N; i++) {
        size_t place = s->made.domain->index[i];
        size_t field = place / SIDE / FIELD * 4 + place % SIDE / FIELD;
        start[i] = j->start[field];
        start[N + i] = j->start[N + field];
    }
    const lac_problem_def problem = {.domain = s->made.domain,
                                     .friction = s->made.friction,
                                     .transfer = &s->made.transfer,
                                     .loads = {.load = &s->load, .count = 1, .shear = 1},
                                     .damping = j->def.damping,
                                     .log_rate = start,
                                     .log_state = start + N,
                                     .formulation = formulation};
    assert_int_equal(lac_problem_create(&problem, &s->made.problem, &err), LAC_OK);
}

static lac_run_def how_to_run(double rtol)
{
    lac_run_def how = lac_run_default();
    how.rtol = rtol;
    how.end = 1e7;
    return how;
}

static lac_run_result run(const joint *j, lac_formulation formulation, const lac_run_def *how)
{
    scene s;
    lac_error err = {""};
    lac_run_result result;
    scene_create(j, formulation, &s);
    if (lac_run(s.made.problem, how, NULL, &result, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    tree_clear(&s.made);
    assert_true(result.failed && result.end == LAC_END_FAILURE);
    return result;
}

static double time_of(const lac_run_result *result)
{
    return result->failure_origin + result->failure_local;
}

// Hours of slips one by one, many of which carry the mean beyond v_f, are no failure; all together
// are, within seconds of the last rest, for cells softly and more stiffly tied.
static void the_joint_fails_when_all_go(void **state)
{
    const double ties[] = {0.03, 0.25};
    const lac_method methods[] = {LAC_BDF, LAC_ADAMS, LAC_ERK};
    for (size_t k = 0; k < 2; k++) {
        joint j = make_joint(ties[k]);
        fate f = follow(&j, 1e-9);
        printf(
            "ties %g k_crit: %d times beyond v_f, first at %.3f s; at rest to %.3f s, failure %.6f "
            "s\n",
            ties[k], f.passes, f.first, f.rest, f.failure);
        assert_true(f.passes > 10 && f.first < f.rest - 3600.0);
        assert_true(f.failure > f.rest && f.failure < f.rest + 5.0);
        for (size_t m = 0; m < 3; m++) {
            lac_run_def how = how_to_run(1e-8);
            how.method = methods[m];
            lac_run_result result = run(&j, chosen(state), &how);
            printf("  %+.2g s\n", time_of(&result) - f.failure);
            assert_true(result.failure.lowered);
            assert_true(fabs(time_of(&result) - f.failure) < 0.3);
        }
    }
}

// A rate that is named and within reach is the mean slip rate's, whoever carries it: the first slip
// passes it.
static void a_named_rate_is_of_the_mean(void **state)
{
    (void)state;
    joint j = make_joint(0.25);
    fate f = follow(&j, 1e-9);
    lac_run_def how = how_to_run(1e-8);
    how.failure_rate = j.def.a * 3e6 / j.def.damping;
    lac_run_result result = run(&j, LAC_FORMULATION_RATE, &how);
    printf("named: %.6f s, first at %.6f s\n", time_of(&result), f.first);
    assert_true(!result.failure.lowered && fabs(time_of(&result) - f.first) < 0.3);
}

// Nobody's looking moves the time of failure; cells at steps of their own come to it as near as
// their tolerance lets them.
static void nor_cadence_nor_fidelity_matters(void **state)
{
    (void)state;
    joint j = make_joint(0.25);
    fate f = follow(&j, 1e-9);
    lac_run_def how = how_to_run(1e-8);
    double plain = 0.0;
    for (size_t i = 0; i < 2; i++) {
        lac_run_result result = run(&j, LAC_FORMULATION_RATE, &how);
        assert_true(i == 0 || time_of(&result) == plain);
        plain = time_of(&result);
        how.record = (lac_cadence){.time = 977.0, .per_decade = NAN};
    }
    how = how_to_run(1e-8);
    how.fidelity = LAC_FIDELITY_ASYNC;
    lac_run_result result = run(&j, LAC_FORMULATION_RATE, &how);
    printf("events: %+.3g s\n", time_of(&result) - f.failure);
    assert_true(fabs(time_of(&result) - f.failure) < 50.0);
}

static lac_sensitivity_def to_follow(const scene *s)
{
    return (lac_sensitivity_def){.problem = s->made.problem,
                                 .rtol = 1e-9,
                                 .end = 1e7,
                                 .failure_rate = 1.0,
                                 .failure_slip = NAN,
                                 .max_steps = 1000000};
}

// What fits and forecasts follow fails as a run does.
static void what_is_followed_fails_so_too(void **state)
{
    (void)state;
    joint j = make_joint(0.25);
    scene s;
    lac_error err = {""};
    lac_sensitivity seen = {0};
    fate f = follow(&j, 1e-9);
    scene_create(&j, LAC_FORMULATION_RATE, &s);
    const lac_sensitivity_def def = to_follow(&s);
    assert_int_equal(lac_sensitivity_run(&def, &seen, &err), LAC_OK);
    printf("followed: %+.3g s\n", seen.failure_time - f.failure);
    assert_true(seen.failed && fabs(seen.failure_time - f.failure) < 0.3);
    tree_clear(&s.made);
}

// And knows what a parameter does to the time: friction's a, which moves the p/eta as well, a share
// of the whole where failure is near. Against differences of the test's own integration.
static void failure_by_a_parameter(void **state)
{
    (void)state;
    const double a[] = {0.01 - 1e-6, 0.01, 0.01 + 1e-6};
    double time[3], by = 0.0;
    scene s[3];
    lac_error err = {""};
    for (size_t i = 0; i < 3; i++) {
        joint j = make_late_joint(a[i]);
        scene_create(&j, LAC_FORMULATION_RATE, &s[i]);
        time[i] = follow(&j, 1e-11).failure;
    }
    const lac_perturbation perturbation = {
        .low = s[0].made.problem, .high = s[2].made.problem, .step = 0.5 * (a[2] - a[0])};
    lac_sensitivity seen = {.failure_by = &by};
    lac_sensitivity_def def = to_follow(&s[1]);
    def.perturbations = 1;
    def.perturbation = &perturbation;
    assert_int_equal(lac_sensitivity_run(&def, &seen, &err), LAC_OK);
    double exact = (time[2] - time[0]) / (a[2] - a[0]);
    printf("fails at %.8g s, %+.2g s; by a: %.6g s, differences %.6g s\n", time[1],
           seen.failure_time - time[1], by, exact);
    assert_true(fabs(seen.failure_time / time[1] - 1.0) < 1e-6);
    assert_true(fabs(by / exact - 1.0) < 1e-3);
    for (size_t i = 0; i < 3; i++) {
        tree_clear(&s[i].made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOR_EACH_FORMULATION(the_joint_fails_when_all_go),
        cmocka_unit_test(a_named_rate_is_of_the_mean),
        cmocka_unit_test(nor_cadence_nor_fidelity_matters),
        cmocka_unit_test(what_is_followed_fails_so_too),
        cmocka_unit_test(failure_by_a_parameter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
