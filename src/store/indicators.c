// SPDX-License-Identifier: GPL-3.0-or-later
// Indicators in the file of forecasts: a variable for each number that was found.
#include "store/indicators.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NAME = 80, LONG_NAME = 160 };

typedef struct column {
    const lac_nc *file;
    const lac_forecast_file *content;
    int dim;
    size_t issues;
    double *row; // [issues]
} column;

static const lac_precursor *at(const column *c, size_t issue, size_t k)
{
    return &c->content->indicator[issue * c->content->indicators + k];
}

static lac_status put(const column *c, const lac_nc_var *var, lac_error *err)
{
    return lac_nc_reals(c->file, var, 1, &c->dim, 0, c->row, NULL, err);
}

// One number at all issue times; nothing where none has it.
static lac_status put_value(const column *c, size_t k, const lac_precursor_value *value,
                            lac_error *err)
{
    const lac_precursor_kind *kind = at(c, 0, k)->kind;
    char name[NAME];
    char long_name[LONG_NAME];
    bool any = false;
    for (size_t i = 0; i < c->issues; i++) {
        const double found = lac_precursor_find(at(c, i, k), value->key);
        c->row[i] = isfinite(found) ? found : NC_FILL_DOUBLE;
        any = any || isfinite(found);
    }
    (void)snprintf(name, sizeof name, "%s_%s", kind->about.name, value->key);
    (void)snprintf(long_name, sizeof long_name, "%s: %s", kind->about.name, value->text);
    const lac_nc_var var = {.name = name,
                            .unit = value->unit,
                            .long_name = long_name,
                            .comment = kind->estimator,
                            .coordinates = "issue_time",
                            .type = NC_DOUBLE,
                            .fill = true};
    return any ? put(c, &var, err) : LAC_OK;
}

static lac_status put_points(const column *c, size_t k, lac_error *err)
{
    const lac_precursor_kind *kind = at(c, 0, k)->kind;
    char name[NAME];
    char long_name[LONG_NAME];
    (void)snprintf(name, sizeof name, "%s_points", kind->about.name);
    (void)snprintf(long_name, sizeof long_name, "%s: what went into it", kind->about.name);
    for (size_t i = 0; i < c->issues; i++) {
        c->row[i] = (double)at(c, i, k)->found.points;
    }
    const lac_nc_var var = {.name = name,
                            .unit = "1",
                            .long_name = long_name,
                            .coordinates = "issue_time",
                            .type = NC_DOUBLE};
    return put(c, &var, err);
}

static bool has_points(const column *c, size_t k)
{
    bool any = false;
    for (size_t i = 0; i < c->issues; i++) {
        any = any || at(c, i, k)->found.points > 0;
    }
    return any;
}

lac_status lac_nc_indicators(const lac_nc *file, const lac_forecast_file *content, int dim,
                             size_t issues, lac_error *err)
{
    column c = {.file = file, .content = content, .dim = dim, .issues = issues};
    lac_status status;
    c.row = malloc((issues > 0 ? issues : 1) * sizeof *c.row);
    LAC_TRY(c.row != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t k = 0; k < content->indicators; k++) {
        const lac_precursor_kind *kind = at(&c, 0, k)->kind;
        for (size_t v = 0; v < kind->value_count; v++) {
            LAC_TRY(put_value(&c, k, &kind->value[v], err));
        }
        if (has_points(&c, k)) {
            LAC_TRY(put_points(&c, k, err));
        }
    }
out:
    free(c.row);
    return status;
}
