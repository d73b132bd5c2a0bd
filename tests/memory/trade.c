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

lac_status whole_trade(const char *path, lac_error *err)
{
    lac_status status;
    lac_case *c = NULL;
    lac_trade trade = {0};
    lac_dataset *dataset = NULL;
    const lac_provenance provenance = {.title = "traded", .seed = 1};
    const lac_trade_request ask = {.quantity = LAC_QUANTITY_SLIP, NAN, NAN, NAN};
    LAC_TRY(read_block("", &c, err));
    LAC_TRY(lac_trade_create(c, LAC_OF_RUN, "rtol,method", true, &trade, err));
    for (size_t i = 0; i < trade.runs; i++) {
        trade.run[i].end = LAC_TRADE_DONE;
        trade.run[i].m.value[LAC_QUANTITY_SLIP] = 1.0 + 0.1 / (double)(i + 1);
        trade.run[i].m.cpu_time = (double)(i + 1);
    }
    LAC_TRY(lac_trade_judge(&trade, &ask, err));
    LAC_TRY(lac_trade_describe(&trade, &dataset, err));
    LAC_TRY(lac_store_dataset(path, true, &provenance, dataset, err));
out:
    lac_dataset_free(dataset);
    lac_trade_clear(&trade);
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
