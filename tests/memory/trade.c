// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/trade.h"
#include "base/fail.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/simulation.h"
#include "store/store.h"
#include "trade/trade.h"

static const char block[] = "lacuna: 1\n"
                            "load: {normal: {pressure: 1e6}}\n"
                            "friction: {aging: {a: 0.01, b: 0.015, dc: 0.001}}\n"
                            "initial: {slip_rate: 1e-6, state: {ratio_to_steady: 0.5}}\n"
                            "time: {end: 10}\n";
static const char accurate[] = "solver: {accuracy: 0.1}\n";

static lac_status read_block(const char *more, lac_case **c, lac_error *err)
{
    char text[sizeof block + sizeof accurate];
    lac_case_issues report = {0};
    (void)snprintf(text, sizeof text, "%s%s", block, more);
    lac_status status = lac_case_read_text("case.yaml", text, strlen(text), NULL, c, &report, err);
    lac_case_issues_clear(&report);
    return status;
}

static lac_status store(const char *path, const lac_trade_plan *plan,
                        const lac_trade_measure *measure, const lac_trade_result *v, lac_error *err)
{
    const lac_provenance provenance = {.title = "traded", .seed = 1};
    const lac_trade_settings own = {0};
    lac_trade_settings *settings = calloc(plan->runs, sizeof *settings);
    if (settings == NULL) {
        return lac_fail_memory(err);
    }
    lac_trade_outcome outcome = {.sentence = "",
                                 .plan = plan,
                                 .measure = measure,
                                 .settings = settings,
                                 .own = &own,
                                 .verdict = v};
    lac_dataset *dataset = NULL;
    lac_status status = lac_trade_list(&outcome, err);
    if (status == LAC_OK) {
        status = lac_trade_describe(&outcome, &dataset, err);
    }
    if (status == LAC_OK) {
        status = lac_store_dataset(path, true, &provenance, dataset, err);
    }
    lac_dataset_free(dataset);
    lac_trade_outcome_clear(&outcome);
    free(settings);
    return status;
}

lac_status whole_trade(const char *path, lac_error *err)
{
    lac_status status;
    lac_case *c = NULL;
    lac_trade_plan plan = {0};
    lac_trade_result verdict = {0};
    lac_trade_measure *measure = NULL;
    const lac_trade_request ask = {.quantity = LAC_QUANTITY_SLIP, NAN, NAN, NAN};
    LAC_TRY(read_block("", &c, err));
    LAC_TRY(lac_trade_plan_create(c, LAC_OF_RUN, "rtol,method", true, &plan, err));
    measure = calloc(plan.runs, sizeof *measure);
    if (measure == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    for (size_t i = 0; i < plan.runs; i++) {
        measure[i].end = LAC_TRADE_DONE;
        measure[i].value[LAC_QUANTITY_SLIP] = 1.0 + 0.1 / (double)(i + 1);
        measure[i].cpu_time = (double)(i + 1);
    }
    LAC_TRY(lac_trade_judge(&plan, measure, &ask, &verdict, err));
    LAC_TRY(store(path, &plan, measure, &verdict, err));
out:
    free(measure);
    lac_trade_result_clear(&verdict);
    lac_trade_plan_clear(&plan);
    lac_case_free(c);
    return status;
}

lac_status whole_accuracy(const char *path, lac_error *err)
{
    lac_status status;
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    (void)path;
    LAC_TRY(read_block(accurate, &c, err));
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, err));
out:
    lac_simulation_free(simulation);
    lac_case_free(c);
    return status;
}
