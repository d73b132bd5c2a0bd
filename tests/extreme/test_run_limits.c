// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that end, jump or cannot go on: where exactly they end, and what they say.
#include <string.h>

#include <math.h>

#include "base/rng.h"
#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/slot.h"
#include "support/test.h"

static const lac_method methods[] = {LAC_BDF, LAC_ADAMS, LAC_ERK};

static lac_status run(const block_def *def, const lac_run_def *how, const lac_sink *sink,
                      lac_run_result *result, lac_error *err)
{
    block b;
    block_create(def, &b);
    *err = (lac_error){""};
    lac_status status = lac_run(b.problem, how, sink, result, err);
    block_clear(&b);
    return status;
}

// The last record stands on the limit, whatever the step that crossed it.
static void a_run_ends_on_its_limit(void **state)
{
    for (uint64_t i = 0; i < 300; i++) {
        double random[3];
        for (uint64_t k = 0; k < 3; k++) {
            random[k] = lac_random_uniform(3, LAC_STREAM_TEST, i, k);
        }
        block_def def = block_default(1.2 + random[0], 0.1 + 0.8 * random[1]);
        def.formulation = chosen(state);
        lac_run_def how = lac_run_default();
        how.method = methods[i % 3];
        how.rtol = pow(10.0, -2.0 - 3.0 * random[2]);
        how.end = 1e6;
        how.failure_rate = 1e3;
        history h = {0};
        lac_sink sink = history_sink(&h);
        lac_run_result result;
        lac_error err;
        assert_int_equal(run(&def, &how, &sink, &result, &err), LAC_OK);
        assert_true(result.failed);
        double last = h.line[h.n - 1].observation.mean_rate;
        assert_true(last >= 1e3 * (1.0 - 1e-12) && last < 1e3 * (1.0 + 1e-9));
        history_clear(&h);
    }
}

// Steady creep crosses a slip limit in the midst of an enormous step.
static void a_limit_on_slip_is_met(void **state)
{
    for (size_t i = 0; i < 3; i++) {
        block_def def = block_default(0.5, 1.0);
        def.formulation = chosen(state);
        lac_run_def how = lac_run_default();
        how.method = methods[i];
        how.end = 1e9;
        how.failure_rate = 1e3;
        how.stop_slip = 12345.678;
        lac_run_result result;
        lac_error err;
        assert_int_equal(run(&def, &how, NULL, &result, &err), LAC_OK);
        assert_int_equal(result.end, LAC_END_STOP);
        assert_true(fabs(result.mean_slip / how.stop_slip - 1.0) < 1e-12);
        assert_true(fabs(result.time / how.stop_slip - 1.0) < 1e-9); // at 1 m/s
    }
}

typedef struct jump {
    double time, size;
} jump;

static void add_jump(const lac_load *load, double t, lac_load_state *sum)
{
    const jump *j = load->params;
    sum->ratio += t < j->time ? 0.0 : j->size;
}

static double jump_break(const lac_load *load, double t)
{
    const jump *j = load->params;
    return t < j->time ? j->time : INFINITY;
}

static const lac_load_kind jump_kind = {
    .info = {.name = "jump"}, .add = add_jump, .next_break = jump_break};

// A jump that lifts the slip rate over the limit is the failure; the record shows it.
static void a_jump_can_be_the_failure(void **state)
{
    const double m[] = {0.5, 1.5};
    for (size_t i = 0; i < 6; i++) {
        jump j = {.time = 2.0, .size = 0.3};
        lac_model model = {.info = &jump_kind.info, .params = &j};
        block_def def = block_default(m[i % 2], 1.1);
        def.formulation = chosen(state);
        def.shear = &model;
        def.shear_count = 1;
        lac_run_def how = lac_run_default();
        how.method = methods[i / 2];
        how.end = 100.0;
        how.failure_rate = 1e3;
        history h = {0};
        lac_sink sink = history_sink(&h);
        lac_run_result result;
        lac_error err;
        assert_int_equal(run(&def, &how, &sink, &result, &err), LAC_OK);
        assert_true(result.failed);
        assert_true(result.time == 2.0);
        double last = h.line[h.n - 1].observation.mean_rate;
        assert_true(last > 1e12 && result.max_slip_rate == last); // e^30 times the rate before
        history_clear(&h);
    }
}

// A load that is taken away ends in one clear error, not in a run called complete.
static void a_reversed_load_is_refused(void **state)
{
    (void)state;
    for (int form = 0; form < 2; form++) {
        for (size_t i = 0; i < 3; i++) {
            lac_model model = test_slot_shear("ramp");
            test_slot_set(&model, "rate", -1e3);
            block_def def = block_default(1.5, 1.1);
            def.formulation = LAC_FORMULATION_RATE;
            def.form = form;
            def.shear = &model;
            def.shear_count = 1;
            lac_run_def how = lac_run_default();
            how.method = methods[i];
            how.end = 1e4;
            how.failure_rate = 1e3;
            lac_run_result result;
            lac_error err;
            assert_int_equal(run(&def, &how, NULL, &result, &err), LAC_ENUMERIC);
            assert_non_null(strstr(err.message, "shear traction of cell 0"));
            // f0 p is gone after 600 s; steps are long there
            assert_true(result.time > 590.0 && result.time < 800.0);
            lac_model_clear(&model);
        }
    }
}

// What a run cannot start from is the request's fault.
static void a_start_beyond_a_limit_is_refused(void **state)
{
    block_def def = block_default(1.5, 0.9);
    def.formulation = chosen(state);
    lac_run_result result;
    lac_error err;
    lac_run_def how = lac_run_default();
    how.end = 1.0;
    how.failure_rate = 0.5;
    assert_int_equal(run(&def, &how, NULL, &result, &err), LAC_EINPUT);
    how.failure_rate = 1e3;
    how.stop_rate = 0.5;
    assert_int_equal(run(&def, &how, NULL, &result, &err), LAC_EINPUT);
}

typedef struct counter {
    double last;
    int count, repeated;
} counter;

static lac_status count_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    counter *c = context;
    (void)err;
    c->repeated += c->count > 0 && snapshot->time <= c->last;
    c->last = snapshot->time;
    c->count++;
    return LAC_OK;
}

// Snapshots by time come once each, the end included.
static void snapshots_come_once(void **state)
{
    block_def def = block_default(0.5, 1.0);
    def.formulation = chosen(state);
    lac_run_def how = lac_run_default();
    how.end = 10.0;
    how.failure_rate = 1e3;
    how.snapshots = true;
    how.snapshot = (lac_cadence){.time = 1.0, .per_decade = NAN};
    counter c = {0};
    lac_sink sink = {.context = &c, .snapshot = count_snapshot};
    lac_run_result result;
    lac_error err;
    assert_int_equal(run(&def, &how, &sink, &result, &err), LAC_OK);
    assert_int_equal(c.count, 11);
    assert_int_equal(c.repeated, 0);
}

static bool at_once(void *context)
{
    (void)context;
    return true;
}

// Millions of records within one step do not keep an interrupt waiting.
static void an_interrupt_is_heard_between_records(void **state)
{
    block_def def = block_default(0.5, 1.0);
    def.formulation = chosen(state);
    lac_run_def how = lac_run_default();
    how.end = 1e9;
    how.failure_rate = 1e3;
    how.record = (lac_cadence){.time = 1e-9, .per_decade = NAN};
    how.interrupted = at_once;
    history h = {0};
    lac_sink sink = history_sink(&h);
    lac_run_result result;
    lac_error err;
    assert_int_equal(run(&def, &how, &sink, &result, &err), LAC_EINTERRUPT);
    assert_int_equal(result.end, LAC_END_INTERRUPT);
    assert_true(h.n < 10);
    history_clear(&h);
}

// A first step far beyond the failure does not leap over it.
static void a_huge_first_step_is_cut(void **state)
{
    for (size_t i = 0; i < 3; i++) {
        block_def def = block_default(1.5, 0.5);
        def.formulation = chosen(state);
        lac_run_def how = lac_run_default();
        how.method = methods[i];
        how.end = 1e12;
        how.first_step = 1e11;
        how.failure_rate = 1e3;
        lac_run_result result;
        lac_error err;
        assert_int_equal(run(&def, &how, NULL, &result, &err), LAC_OK);
        assert_true(result.failed && result.time < 10.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOR_EACH_FORMULATION(a_run_ends_on_its_limit),
        FOR_EACH_FORMULATION(a_limit_on_slip_is_met),
        FOR_EACH_FORMULATION(a_jump_can_be_the_failure),
        cmocka_unit_test(a_reversed_load_is_refused),
        FOR_EACH_FORMULATION(a_start_beyond_a_limit_is_refused),
        FOR_EACH_FORMULATION(snapshots_come_once),
        FOR_EACH_FORMULATION(an_interrupt_is_heard_between_records),
        FOR_EACH_FORMULATION(a_huge_first_step_is_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
