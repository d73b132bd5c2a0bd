// SPDX-License-Identifier: GPL-3.0-or-later
// What loads do to a relaxing block, against exact solutions: docs/theory/loads.md, "Triggering".
#include <stdio.h>

#include <math.h>
#include <string.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/quadrature.h"
#include "support/slot.h"
#include "support/test.h"

// A block with b > a at x = 1.3 theta_ss relaxes; x grows.
static const double m = 1.5, step_at = 1.0;

static block_def relaxing(void) { return block_default(m, 1.3); }

// x at a later time, by bisection on the exact time from one x to another.
static double x_after(double x, double duration)
{
    bool grows = x > 1.0;
    double low = grows ? x : 0.0;
    double high = grows ? 1e3 : x;
    for (int i = 0; i < 200; i++) {
        double middle = 0.5 * (low + high);
        bool early = aging_time(m, x, middle) < duration;
        if (early == grows) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

static bool fails(const block_def *def)
{
    block b;
    lac_error err = {""};
    lac_run_result result;
    lac_run_def how = lac_run_default();
    how.rtol = 1e-10;
    how.failure_rate = 1e6;
    how.end = 1e6;
    block_create(def, &b);
    lac_status status = lac_run(b.problem, &how, NULL, &result, &err);
    block_clear(&b);
    if (status != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return result.failed;
}

static lac_model pore_slot(const char *name)
{
    lac_model model = {0};
    size_t i = 0;
    while (lac_pore_load_get(i) != NULL && strcmp(lac_pore_load_get(i)->info.name, name) != 0) {
        i++;
    }
    assert_int_equal(lac_model_create(&lac_pore_load_get(i)->info, &model, NULL), LAC_OK);
    return model;
}

// Ratio of shear to normal traction that the start carries.
static double start_ratio(const block_def *def)
{
    double v = def->slip_rate;
    double theta = block_steady_state(def) * def->x;
    return def->f0 + def->a * log(v / def->v0) + def->b * log(def->v0 * theta / def->dc);
}

// A pore pressure u lifts tau/sigma' from f to f/(1 - u/p): it triggers iff that is more than
// (b - a) ln x.
static void a_pore_step_triggers_at_its_threshold(void **state)
{
    (void)state;
    block_def def = relaxing();
    double x = x_after(def.x, step_at / block_steady_state(&def));
    double f = start_ratio(&def);
    double rise = (def.b - def.a) * log(x);
    lac_model model = pore_slot("step");
    def.pore = &model;
    def.pore_count = 1;
    test_slot_set(&model, "at", step_at);
    const double factors[] = {0.99, 0.999, 1.001, 1.01};
    for (size_t i = 0; i < 4; i++) {
        double u = def.pressure * (1.0 - f / (f + factors[i] * rise));
        test_slot_set(&model, "value", u);
        assert_int_equal(fails(&def), factors[i] > 1.0);
    }
    lac_model_clear(&model);
}

// State after a pulse of the load: x -> x s at once, its own time for the pulse's length, back.
static double x_after_pulse(const block_def *def, double x, double step, double duration)
{
    double s = exp(-step / (def->b - def->a));
    double steady = block_steady_state(def) / s; // theta does not jump
    double pushed = x * s;
    if (pushed < 1.0 && aging_time(m, pushed, 1e-9) < duration / steady) {
        return 0.0; // it failed before the pulse was over
    }
    return x_after(pushed, duration / steady) / s;
}

// A pulse of shear triggers iff it leaves x below 1: a short one must be stronger.
static void a_pulse_triggers_at_its_threshold(void **state)
{
    (void)state;
    const double durations[] = {0.05, 0.5};
    block_def def = relaxing();
    double x = x_after(def.x, step_at / block_steady_state(&def));
    lac_model model = test_slot_shear("step");
    def.shear = &model;
    def.shear_count = 1;
    test_slot_set(&model, "at", step_at);
    double before = 0.0;
    for (size_t d = 0; d < 2; d++) {
        double low = (def.b - def.a) * log(x); // for a step that stays
        double high = 20.0 * low;
        for (int i = 0; i < 100; i++) {
            double middle = 0.5 * (low + high);
            if (x_after_pulse(&def, x, middle, durations[d]) < 1.0) {
                high = middle;
            } else {
                low = middle;
            }
        }
        assert_true(d == 0 || high < before);
        before = high;
        test_slot_set(&model, "until", step_at + durations[d]);
        const double factors[] = {0.99, 1.01};
        for (size_t i = 0; i < 2; i++) {
            test_slot_set(&model, "value", factors[i] * high * def.pressure);
            assert_int_equal(fails(&def), factors[i] > 1.0);
        }
    }
    lac_model_clear(&model);
}

// Mean slip at the end of a block that a ramp speeds up by an e-fold each second.
static double slip_by(block_def def, lac_method method, double rtol, double end)
{
    block b;
    lac_error err = {""};
    lac_run_result result;
    lac_run_def how = lac_run_default();
    lac_model model = test_slot_shear("ramp");
    test_slot_set(&model, "rate",
                  (strcmp(def.law, "weakening") == 0 ? def.a : def.a - def.b) * def.pressure);
    def.shear = &model;
    def.shear_count = 1;
    how.method = method;
    how.rtol = rtol;
    how.failure_rate = 1e9;
    how.end = end;
    block_create(&def, &b);
    if (lac_run(b.problem, &how, NULL, &result, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    block_clear(&b);
    lac_model_clear(&model);
    assert_false(result.failed);
    return result.mean_slip;
}

// Where ln v and ln theta grow along straight lines any step follows them, but not the slip.
static void slip_is_followed_where_its_rate_is_a_straight_line(void **state)
{
    static const lac_formulation unknown[] = {LAC_FORMULATION_RATE, LAC_FORMULATION_TRACTION};
    (void)state;
    block_def holding = block_default(1.5, 0.5); // theta stays, as v theta < dc
    holding.law = "weakening";
    holding.slip_rate = 1e-9;
    holding.theta = 1.0;
    block_def hardening = block_default(0.5, 1.0);
    hardening.formulation = LAC_FORMULATION_SLIP;
    double exact = slip_by(hardening, LAC_BDF, 1e-9, 7.0);
    for (int i = 0; i < 2; i++) {
        for (int method = LAC_BDF; method <= LAC_ERK; method++) {
            for (double rtol = 1e-3; rtol > 1e-8; rtol /= 100) {
                holding.formulation = hardening.formulation = unknown[i];
                double held = slip_by(holding, (lac_method)method, rtol, 20.5);
                double off = fabs(held / (1e-9 * expm1(20.5)) - 1);
                double slid = fabs(slip_by(hardening, (lac_method)method, rtol, 7.0) / exact - 1);
                print_message("%s, method %d, rtol %g: off by %.1e, %.1e\n",
                              lac_formulation_name(unknown[i]), method, rtol, off, slid);
                assert_true(off < 100 * rtol && slid < 20 * rtol);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pore_step_triggers_at_its_threshold),
        cmocka_unit_test(a_pulse_triggers_at_its_threshold),
        cmocka_unit_test(slip_is_followed_where_its_rate_is_a_straight_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
