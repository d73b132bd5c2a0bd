// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a trade: a row a run.
#include "lacuna/store_trade.h"

#include <math.h>
#include <stdlib.h>

#include "store/nc.h"

// Where a number stands in a row.
static const struct {
    const char *name, *unit, *long_name;
    size_t offset;
} numbers[] = {
    {"value", NULL, "quantity as the run has it", offsetof(lac_trade_row, value)},
    {"error", "1", "difference from the reference, relative", offsetof(lac_trade_row, error)},
    {"error_uncertainty", "1", "error of the reference itself, relative",
     offsetof(lac_trade_row, uncertainty)},
    {"wall_time", "s", "time on the clock", offsetof(lac_trade_row, wall_time)},
    {"cpu_time", "s", "time of the processor", offsetof(lac_trade_row, cpu_time)},
    {"peak_memory", "byte", "largest resident memory", offsetof(lac_trade_row, memory)},
    {"output_size", "byte", "size of the run's file", offsetof(lac_trade_row, output)},
    {"steps", "1", "steps of the integrator", offsetof(lac_trade_row, steps)},
    {"rhs_evaluations", "1", "evaluations of the right-hand side",
     offsetof(lac_trade_row, evaluations)},
};

static lac_status put_number(const lac_nc *file, const lac_trade_view *view, size_t k, int dim,
                             double *values, lac_error *err)
{
    const lac_nc_var var = {.name = numbers[k].name,
                            .unit = numbers[k].unit != NULL ? numbers[k].unit : view->unit,
                            .long_name = numbers[k].long_name,
                            .type = NC_DOUBLE,
                            .fill = true};
    int id = 0;
    for (size_t i = 0; i < view->runs; i++) {
        const double value = *(const double *)((const char *)&view->row[i] + numbers[k].offset);
        values[i] = isfinite(value) ? value : NC_FILL_DOUBLE;
    }
    lac_status status = lac_nc_define(file, &var, 1, &dim, NULL, 0, &id, err);
    return status == LAC_OK ? lac_nc_check(file->path, nc_put_var_double(file->id, id, values), err,
                                           "write", numbers[k].name)
                            : status;
}

static lac_status put_texts(const lac_nc *file, const lac_trade_view *view, int dim,
                            const char *name, const char *long_name, size_t offset, lac_error *err)
{
    int id = 0;
    int code = nc_def_var(file->id, name, NC_STRING, 1, &dim, &id);
    lac_status status = lac_nc_check(file->path, code, err, "define", name);
    for (size_t i = 0; i < view->runs && status == LAC_OK; i++) {
        const char *text = *(const char *const *)((const char *)&view->row[i] + offset);
        code = nc_put_var1_string(file->id, id, &i, &text);
        status = lac_nc_check(file->path, code, err, "write", name);
    }
    return status == LAC_OK ? lac_nc_text(file, id, "long_name", long_name, err) : status;
}

static lac_status put_front(const lac_nc *file, const lac_trade_view *view, int dim, lac_error *err)
{
    const lac_nc_var var = {.name = "on_front",
                            .unit = "1",
                            .long_name = "1: no other run errs and costs less; else 0",
                            .type = NC_INT};
    int id = 0;
    lac_status status = lac_nc_define(file, &var, 1, &dim, NULL, 0, &id, err);
    for (size_t i = 0; i < view->runs && status == LAC_OK; i++) {
        const int on = view->row[i].on_front ? 1 : 0;
        status = lac_nc_check(file->path, nc_put_var1_int(file->id, id, &i, &on), err, "write",
                              "on_front");
    }
    return status;
}

static lac_status put_about(const lac_nc *file, const lac_trade_view *view, lac_error *err)
{
    const struct {
        const char *name, *text;
    } texts[] = {{"status", "complete"},
                 {"quantity", view->quantity},
                 {"quantity_unit", view->unit},
                 {"quantity_long_name", view->about},
                 {"reference_settings", view->reference},
                 {"recommended_settings", view->recommended},
                 {"recommendation", view->sentence}};
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        LAC_TRY(lac_nc_text(file, NC_GLOBAL, texts[i].name, texts[i].text, err));
    }
    LAC_TRY(lac_nc_real(file, NC_GLOBAL, "reference_value", view->value, err));
    if (isfinite(view->uncertainty)) {
        LAC_TRY(lac_nc_real(file, NC_GLOBAL, "reference_uncertainty", view->uncertainty, err));
    }
out:
    return status;
}

static lac_status put_rows(const lac_nc *file, const lac_trade_view *view, lac_error *err)
{
    lac_status status = LAC_OK;
    int dim = 0;
    double *values = malloc((view->runs + 1) * sizeof *values);
    if (values == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(lac_nc_dim(file, "run", view->runs, &dim, err));
    LAC_TRY(put_texts(file, view, dim, "settings", "settings of the run, keys of its case",
                      offsetof(lac_trade_row, settings), err));
    LAC_TRY(put_texts(file, view, dim, "end", "how it ended: done, broken, given up",
                      offsetof(lac_trade_row, end), err));
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
        LAC_TRY(put_number(file, view, k, dim, values, err));
    }
    LAC_TRY(put_front(file, view, dim, err));
out:
    free(values);
    return status;
}

static lac_status put_all(const lac_nc *file, void *view, lac_error *err)
{
    lac_status status = put_about(file, view, err);
    return status == LAC_OK ? put_rows(file, view, err) : status;
}

lac_status lac_store_trade(const char *path, bool force, const lac_provenance *provenance,
                           const lac_trade_view *view, lac_error *err)
{
    static const char *const summary =
        "Error against cost of a case at different settings: one run a row, measured in a process "
        "of its own, with the Pareto front and what is recommended.";
    lac_trade_view rows = *view;
    return lac_nc_write(path, force, provenance, summary, put_all, &rows, err);
}
