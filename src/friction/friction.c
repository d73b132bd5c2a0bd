// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/friction.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "friction/form.h"

enum { DERIVED_COLUMNS = 3 };

static size_t count_columns(const lac_descriptor *about)
{
    size_t count = 0;
    for (size_t i = 0; i < about->param_count; i++) {
        count += (about->params[i].flags & LAC_CELLWISE) != 0;
    }
    return count;
}

// The cell-wise parameter of that name and its column; NULL where there is none.
static const lac_param *find_column(const lac_descriptor *about, const char *key, size_t *column)
{
    *column = 0;
    for (size_t i = 0; i < about->param_count; i++) {
        const lac_param *param = &about->params[i];
        if ((param->flags & LAC_CELLWISE) == 0) {
            continue;
        }
        if (strcmp(param->key, key) == 0) {
            return param;
        }
        (*column)++;
    }
    return NULL;
}

static void derive(lac_friction *friction)
{
    double **column = friction->column;
    for (size_t i = 0; i < friction->n; i++) {
        double dc = column[LAC_DC][i], ln_v0 = log(column[LAC_V0][i]);
        double a = column[LAC_A][i], b = column[LAC_B][i];
        friction->ln_dc[i] = log(dc);
        friction->inv_dc[i] = fmin(1 / dc, DBL_MAX);
        friction->constant[i] = column[LAC_F0][i] + (b - a) * ln_v0 - b * friction->ln_dc[i];
    }
}

// All columns are parts of one array, which column[0] owns.
static lac_status allocate(lac_friction *friction, lac_error *err)
{
    size_t n = friction->n, columns = friction->columns;
    size_t row = (columns + DERIVED_COLUMNS) * sizeof(double);
    if (n > SIZE_MAX / row) {
        return lac_fail_memory(err);
    }
    friction->column = calloc(columns, sizeof *friction->column);
    double *all = calloc(n, row);
    if (friction->column == NULL || all == NULL) {
        free(all);
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < columns; i++) {
        friction->column[i] = all + i * n;
    }
    friction->constant = all + columns * n;
    friction->ln_dc = friction->constant + n;
    friction->inv_dc = friction->ln_dc + n;
    return LAC_OK;
}

static lac_status fill_from_slot(lac_friction *friction, const lac_slot *slot, lac_error *err)
{
    size_t column = 0;
    for (size_t i = 0; i < slot->about->param_count; i++) {
        const lac_param *param = &slot->about->params[i];
        if ((param->flags & LAC_CELLWISE) == 0) {
            continue;
        }
        double value;
        char why[128];
        memcpy(&value, (const char *)slot->params + param->offset, sizeof value);
        if (!lac_param_allows(param, value, why, sizeof why)) {
            return lac_fail(err, LAC_EINPUT, "%s.%s: %s", slot->about->name, param->key,
                            isnan(value) ? "must be given" : why);
        }
        for (size_t cell = 0; cell < friction->n; cell++) {
            friction->column[column][cell] = value;
        }
        column++;
    }
    return LAC_OK;
}

lac_status lac_friction_create(const lac_slot *slot, size_t n, lac_friction **out, lac_error *err)
{
    *out = NULL;
    if (slot->about == NULL) {
        return lac_fail(err, LAC_EINPUT, "no friction law is chosen");
    }
    const lac_friction_params *common = slot->params;
    if (n == 0) {
        return lac_fail(err, LAC_EINPUT, "friction needs at least one cell");
    }
    if (common->form != LAC_FORM_PLAIN && common->form != LAC_FORM_REGULARISED) {
        return lac_fail(err, LAC_EINPUT, "%s.form: must be plain or regularised",
                        slot->about->name);
    }
    lac_friction *friction = calloc(1, sizeof *friction);
    if (friction == NULL) {
        return lac_fail_memory(err);
    }
    // The descriptor is the first member of the law's row.
    friction->law = (const lac_friction_law *)(const void *)slot->about;
    friction->form = common->form;
    friction->n = n;
    friction->columns = count_columns(slot->about);

    lac_status status;
    LAC_TRY(allocate(friction, err));
    LAC_TRY(fill_from_slot(friction, slot, err));
    derive(friction);
    *out = friction;
    friction = NULL;
out:
    lac_friction_free(friction);
    return status;
}

void lac_friction_free(lac_friction *friction)
{
    if (friction == NULL) {
        return;
    }
    if (friction->column != NULL) {
        free(friction->column[0]);
    }
    free(friction->column);
    free(friction);
}

lac_status lac_friction_set(lac_friction *friction, const char *key, const double *values,
                            lac_error *err)
{
    const lac_descriptor *about = &friction->law->about;
    size_t column;
    const lac_param *param = find_column(about, key, &column);
    if (param == NULL) {
        return lac_fail(err, LAC_EINPUT, "%s has no parameter \"%s\" that may vary between cells",
                        about->name, key);
    }
    for (size_t i = 0; i < friction->n; i++) {
        char why[128];
        if (!lac_param_allows(param, values[i], why, sizeof why)) {
            return lac_fail(err, LAC_EINPUT, "%s.%s of cell %zu: %g %s", about->name, key, i,
                            values[i], why);
        }
    }
    memcpy(friction->column[column], values, friction->n * sizeof *values);
    derive(friction);
    return LAC_OK;
}

void lac_friction_evaluate(const lac_friction *friction, const lac_friction_cells *cells,
                           const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    assert(cells->n <= LAC_FRICTION_BLOCK && cells->first + cells->n <= friction->n);
    lac_form_evaluate(friction, cells->first, cells->n, cells->u, cells->w, values, slopes);
    friction->law->evolve(friction, cells, values->g, slopes == NULL ? NULL : slopes->g_u,
                          slopes == NULL ? NULL : slopes->g_w);
}

double lac_friction_coefficient(const lac_friction *friction, size_t cell, double u, double w)
{
    double f, f_u, f_w;
    lac_form_evaluate(friction, cell, 1, &u, &w,
                      &(lac_friction_values){.f = &f, .f_u = &f_u, .f_w = &f_w}, NULL);
    return f;
}

double lac_friction_steady_state(const lac_friction *friction, size_t cell, double u)
{
    return friction->law->steady_state(friction, cell, u);
}

double lac_friction_state_for(const lac_friction *friction, size_t cell, double u, double f)
{
    double a = friction->column[LAC_A][cell], b = friction->column[LAC_B][cell];
    double plain = lac_form_plain_of(friction, cell, f);
    return b > 0 ? (plain - friction->constant[cell] - a * u) / b : NAN;
}
