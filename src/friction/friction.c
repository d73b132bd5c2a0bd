// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/friction.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "friction/cutoff.h"
#include "friction/form.h"
#include "friction/law.h"

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

// What an optional column is turned into for the kernels.
static double derived_value(const lac_friction *friction, int column, size_t i)
{
    double given = friction->column[column][i];
    switch (column) {
    case LAC_V1:
        return log(given);
    case LAC_V2:
        return friction->ln_dc[i] - log(given);
    default: // LAC_ALPHA; lac_friction_check sees to b = 0
        return given > 0 ? given / friction->column[LAC_B][i] : 0;
    }
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
    double *optional[] = {friction->ln_v1, friction->ln_cut, friction->response};
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; optional[k] != NULL && i < friction->n; i++) {
            optional[k][i] = derived_value(friction, LAC_V1 + k, i);
        }
    }
}

static lac_status allocate_cells(size_t n, size_t rows, double **out, lac_error *err)
{
    *out = n <= SIZE_MAX / (rows * sizeof **out) ? calloc(n, rows * sizeof **out) : NULL;
    return *out != NULL ? LAC_OK : lac_fail_memory(err);
}

// A column, and what the kernels make of it where it is optional.
static lac_status allocate_column(lac_friction *friction, size_t column, lac_error *err)
{
    double **made = column == LAC_V1      ? &friction->ln_v1
                    : column == LAC_V2    ? &friction->ln_cut
                    : column == LAC_ALPHA ? &friction->response
                                          : NULL;
    lac_status status = LAC_OK;
    if (friction->column[column] == NULL) {
        LAC_TRY(allocate_cells(friction->n, 1, &friction->column[column], err));
    }
    if (made != NULL && *made == NULL) {
        LAC_TRY(allocate_cells(friction->n, 1, made, err));
    }
out:
    return status;
}

// constant owns ln_dc and inv_dc too.
static lac_status allocate(lac_friction *friction, lac_error *err)
{
    friction->column = calloc(friction->columns, sizeof *friction->column);
    if (friction->column == NULL) {
        return lac_fail_memory(err);
    }
    lac_status status = allocate_cells(friction->n, DERIVED_COLUMNS, &friction->constant, err);
    if (status == LAC_OK) {
        friction->ln_dc = friction->constant + friction->n;
        friction->inv_dc = friction->ln_dc + friction->n;
    }
    return status;
}

static lac_status fill_column(lac_friction *friction, size_t column, double value, lac_error *err)
{
    lac_status status = allocate_column(friction, column, err);
    for (size_t cell = 0; status == LAC_OK && cell < friction->n; cell++) {
        friction->column[column][cell] = value;
    }
    return status;
}

static lac_status fill_from_slot(lac_friction *friction, const lac_slot *slot, lac_error *err)
{
    size_t column = 0;
    for (size_t i = 0; i < slot->about->param_count; i++) {
        const lac_param *param = &slot->about->params[i];
        if ((param->flags & LAC_CELLWISE) == 0) {
            continue;
        }
        size_t at = column++;
        double value;
        char why[128];
        memcpy(&value, (const char *)slot->params + param->offset, sizeof value);
        if (isnan(value) && (param->flags & LAC_OPTIONAL) != 0) {
            continue;
        }
        if (!lac_param_allows(param, value, why, sizeof why)) {
            return lac_fail(err, LAC_EINPUT, "%s.%s: %s", slot->about->name, param->key,
                            isnan(value) ? "must be given" : why);
        }
        lac_status status = fill_column(friction, at, value, err);
        if (status != LAC_OK) {
            return status;
        }
    }
    const char *fault = slot->about->fault != NULL ? slot->about->fault(slot->params) : NULL;
    return fault == NULL ? LAC_OK : lac_fail(err, LAC_EINPUT, "%s: %s", slot->about->name, fault);
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
    for (size_t i = 0; friction->column != NULL && i < friction->columns; i++) {
        free(friction->column[i]);
    }
    free(friction->column);
    free(friction->constant);
    free(friction->ln_v1);
    free(friction->ln_cut);
    free(friction->response);
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
    lac_status status = allocate_column(friction, column, err);
    if (status == LAC_OK) {
        memcpy(friction->column[column], values, friction->n * sizeof *values);
        derive(friction);
    }
    return status;
}

const double *lac_friction_values_of(const lac_friction *friction, const char *key)
{
    size_t column;
    const lac_param *param = find_column(&friction->law->about, key, &column);
    return param != NULL ? friction->column[column] : NULL;
}

static const char alpha_without_b[] = "alpha needs b > 0, through which the state acts on friction";

const char *lac_law_fault(const void *params)
{
    const lac_friction_params *p = params;
    return p->alpha > 0 && !(p->b > 0) ? alpha_without_b : NULL;
}

lac_status lac_friction_check(const lac_friction *friction, lac_error *err)
{
    const double *alpha = friction->column[LAC_ALPHA], *b = friction->column[LAC_B];
    for (size_t i = 0; alpha != NULL && i < friction->n; i++) {
        if (alpha[i] > 0 && !(b[i] > 0)) {
            return lac_fail(err, LAC_EINPUT, "%s: cell %zu has alpha = %g and b = %g: %s",
                            friction->law->about.name, i, alpha[i], b[i], alpha_without_b);
        }
    }
    return LAC_OK;
}

void lac_friction_evaluate(const lac_friction *friction, const lac_friction_cells *cells,
                           const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    assert(cells->n <= LAC_FRICTION_BLOCK && cells->first + cells->n <= friction->n);
    if (values->f != NULL) {
        lac_form_evaluate(friction, cells->first, cells->n, cells->u, cells->w, values, slopes);
    }
    friction->law->evolve(friction, cells, values->g, slopes == NULL ? NULL : slopes->g_u,
                          slopes == NULL ? NULL : slopes->g_w);
    if (friction->response != NULL && cells->normal_rate != 0) {
        // dtheta/dt -= (alpha/b) theta d ln(pressure)/dt
        const double *response = friction->response + cells->first;
        for (size_t i = 0; i < cells->n; i++) {
            values->g[i] -= response[i] * cells->normal_rate;
        }
    }
}

double lac_friction_coefficient(const lac_friction *friction, size_t cell, double u, double w)
{
    double f, f_u, f_w;
    lac_form_evaluate(friction, cell, 1, &u, &w,
                      &(lac_friction_values){.f = &f, .f_u = &f_u, .f_w = &f_w}, NULL);
    return f;
}

double lac_friction_state_for(const lac_friction *friction, size_t cell, double u, double f)
{
    double a = friction->column[LAC_A][cell], b = friction->column[LAC_B][cell];
    double plain = lac_form_plain_of(friction, cell, f);
    if (!(b > 0)) {
        return NAN;
    }
    // F is linear in W: F = F(u, W = 0) + b W
    double rest = friction->constant[cell] + a * lac_cutoff_rate(friction, cell, u);
    return lac_cutoff_state_of(friction, cell, (plain - rest) / b);
}
