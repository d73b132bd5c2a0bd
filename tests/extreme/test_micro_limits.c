// SPDX-License-Identifier: GPL-3.0-or-later
// Fidelity `events` where there is next to nothing of something: one cell, two, all alike, none
// that slips, times of many orders of magnitude, and what it has to refuse.
#include <stdio.h>
#include <string.h>

#include <math.h>

#include "lacuna/simulation.h"
#include "support/slot.h"
#include "support/test.h"
#include "support/tree.h"

static lac_run_result run(const tree_def *def, lac_run_def how, lac_fidelity fidelity, double rtol)
{
    tree t;
    lac_error err = {""};
    lac_run_result result;
    tree_create(def, &t);
    how.fidelity = fidelity;
    how.rtol = rtol;
    lac_status status = lac_run(t.problem, &how, NULL, &result, &err);
    tree_clear(&t);
    if (status != LAC_OK) {
        fail_msg("run: %s", err.message);
    }
    return result;
}

static lac_run_def until(double end)
{
    lac_run_def how = lac_run_default();
    how.end = end;
    how.failure_rate = 1.0;
    how.record.steps = 0;
    return how;
}

static void same_failure(const tree_def *def, double within)
{
    lac_run_result ode = run(def, until(1e12), LAC_FIDELITY_ODE, 1e-9);
    lac_run_result events = run(def, until(1e12), LAC_FIDELITY_ASYNC, 1e-8);
    printf("failure after %.9g s and %.9g s (ode)\n", events.time, ode.time);
    assert_true(ode.failed && events.failed);
    assert_true(fabs(events.time / ode.time - 1.0) < within);
}

static void one_cell_two_and_four_alike(void **state)
{
    (void)state;
    tree_def def = tree_default(0, 1);
    def.state *= 3.0;
    same_failure(&def, 1e-4);
    def.levels = 1;
    def.keep = 0.5;
    def.seed = 3;
    same_failure(&def, 1e-3);
    // Stiff to each other: they move as one, and take far more steps than ode.
    def.keep = 1.0;
    def.k0 = 3.0 * def.pressure * (def.b - def.a) / def.dc;
    same_failure(&def, 1e-3);
}

// Rate-strengthening cells come to rest at the rate that carries their load.
static void nothing_slips(void **state)
{
    (void)state;
    tree_def def = tree_default(2, 3);
    def.b = 0.005;
    def.k0 = 1e9;
    lac_run_result ode = run(&def, until(1e6), LAC_FIDELITY_ODE, 1e-9);
    lac_run_result events = run(&def, until(1e6), LAC_FIDELITY_ASYNC, 1e-8);
    printf("mean slip %.9g m and %.9g m (ode)\n", events.mean_slip, ode.mean_slip);
    assert_int_equal(events.end, LAC_END_TIME);
    assert_true(fabs(events.mean_slip / ode.mean_slip - 1.0) < 1e-4);
}

// A thousand years of creep that end in microseconds.
static void long_times(void **state)
{
    (void)state;
    tree_def def = tree_default(2, 3);
    def.slip_rate = 1e-16;
    def.state = 3e-5 / 1e-16;
    def.k0 = 0.1 * def.pressure * (def.b - def.a) / def.dc;
    same_failure(&def, 1e-3);
}

static void limits_end_it(void **state)
{
    (void)state;
    tree_def def = tree_default(2, 3);
    def.k0 = 0.1 * def.pressure * (def.b - def.a) / def.dc;
    lac_run_def how = until(1e12);
    how.stop_rate = 1e-4;
    lac_run_result events = run(&def, how, LAC_FIDELITY_ASYNC, 1e-8);
    assert_int_equal(events.end, LAC_END_STOP);
    assert_true(events.max_slip_rate >= 1e-4 && events.max_slip_rate < 2e-4);
    how.stop_rate = NAN;
    how.stop_slip = 5e-6;
    events = run(&def, how, LAC_FIDELITY_ASYNC, 1e-8);
    lac_run_result ode = run(&def, how, LAC_FIDELITY_ODE, 1e-9);
    assert_int_equal(events.end, LAC_END_STOP);
    assert_true(fabs(events.mean_slip / 5e-6 - 1.0) < 1e-3);
    assert_true(fabs(events.time / ode.time - 1.0) < 1e-3);
}

static void refused(const tree_def *def, const char *why)
{
    tree t;
    lac_error err = {""};
    lac_run_result result;
    tree_create(def, &t);
    lac_run_def how = until(1e3);
    how.fidelity = LAC_FIDELITY_ASYNC;
    assert_int_equal(lac_run(t.problem, &how, NULL, &result, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, why));
    assert_int_equal(lac_run_check(t.problem, &how, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, why));
    tree_clear(&t);
}

static void refuses_what_it_cannot_follow(void **state)
{
    (void)state;
    tree_def def = tree_default(2, 3);
    def.law = "weakening";
    refused(&def, "aging and the slip law");
    def = tree_default(2, 3);
    def.v1 = 1.0;
    refused(&def, "cut-off");
    def = tree_default(2, 3);
    def.formulation = LAC_FORMULATION_TRACTION;
    refused(&def, "formulation rate");
    lac_model shear = test_slot_shear("sine");
    lac_load_models models = {.shear = &shear, .shear_count = 1};
    test_slot_set(&shear, "amplitude", 1.0);
    test_slot_set(&shear, "period", 1.0);
    def = tree_default(2, 3);
    def.loads = test_load_set(&models);
    refused(&def, "linear in time");
    lac_load_set_clear(&def.loads);
    lac_model_clear(&shear);
}

// A load that takes the traction away, at once or in milliseconds, is said to when it has.
static void says_when_the_traction_is_gone(void **state)
{
    (void)state;
    static const struct {
        const char *load, *key, *at;
        double value, since;
    } gone[] = {{"ramp", "rate", "start", -1e9, 0.0}, {"step", "value", "at", -1e9, 100.0}};
    for (size_t k = 0; k < sizeof gone / sizeof *gone; k++) {
        lac_model shear = test_slot_shear(gone[k].load);
        lac_load_models models = {.shear = &shear, .shear_count = 1};
        test_slot_set(&shear, gone[k].key, gone[k].value);
        test_slot_set(&shear, gone[k].at, gone[k].since);
        tree_def def = tree_default(3, 3);
        def.k0 = 0.1 * def.pressure * (def.b - def.a) / def.dc;
        def.loads = test_load_set(&models);
        tree t;
        tree_create(&def, &t);
        lac_run_def how = until(1e7);
        how.fidelity = LAC_FIDELITY_ASYNC;
        lac_error err = {""};
        lac_run_result result;
        assert_int_equal(lac_run(t.problem, &how, NULL, &result, &err), LAC_ENUMERIC);
        assert_non_null(strstr(err.message, "falls to nothing"));
        assert_true(result.time >= gone[k].since && result.time < gone[k].since + 1.0);
        assert_true(result.rhs_evaluations < 100);
        tree_clear(&t);
        lac_load_set_clear(&def.loads);
        lac_model_clear(&shear);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_cell_two_and_four_alike),
        cmocka_unit_test(nothing_slips),
        cmocka_unit_test(long_times),
        cmocka_unit_test(limits_end_it),
        cmocka_unit_test(refuses_what_it_cannot_follow),
        cmocka_unit_test(says_when_the_traction_is_gone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
