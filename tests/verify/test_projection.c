// SPDX-License-Identifier: GPL-3.0-or-later
// The traction balance of a run in each formulation, projection onto it, and that neither that nor
// anything else that is only written acts back on the run.
#include <stdio.h>
#include <string.h>

#include <math.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/slider.h"
#include "support/test.h"
#include "support/tree.h"

static const lac_method methods[] = {LAC_BDF, LAC_ADAMS, LAC_ERK};

// To failure on strongly coupled cells: the same time in every formulation, and what each makes of
// the balance, integrated and projected onto it.
static void balance_and_projection(void **state)
{
    (void)state;
    double time[3][2];
    double residual[3][2];
    for (size_t f = 0; f < 3; f++) {
        for (int projected = 0; projected < 2; projected++) {
            tree_def def = tree_default(4, 2);
            def.state *= 3.0;
            def.formulation = block_formulations[f];
            tree t;
            tree_create(&def, &t);
            lac_run_def how = lac_run_default();
            how.rtol = 1e-7;
            how.end = 1e10;
            how.failure_rate = 1e3;
            how.stop_rate = 0.5;
            how.projection = projected;
            lac_run_result result;
            lac_error err = {""};
            assert_int_equal(lac_run(t.problem, &how, NULL, &result, &err), LAC_OK);
            time[f][projected] = result.time;
            residual[f][projected] = result.balance_residual;
            tree_clear(&t);
        }
        printf("unknown %zu: residual %.1e, projected %.1e\n", f, residual[f][0], residual[f][1]);
        assert_true(time[f][1] == time[f][0]); // what is written does not act back
        assert_true(fabs(time[f][0] / time[0][0] - 1.0) < 1e-5);
    }
    assert_true(residual[0][0] > 1e-7 && residual[0][1] < 1e-3 * residual[0][0]);
    assert_true(residual[1][1] < 1e-3 * residual[1][0] || residual[1][0] < 1e-8);
    assert_true(residual[2][0] < 1e-13 && residual[2][1] == residual[2][0]);
}

// What is kept of the tractions at the end, relative to the strength.
typedef struct kept {
    double traction[256];
    size_t n;
} kept;

static lac_status keep_traction(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    kept *k = context;
    (void)err;
    memcpy(k->traction, snapshot->traction, k->n * sizeof *k->traction);
    return LAC_OK;
}

static void keep_last(lac_formulation formulation, double rtol, int projection, kept *k)
{
    tree_def def = tree_default(4, 2);
    def.state *= 3.0;
    def.formulation = formulation;
    tree t;
    tree_create(&def, &t);
    k->n = t.domain->n;
    assert_true(k->n <= sizeof k->traction / sizeof k->traction[0]);
    lac_run_def how = lac_run_default();
    how.rtol = rtol;
    how.end = 1e10;
    how.failure_rate = 1e3;
    how.stop_rate = 0.5; // where cells differ most
    how.projection = projection;
    how.snapshots = true;
    lac_sink sink = {.context = k, .snapshot = keep_traction};
    lac_run_result result;
    lac_error err = {""};
    assert_int_equal(lac_run(t.problem, &how, &sink, &result, &err), LAC_OK);
    for (size_t i = 0; i < k->n; i++) {
        k->traction[i] /= 0.6 * t.domain->pressure[i];
    }
    tree_clear(&t);
}

// Against a tight run that keeps the balance: projection brings the tractions of single cells
// nearer, by as much as slip was at fault; the other half of the drift is in the states. With
// traction as the unknown there is nothing to bring back.
static void tractions_of_single_cells(void **state)
{
    (void)state;
    kept want, raw, projected, solved;
    keep_last(LAC_FORMULATION_SLIP, 1e-9, 0, &want);
    keep_last(LAC_FORMULATION_RATE, 1e-5, 0, &raw);
    keep_last(LAC_FORMULATION_RATE, 1e-5, 1, &projected);
    keep_last(LAC_FORMULATION_TRACTION, 1e-5, 0, &solved);
    double off[3] = {0};
    for (size_t i = 0; i < want.n; i++) {
        off[0] = fmax(off[0], fabs(raw.traction[i] - want.traction[i]));
        off[1] = fmax(off[1], fabs(projected.traction[i] - want.traction[i]));
        off[2] = fmax(off[2], fabs(solved.traction[i] - want.traction[i]));
    }
    printf("tractions off by %.1e of the strength, projected %.1e, as unknown %.1e\n", off[0],
           off[1], off[2]);
    assert_true(off[1] < 0.8 * off[0]);
    assert_true(off[2] < 0.1 * off[0]);
}

// Solves begin from the last rates, but what is recorded leaves none behind: bit for bit the same.
static void records_do_not_act_back(void **state)
{
    for (size_t m = 0; m < 3; m++) {
        double slip[2];
        int64_t steps[2];
        for (int often = 0; often < 2; often++) {
            slider s;
            slider_create(chosen(state), &s);
            lac_run_def how = slider_run();
            how.method = methods[m];
            how.rtol = 1e-5;
            how.end = 2e7;
            how.record.steps = often ? 1 : 0;
            how.record.time = often ? 12345.0 : NAN;
            how.projection = often;
            lac_error err = {""};
            lac_problem *problem;
            lac_run_result result;
            assert_int_equal(lac_problem_create(&s.problem_def, &problem, &err), LAC_OK);
            assert_int_equal(lac_run(problem, &how, NULL, &result, &err), LAC_OK);
            lac_problem_free(problem);
            slip[often] = result.mean_slip;
            steps[often] = result.steps;
            slider_clear(&s);
        }
        assert_true(slip[0] == slip[1] && steps[0] == steps[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balance_and_projection),
        cmocka_unit_test(tractions_of_single_cells),
        FOR_EACH_FORMULATION(records_do_not_act_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
