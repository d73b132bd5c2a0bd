// SPDX-License-Identifier: GPL-3.0-or-later
// Fidelity `events`, each cell at steps of its own, against `ode`, all cells at every step, where
// cells slip one by one (k_0 = 0.15 k_crit).
#include <stdio.h>
#include <stdlib.h>

#include <math.h>

#include "lacuna/simulation.h"
#include "support/slot.h"
#include "support/test.h"
#include "support/tree.h"

#define MOVES 1e-3

// The cells that came to MOVES, and what they slipped while above half of it.
typedef struct slips {
    size_t n, count;
    unsigned char *moves;
    double *since;
    double slip;
} slips;

static lac_status on_step(void *context, const lac_step *step, lac_error *err)
{
    (void)err;
    slips *s = context;
    size_t count = step->changed != NULL ? step->changes : step->n;
    for (size_t k = 0; k < count; k++) {
        size_t i = step->changed != NULL ? step->changed[k] : k;
        double v = fabs(step->slip_rate[i]);
        if (!s->moves[i] && v >= MOVES) {
            s->moves[i] = 1;
            s->since[i] = step->slip[i];
            s->count++;
        } else if (s->moves[i] && v < 0.5 * MOVES) {
            s->moves[i] = 0;
            s->slip += step->slip[i] - s->since[i];
        }
    }
    return LAC_OK;
}

typedef struct outcome {
    lac_run_result result;
    size_t slips;
    double slip;
} outcome;

static outcome run(const tree *t, lac_run_def how, lac_fidelity fidelity, double rtol)
{
    slips s = {.n = t->domain->n};
    s.moves = calloc(s.n, 1);
    s.since = calloc(s.n, sizeof *s.since);
    lac_sink sink = {.context = &s, .step = on_step};
    lac_error err = {""};
    outcome out = {0};
    how.fidelity = fidelity;
    how.rtol = rtol;
    how.record.steps = 0;
    lac_status status = lac_run(t->problem, &how, &sink, &out.result, &err);
    if (status != LAC_OK) {
        fail_msg("run: %s", err.message);
    }
    out.slips = s.count;
    out.slip = s.slip;
    free(s.moves);
    free(s.since);
    return out;
}

static tree_def soft(int levels, uint64_t seed)
{
    tree_def def = tree_default(levels, seed);
    def.k0 = 0.15 * def.pressure * (def.b - def.a) / def.dc;
    return def;
}

static lac_run_def until_failure(void)
{
    lac_run_def how = lac_run_default();
    how.end = 1e10;
    how.failure_rate = 1.0;
    return how;
}

// The time of failure, to which cells one after the other have handed their load on, converges to
// that of ode; so do the number of slips and what they amount to.
static void converges_to_ode(void **state)
{
    (void)state;
    tree_def def = soft(3, 14);
    tree t;
    tree_create(&def, &t);
    outcome ode = run(&t, until_failure(), LAC_FIDELITY_ODE, 1e-8);
    assert_true(ode.result.failed);
    double off[3];
    for (int i = 0; i < 3; i++) {
        outcome events = run(&t, until_failure(), LAC_FIDELITY_ASYNC, pow(100.0, -2 - i));
        assert_true(events.result.failed);
        off[i] = events.result.time / ode.result.time - 1.0;
        printf("%zu cells, rtol 1e-%d: failure off by %.1e, %zu slips of %zu, %.1e in slip\n",
               t.domain->n, 4 + 2 * i, off[i], events.slips, ode.slips,
               events.slip / ode.slip - 1.0);
        assert_true(fabs((double)events.slips - (double)ode.slips) <= 0.1 * (double)ode.slips);
    }
    assert_true(fabs(off[1]) < 3e-3 && fabs(off[2]) < 3e-4);
    assert_true(fabs(off[2]) < fabs(off[0]));
    tree_clear(&t);
}

static void follows(const tree_def *def, const lac_run_def *how, double within)
{
    tree t;
    tree_create(def, &t);
    outcome ode = run(&t, *how, LAC_FIDELITY_ODE, 1e-7);
    outcome events = run(&t, *how, LAC_FIDELITY_ASYNC, 1e-8);
    printf("%s: time %.6g and %.6g, %zu and %zu slips, mean slip %.6g and %.6g\n", def->law,
           events.result.time, ode.result.time, events.slips, ode.slips, events.result.mean_slip,
           ode.result.mean_slip);
    assert_int_equal(events.result.end, ode.result.end);
    assert_true(fabs(events.result.time / ode.result.time - 1.0) < within);
    assert_true(fabs((double)events.slips - (double)ode.slips) <= 1.0 + 0.05 * (double)ode.slips);
    tree_clear(&t);
}

static void follows_the_slip_law_and_the_regularised_form(void **state)
{
    (void)state;
    tree_def def = soft(2, 3);
    lac_run_def how = until_failure();
    def.form = LAC_FORM_REGULARISED;
    def.formulation = LAC_FORMULATION_RATE;
    follows(&def, &how, 1e-3);
    def.law = "slip";
    // Above steady state somewhat, where the slip law weakens with slip.
    def.state *= 2.0;
    follows(&def, &how, 1e-3);
}

// A spring pulled and a ramp that ends, a step, pore pressure: loads that are linear in pieces.
static void follows_loads(void **state)
{
    (void)state;
    lac_model shear[3] = {test_slot_shear("spring"), test_slot_shear("ramp"),
                          test_slot_shear("step")};
    tree_def def = soft(3, 14);
    test_slot_set(&shear[0], "stiffness", 1e8);
    test_slot_set(&shear[0], "speed", 1e-6);
    test_slot_set(&shear[1], "rate", 100.0);
    test_slot_set(&shear[1], "end", 1000.0);
    test_slot_set(&shear[2], "value", 1e4);
    test_slot_set(&shear[2], "at", 500.0);
    lac_load_models models = {.shear = shear, .shear_count = 3};
    def.loads = test_load_set(&models);
    lac_run_def how = lac_run_default();
    how.end = 1500.0;
    how.failure_rate = 1e3;
    follows(&def, &how, 1e-12);
    lac_load_set_clear(&def.loads);
    for (int i = 0; i < 3; i++) {
        lac_model_clear(&shear[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(converges_to_ode),
        cmocka_unit_test(follows_the_slip_law_and_the_regularised_form),
        cmocka_unit_test(follows_loads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
