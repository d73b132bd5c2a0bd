// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade came to, as tables: the variables of its file, a row a run.
#include "data/describe.h"
#include "trade/trade.h"

#define HELD(kind, field) LAC_HELD(kind, lac_trade_row, field)
#define NUMBER(name, unit, long_name, field) \
    LAC_ROW(name, NULL, unit, long_name, HELD(REAL, field), .flags = LAC_MISSING)

static const lac_variable of_rows[] = {
    LAC_ROW("settings", NULL, NULL, "settings of the run, keys of its case", HELD(TEXT, settings)),
    LAC_ROW("end", NULL, NULL, "how it ended: done, broken, given up", HELD(TEXT, end)),
    NUMBER("error", NULL, "difference from the reference, relative", error),
    NUMBER("error_uncertainty", NULL, "error of the reference itself, relative", uncertainty),
    NUMBER("wall_time", "s", "time on the clock", wall_time),
    NUMBER("cpu_time", "s", "time of the processor", cpu_time),
    NUMBER("peak_memory", "byte", "largest resident memory", memory),
    NUMBER("output_size", "byte", "size of the run's file", output),
    NUMBER("steps", NULL, "steps of the integrator", steps),
    NUMBER("rhs_evaluations", NULL, "evaluations of the right-hand side", evaluations),
    LAC_ROW("on_front", NULL, NULL, "1: no other run errs and costs less; else 0",
            HELD(BOOL, on_front), .flags = LAC_WHOLE),
};

LAC_GETTER(double, value, const lac_trade_row *row = of, row[at[0]].value)
LAC_TEXT_GETTER(complete, (void)of, "complete")

#define VIEW(kind, field) LAC_HELD(kind, lac_trade_view, field)
static const lac_variable of_view[] = {
    {.name = "status", .text = complete},
    {.name = "quantity", VIEW(TEXT, quantity)},
    {.name = "quantity_unit", VIEW(TEXT, unit)},
    {.name = "quantity_long_name", VIEW(TEXT, about)},
    {.name = "reference_settings", VIEW(TEXT, reference)},
    {.name = "recommended_settings", VIEW(TEXT, recommended)},
    {.name = "recommendation", VIEW(TEXT, sentence)},
    {.name = "reference_value", VIEW(REAL, value)},
    {.name = "reference_uncertainty", VIEW(REAL, uncertainty)},
};

lac_status lac_trade_describe(const lac_trade_view *view, lac_dataset **out, lac_error *err)
{
    static const lac_variable quantity = {.dims = "run", .value = value, .flags = LAC_MISSING};
    const lac_named named = {
        .name = "value", .long_name = "quantity as the run has it", .unit = view->unit};
    const lac_extent runs = {"run", view->runs};
    const lac_laid laid[] = {{LAC_VARIABLES(of_view, "", 0), view},
                             {LAC_VARIABLES(of_rows, "run", sizeof(lac_trade_row)), view->row}};
    lac_dataset *d = NULL;
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_dataset_create(
        "Error against cost of a case at different settings: one run a row, measured in a process "
        "of its own, with the Pareto front and what is recommended.",
        &d, err));
    LAC_TRY(lac_dataset_dims(d, &runs, 1, err));
    LAC_TRY(lac_dataset_add(d, laid, sizeof laid / sizeof *laid, err));
    LAC_TRY(lac_dataset_add_named(d, &quantity, &named, view->row, err));
    *out = d;
    d = NULL;
out:
    lac_dataset_free(d);
    return status;
}
