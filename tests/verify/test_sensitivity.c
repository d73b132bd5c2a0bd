// SPDX-License-Identifier: GPL-3.0-or-later
// What is followed, and its derivatives, against the exact solutions of docs/theory/creep.md, and
// against central differences of tighter runs.
#include <stdio.h>

#include <gsl/gsl_sf_lambert.h>
#include <math.h>
#include <string.h>

#include "lacuna/simulation.h"
#include "run/sensitivity.h"
#include "support/block.h"
#include "support/slot.h"
#include "support/test.h"
#include "support/tree.h"

enum { TIMES = 6, MOST = 4 };

// What is seen of a run, and its derivatives.
typedef struct observation {
    double slip[TIMES], log_rate[TIMES];
    double slip_by[TIMES * MOST], log_rate_by[TIMES * MOST], failure_by[MOST];
    double failure;
    size_t reached;
} observation;

// What is seen; NULL: the means.
static const lac_point *seen;

static observation follow(const lac_problem *problem, const lac_perturbation *perturbation,
                          size_t perturbations, double rtol, const double *time, double end)
{
    observation out = {0};
    lac_error err = {""};
    lac_sensitivity f = {.slip = out.slip,
                         .log_rate = out.log_rate,
                         .slip_by = out.slip_by,
                         .log_rate_by = out.log_rate_by,
                         .failure_by = out.failure_by};
    const lac_sensitivity_def def = {.problem = problem,
                                     .perturbations = perturbations,
                                     .perturbation = perturbation,
                                     .point = seen,
                                     .rtol = rtol,
                                     .end = end,
                                     .failure_rate = 1e6,
                                     .max_steps = 100000,
                                     .n = TIMES,
                                     .time = time};
    if (lac_sensitivity_run(&def, &f, &err) != LAC_OK) {
        fail_msg("follow: %s", err.message);
    }
    out.failure = f.failure_time;
    out.reached = f.reached;
    return out;
}

static void assert_near(double got, double want, double within, const char *what, size_t i)
{
    if (!(fabs(got - want) <= within)) {
        fail_msg("%s %zu: %.12g, expected %.12g within %.3g", what, i, got, want, within);
    }
}

// O1, O4: m = 2, parameters ln dc, ln v_i, x_i.
static void exact(const double *p, double t, double *slip, double *log_rate, double *failure)
{
    double dc = exp(p[0]);
    double start = p[2];
    double steady_rate = exp(p[1]) * start * start;
    double scale = dc / steady_rate;
    double x = 1.0 + gsl_sf_lambert_W0(-exp(start + log(1.0 - start) + t / scale - 1.0));
    *slip = dc * log((1.0 / x - 1.0) / (1.0 / start - 1.0));
    *log_rate = log(steady_rate) - 2.0 * log(x);
    *failure = scale * (-start - log(1.0 - start));
}

static block_def block_at(const double *p)
{
    block_def def = block_default(2.0, p[2]);
    def.dc = exp(p[0]);
    def.slip_rate = exp(p[1]);
    return def;
}

// 1.40258509299 theta_ss is the time of failure at x = 0.9.
static void closed_forms(void **state)
{
    (void)state;
    const double p[3] = {0.0, 0.0, 0.9};
    const double tc = (-0.9 - log(0.1)) / (0.9 * 0.9);
    const double time[TIMES] = {0.0, 0.2 * tc, 0.5 * tc, 0.8 * tc, 0.95 * tc, 0.999 * tc};
    const double h = 1e-5;
    block base, low[3], high[3];
    lac_perturbation perturbation[3];
    block_def def = block_at(p);
    block_create(&def, &base);
    for (size_t k = 0; k < 3; k++) {
        double moved[3] = {p[0], p[1], p[2]};
        moved[k] = p[k] - h;
        def = block_at(moved);
        block_create(&def, &low[k]);
        moved[k] = p[k] + h;
        def = block_at(moved);
        block_create(&def, &high[k]);
        perturbation[k] = (lac_perturbation){low[k].problem, high[k].problem, h};
    }
    observation got = follow(base.problem, perturbation, 3, 1e-9, time, 10.0 * tc);
    assert_int_equal(got.reached, TIMES);
    for (size_t i = 0; i < TIMES; i++) {
        double slip, rate, fails;
        exact(p, time[i], &slip, &rate, &fails);
        double near = fmax(1.0, 0.1 / (1.0 - time[i] / tc)); // errors grow as the rate does
        assert_near(got.slip[i], slip, 2e-7 * near, "slip", i);
        assert_near(got.log_rate[i], rate, 2e-6 * near, "ln rate", i);
        for (size_t k = 0; k < 3; k++) {
            double plus[3] = {p[0], p[1], p[2]}, minus[3] = {p[0], p[1], p[2]};
            double by[2], rate_by[2], fails_by[2];
            plus[k] += 1e-6;
            minus[k] -= 1e-6;
            exact(plus, time[i], &by[1], &rate_by[1], &fails_by[1]);
            exact(minus, time[i], &by[0], &rate_by[0], &fails_by[0]);
            double slope = (by[1] - by[0]) / 2e-6;
            double rate_slope = (rate_by[1] - rate_by[0]) / 2e-6;
            assert_near(got.slip_by[3 * i + k], slope, 1e-5 * near * (1.0 + fabs(slope)), "slip by",
                        3 * i + k);
            assert_near(got.log_rate_by[3 * i + k], rate_slope,
                        1e-5 * near * (1.0 + fabs(rate_slope)), "ln rate by", 3 * i + k);
            // The rate that counts as failure is not infinite: a millionth of theta_ss early.
            assert_near(got.failure_by[k], (fails_by[1] - fails_by[0]) / 2e-6, 2e-4, "failure by",
                        k);
        }
    }
    assert_near(got.failure, tc, 2e-5, "failure", 0);
    for (size_t k = 0; k < 3; k++) {
        block_clear(&low[k]);
        block_clear(&high[k]);
    }
    block_clear(&base);
}

// The k-th parameter of a block moved by h: ln b, ln dc, the height of a step of stress.
static lac_model move_block(block_def *def, size_t k, double h)
{
    lac_model step = test_slot_shear("step");
    def->b *= k == 0 ? exp(h) : 1.0;
    def->dc *= k == 1 ? exp(h) : 1.0;
    test_slot_set(&step, "at", 0.3);
    test_slot_set(&step, "value", 2e3 * (k == 2 ? exp(h) : 1.0));
    return step;
}

static observation follow_block(const block_def *def, size_t k, double h, double rtol,
                                const double *time)
{
    block b;
    block_def moved = *def;
    lac_model step = move_block(&moved, k, h);
    moved.shear = &step;
    moved.shear_count = 1;
    block_create(&moved, &b);
    observation out = follow(b.problem, NULL, 0, rtol, time, time[TIMES - 1]);
    block_clear(&b);
    lac_model_clear(&step);
    return out;
}

// Across a jump of the load, in every formulation.
static void central_differences(void **state)
{
    const double time[TIMES] = {0.1, 0.25, 0.3, 0.35, 0.5, 0.6};
    block_def def = block_default(1.35, 0.7);
    def.formulation = chosen(state);
    block made[7];
    lac_model model[7];
    lac_perturbation perturbation[3];
    const double h = 1e-5;
    for (size_t j = 0; j < 7; j++) {
        block_def moved = def;
        model[j] = move_block(&moved, j / 2, j == 6 ? 0.0 : j % 2 == 0 ? -h : h);
        moved.shear = &model[j];
        moved.shear_count = 1;
        block_create(&moved, &made[j]);
    }
    for (size_t k = 0; k < 3; k++) {
        perturbation[k] = (lac_perturbation){made[2 * k].problem, made[2 * k + 1].problem, h};
    }
    observation got = follow(made[6].problem, perturbation, 3, 1e-8, time, time[TIMES - 1]);
    assert_int_equal(got.reached, TIMES);
    for (size_t k = 0; k < 3; k++) {
        observation plus = follow_block(&def, k, 1e-3, 1e-11, time);
        observation minus = follow_block(&def, k, -1e-3, 1e-11, time);
        for (size_t i = 0; i < TIMES; i++) {
            double slope = (plus.slip[i] - minus.slip[i]) / 2e-3;
            double rate_slope = (plus.log_rate[i] - minus.log_rate[i]) / 2e-3;
            assert_near(got.slip_by[3 * i + k], slope, 3e-5 * (1.0 + fabs(slope)), "slip by",
                        3 * i + k);
            if (time[i] != 0.3) { // the rate jumps there
                assert_near(got.log_rate_by[3 * i + k], rate_slope, 3e-5 * (1.0 + fabs(rate_slope)),
                            "ln rate by", 3 * i + k);
            }
        }
    }
    for (size_t j = 0; j < 7; j++) {
        block_clear(&made[j]);
        lac_model_clear(&model[j]);
    }
}

static observation follow_tree(double dc, const double *time, double rtol)
{
    tree t;
    tree_def def = tree_default(2, 3);
    def.dc *= dc;
    tree_create(&def, &t);
    observation out = follow(t.problem, NULL, 0, rtol, time, time[TIMES - 1]);
    tree_clear(&t);
    return out;
}

// Several cells that hand load on to one another.
static void follow_small_tree(void)
{
    tree_def def = tree_default(2, 3);
    double scale = def.dc / def.slip_rate;
    double time[TIMES];
    tree base, low, high;
    const double h = 1e-5;
    for (size_t i = 0; i < TIMES; i++) {
        time[i] = 0.05 * scale * (double)(i + 1);
    }
    tree_create(&def, &base);
    def.dc *= exp(-h);
    tree_create(&def, &low);
    def.dc *= exp(2.0 * h);
    tree_create(&def, &high);
    lac_perturbation perturbation = {low.problem, high.problem, h};
    observation got = follow(base.problem, &perturbation, 1, 1e-8, time, time[TIMES - 1]);
    observation plus = follow_tree(exp(1e-3), time, 1e-11);
    observation minus = follow_tree(exp(-1e-3), time, 1e-11);
    assert_true(lac_problem_cells(base.problem) > 2);
    for (size_t i = 0; i < got.reached; i++) {
        double slope = (plus.slip[i] - minus.slip[i]) / 2e-3;
        double rate_slope = (plus.log_rate[i] - minus.log_rate[i]) / 2e-3;
        assert_near(got.slip_by[i] / got.slip[i], slope / got.slip[i], 3e-5, "slip by", i);
        assert_near(got.log_rate_by[i], rate_slope, 3e-5 * (1.0 + fabs(rate_slope)), "rate by", i);
    }
    assert_int_equal(got.reached, TIMES);
    tree_clear(&base);
    tree_clear(&low);
    tree_clear(&high);
}

static void small_tree(void **state)
{
    (void)state;
    follow_small_tree();
}

// The same of one cell, and of two; of all it is the mean.
static void points_of_a_tree(void **state)
{
    const double time[TIMES] = {1e5, 2e5, 3e5, 4e5, 5e5, 6e5};
    size_t cell[64];
    lac_point point = {.cells = 1, .cell = cell};
    (void)state;
    tree_def def = tree_default(2, 3);
    tree base;
    tree_create(&def, &base);
    const size_t n = lac_problem_cells(base.problem);
    assert_in_range(n, 3, 64);
    for (size_t i = 0; i < n; i++) {
        cell[i] = i;
    }
    const observation mean = follow(base.problem, NULL, 0, 1e-8, time, time[TIMES - 1]);
    double sum[TIMES] = {0}, rates[TIMES] = {0};
    seen = &point;
    for (size_t i = 0; i < n; i++) {
        cell[0] = i;
        const observation one = follow(base.problem, NULL, 0, 1e-8, time, time[TIMES - 1]);
        for (size_t k = 0; k < TIMES; k++) {
            sum[k] += one.slip[k] / (double)n;
            rates[k] += exp(one.log_rate[k]) / (double)n;
        }
    }
    for (size_t k = 0; k < TIMES; k++) {
        assert_near(sum[k] / mean.slip[k], 1.0, 1e-6, "mean of the cells' slips", k);
        assert_near(rates[k] / exp(mean.log_rate[k]), 1.0, 1e-6, "mean of their rates", k);
    }
    cell[0] = n - 1;
    follow_small_tree();
    point.cells = 2;
    cell[1] = 0;
    follow_small_tree();
    seen = NULL;
    tree_clear(&base);
}

// A stress that goes up and down all the time: every turn begins the integrator anew, which must
// not add up. Against a run by a method of one step.
static void many_breaks(void **state)
{
    enum { TURNS = 600 };
    const double time[TIMES] = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5};
    lac_model ramp[TURNS];
    (void)state;
    for (size_t i = 0; i < TURNS; i++) {
        ramp[i] = test_slot_shear("ramp");
        test_slot_set(&ramp[i], "start", 0.5 * (double)i / TURNS);
        test_slot_set(&ramp[i], "end", 0.5 * (double)(i + 1) / TURNS);
        test_slot_set(&ramp[i], "rate", i % 2 == 0 ? 2e6 : -2e6);
    }
    block_def def = block_default(1.35, 0.5);
    def.shear = ramp;
    def.shear_count = TURNS;
    block b;
    block_create(&def, &b);
    lac_run_def run = lac_run_default();
    run.method = LAC_ERK;
    run.rtol = 1e-10;
    run.end = 0.5;
    run.failure_rate = 1e6;
    lac_run_result result;
    lac_error err = {""};
    assert_int_equal(lac_run(b.problem, &run, NULL, &result, &err), LAC_OK);
    observation got = follow(b.problem, NULL, 0, 1e-6, time, 0.5);
    assert_near(got.slip[TIMES - 1] / result.mean_slip, 1.0, 1e-4, "slip", TIMES - 1);
    block_clear(&b);
    for (size_t i = 0; i < TURNS; i++) {
        lac_model_clear(&ramp[i]);
    }
}

// The same bits again, and a state that is steady stays.
static void same_bits(void **state)
{
    (void)state;
    const double time[TIMES] = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5};
    block_def def = block_default(1.35, 0.5);
    block b;
    block_create(&def, &b);
    observation one = follow(b.problem, NULL, 0, 1e-6, time, 0.5);
    observation two = follow(b.problem, NULL, 0, 1e-6, time, 0.5);
    assert_memory_equal(&one, &two, sizeof one);
    block_clear(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms), FOR_EACH_FORMULATION(central_differences),
        cmocka_unit_test(small_tree),   cmocka_unit_test(many_breaks),
        cmocka_unit_test(same_bits),    cmocka_unit_test(points_of_a_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
