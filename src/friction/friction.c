// SPDX-License-Identifier: GPL-3.0-or-later
// A friction law on many cells: parameters of each cell, and what kernels read instead of them.
#include "friction/friction.h"

#include <assert.h>

#include "friction/cutoff.h"
#include "friction/law.h"

static size_t count_columns(const lac_model_info *info)
{
    size_t count = 0;
    for (size_t i = 0; i < info->param_count; i++) {
        count += (info->params[i].flags & LAC_CELLWISE) != 0;
    }
    return count;
}

// The cell-wise parameter of that name and its column; NULL where there is none.
static const lac_param *find_column(const lac_model_info *info, const char *key, size_t *column)
{
    *column = 0;
    for (size_t i = 0; i < info->param_count; i++) {
        const lac_param *param = &info->params[i];
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

static double constant_of(const lac_friction *friction, size_t i)
{
    const lac_cellwise *column = friction->column;
    double ln_v0 = log(lac_cellwise_of(&column[LAC_V0], i));
    double a = lac_cellwise_of(&column[LAC_A], i), b = lac_cellwise_of(&column[LAC_B], i);
    return lac_cellwise_of(&column[LAC_F0], i) + (b - a) * ln_v0 -
           b * lac_cellwise_of(&friction->ln_dc, i);
}

static double ln_dc_of(const lac_friction *friction, size_t i)
{
    return log(lac_cellwise_of(&friction->column[LAC_DC], i));
}

static double inv_dc_of(const lac_friction *friction, size_t i)
{
    return fmin(1 / lac_cellwise_of(&friction->column[LAC_DC], i), DBL_MAX);
}

static double ln_v1_of(const lac_friction *friction, size_t i)
{
    return log(lac_cellwise_of(&friction->column[LAC_V1], i));
}

static double ln_cut_of(const lac_friction *friction, size_t i)
{
    return lac_cellwise_of(&friction->ln_dc, i) -
           log(lac_cellwise_of(&friction->column[LAC_V2], i));
}

// lac_friction_check sees to b = 0
static double response_of(const lac_friction *friction, size_t i)
{
    double alpha = lac_cellwise_of(&friction->column[LAC_ALPHA], i);
    return alpha > 0 ? alpha / lac_cellwise_of(&friction->column[LAC_B], i) : 0;
}

// What kernels read in the place of parameters; later rows use earlier ones.
static const struct {
    size_t offset; // of the column in lac_friction
    double (*value)(const lac_friction *, size_t);
    int from[5], count; // the parameters; an optional one stands first
} derived[] = {
    {offsetof(lac_friction, ln_dc), ln_dc_of, {LAC_DC}, 1},
    {offsetof(lac_friction, inv_dc), inv_dc_of, {LAC_DC}, 1},
    {offsetof(lac_friction, constant), constant_of, {LAC_F0, LAC_A, LAC_B, LAC_DC, LAC_V0}, 5},
    {offsetof(lac_friction, ln_v1), ln_v1_of, {LAC_V1}, 1},
    {offsetof(lac_friction, ln_cut), ln_cut_of, {LAC_V2, LAC_DC}, 2},
    {offsetof(lac_friction, response), response_of, {LAC_ALPHA, LAC_B}, 2},
};

enum { DERIVED_COLUMNS = sizeof derived / sizeof derived[0] };

static lac_cellwise *derived_column(lac_friction *friction, size_t row)
{
    return (lac_cellwise *)(void *)((char *)friction + derived[row].offset);
}

static size_t count_values(const lac_friction *friction, const lac_cellwise *column)
{
    bool alike = column->mask == 0 && friction->n > LAC_FRICTION_BLOCK;
    return alike ? LAC_FRICTION_BLOCK : friction->n;
}

// Makes room for what all cells have, or for what each has; what was there before is lost where
// that changes.
static lac_status allocate_column(const lac_friction *friction, bool alike, lac_cellwise *column,
                                  lac_error *err)
{
    lac_cellwise made = {.mask = alike ? 0 : SIZE_MAX};
    if (column->value != NULL && column->mask == made.mask) {
        return LAC_OK;
    }
    size_t count = count_values(friction, &made);
    made.value = count <= SIZE_MAX / sizeof(double) ? calloc(count, sizeof(double)) : NULL;
    LAC_FAIL_MEMORY_IF(made.value == NULL, err);
    free(column->value);
    *column = made;
    return LAC_OK;
}

static bool made_of_alike(const lac_friction *friction, size_t row)
{
    bool alike = true;
    for (int k = 0; k < derived[row].count; k++) {
        alike = alike && friction->column[derived[row].from[k]].mask == 0;
    }
    return alike;
}

static lac_status derive(lac_friction *friction, lac_error *err)
{
    for (size_t row = 0; row < DERIVED_COLUMNS; row++) {
        lac_cellwise *column = derived_column(friction, row);
        if (friction->column[derived[row].from[0]].value == NULL) {
            continue;
        }
        LAC_TRY_RETURN(allocate_column(friction, made_of_alike(friction, row), column, err));
        size_t count = count_values(friction, column);
        for (size_t i = 0; i < count; i++) {
            column->value[i] = derived[row].value(friction, i);
        }
    }
    return LAC_OK;
}

static lac_status fill_column(const lac_friction *friction, lac_cellwise *column, double value,
                              lac_error *err)
{
    lac_status status = allocate_column(friction, true, column, err);
    size_t count = count_values(friction, column);
    for (size_t i = 0; status == LAC_OK && i < count; i++) {
        column->value[i] = value;
    }
    return status;
}

static lac_status fill_from_slot(lac_friction *friction, const lac_model *model, lac_error *err)
{
    size_t column = 0;
    for (size_t i = 0; i < model->info->param_count; i++) {
        const lac_param *param = &model->info->params[i];
        if ((param->flags & LAC_CELLWISE) == 0) {
            continue;
        }
        size_t at = column++;
        double value;
        char why[128];
        memcpy(&value, (const char *)model->params + param->offset, sizeof value);
        if (isnan(value) && (param->flags & LAC_OPTIONAL) != 0) {
            continue;
        }
        LAC_FAIL_IF(!lac_param_allows(param, value, why, sizeof why), err, LAC_EINPUT, "%s.%s: %s",
                    model->info->name, param->key, isnan(value) ? "must be given" : why);
        LAC_TRY_RETURN(fill_column(friction, &friction->column[at], value, err));
    }
    const char *fault = model->info->validate != NULL ? model->info->validate(model->params) : NULL;
    return fault == NULL ? LAC_OK : lac_fail(err, LAC_EINPUT, "%s: %s", model->info->name, fault);
}

lac_status lac_friction_create(const lac_model *model, size_t n, lac_friction **out, lac_error *err)
{
    *out = NULL;
    LAC_FAIL_IF(model->info == NULL, err, LAC_EINPUT, "no friction law is chosen");
    const lac_friction_params *common = model->params;
    LAC_FAIL_IF(n == 0, err, LAC_EINPUT, "friction needs at least one cell");
    LAC_FAIL_IF(common->form != LAC_FORM_PLAIN && common->form != LAC_FORM_REGULARISED, err,
                LAC_EINPUT, "%s.form: must be plain or regularised", model->info->name);
    lac_friction *friction = *out = calloc(1, sizeof *friction);
    LAC_FAIL_MEMORY_IF(friction == NULL, err);
    // The descriptor is the first member of the law's row.
    friction->law = (const lac_friction_law *)(const void *)model->info;
    friction->form = common->form;
    friction->cohesion = common->cohesion > 0 ? common->cohesion : 0;
    friction->n = n;
    friction->columns = count_columns(model->info);

    lac_status status;
    friction->column = calloc(friction->columns, sizeof *friction->column);
    LAC_TRY(friction->column != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(fill_from_slot(friction, model, err));
    LAC_TRY(derive(friction, err));
out:
    LAC_MADE(status, out, lac_friction_free);
}

lac_status lac_friction_pick(const lac_friction *of, const uint32_t *cell, size_t n,
                             lac_friction **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_friction *friction = *out = calloc(1, sizeof *friction);
    LAC_FAIL_MEMORY_IF(friction == NULL, err);
    *friction = (lac_friction){.law = of->law,
                               .form = of->form,
                               .n = n,
                               .cohesion = of->cohesion,
                               .columns = of->columns,
                               .column = calloc(of->columns, sizeof *friction->column)};
    LAC_TRY(friction->column != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t k = 0; k < of->columns; k++) {
        const lac_cellwise *from = &of->column[k];
        lac_cellwise *to = &friction->column[k];
        if (from->value == NULL) {
            continue;
        }
        LAC_TRY(allocate_column(friction, from->mask == 0, to, err));
        const size_t count = count_values(friction, to);
        for (size_t i = 0; i < count; i++) {
            to->value[i] = lac_cellwise_of(from, from->mask == 0 ? 0 : cell[i]);
        }
    }
    LAC_TRY(derive(friction, err));
out:
    LAC_MADE(status, out, lac_friction_free);
}

void lac_friction_free(lac_friction *friction)
{
    if (friction == NULL) {
        return;
    }
    for (size_t i = 0; friction->column != NULL && i < friction->columns; i++) {
        free(friction->column[i].value);
    }
    free(friction->column);
    for (size_t row = 0; row < DERIVED_COLUMNS; row++) {
        free(derived_column(friction, row)->value);
    }
    free(friction);
}

lac_status lac_friction_set(lac_friction *friction, const char *key, const double *values,
                            lac_error *err)
{
    const lac_model_info *info = &friction->law->info;
    size_t column;
    const lac_param *param = find_column(info, key, &column);
    LAC_FAIL_IF(param == NULL, err, LAC_EINPUT,
                "%s has no parameter \"%s\" that may vary between cells", info->name, key);
    for (size_t i = 0; i < friction->n; i++) {
        char why[128];
        LAC_FAIL_IF(!lac_param_allows(param, values[i], why, sizeof why), err, LAC_EINPUT,
                    "%s.%s of cell %zu: %g %s", info->name, key, i, values[i], why);
    }
    LAC_TRY_RETURN(allocate_column(friction, false, &friction->column[column], err));
    memcpy(friction->column[column].value, values, friction->n * sizeof *values);
    return derive(friction, err);
}

const lac_cellwise *lac_friction_values_of(const lac_friction *friction, const char *key)
{
    size_t column;
    const lac_param *param = find_column(&friction->law->info, key, &column);
    bool given = param != NULL && friction->column[column].value != NULL;
    return given ? &friction->column[column] : NULL;
}

bool lac_friction_flashes(const lac_friction *friction)
{
    return friction->column[LAC_FLASH_RATE].value != NULL;
}

static const char flash_needs_both[] =
    "flash_rate and flash_friction go together: give both or neither";
static const char alpha_without_b[] = "alpha needs b > 0, through which the state acts on friction";

const char *lac_law_validate(const void *params)
{
    const lac_friction_params *p = params;
    if (isnan(p->flash_rate) != isnan(p->flash_friction)) {
        return flash_needs_both;
    }
    return p->alpha > 0 && !(p->b > 0) ? alpha_without_b : NULL;
}

lac_status lac_friction_check(const lac_friction *friction, lac_error *err)
{
    const lac_cellwise *column = friction->column;
    for (size_t i = 0; column[LAC_ALPHA].value != NULL && i < friction->n; i++) {
        double alpha = lac_cellwise_of(&column[LAC_ALPHA], i),
               b = lac_cellwise_of(&column[LAC_B], i);
        LAC_FAIL_IF(alpha > 0 && !(b > 0), err, LAC_EINPUT,
                    "%s: cell %zu has alpha = %g and b = %g: %s", friction->law->info.name, i,
                    alpha, b, alpha_without_b);
    }
    return LAC_OK;
}

void lac_friction_evaluate(const lac_friction *friction, const lac_friction_cells *cells,
                           const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    assert(cells->n <= LAC_FRICTION_BLOCK && cells->first + cells->n <= friction->n);
    if (values->f != NULL) {
        double by_u[LAC_FRICTION_BLOCK], by_w[LAC_FRICTION_BLOCK];
        lac_friction_values all = *values;
        if (all.f_u == NULL && (lac_cutoff_any(friction) || lac_friction_flashes(friction))) {
            all.f_u = by_u; // f itself needs them there
            all.f_w = by_w;
        }
        lac_form_evaluate(friction, cells->first, cells->n, cells->u, cells->w, &all, slopes);
        if (lac_friction_flashes(friction)) {
            lac_flash_weaken(friction, cells, &all, slopes);
        }
    }
    if (values->g == NULL) {
        return;
    }
    friction->law->evolve(friction, cells, values->g, slopes == NULL ? NULL : slopes->g_u,
                          slopes == NULL ? NULL : slopes->g_w);
    const double *each = cells->normal_rates;
    if (friction->response.value != NULL && (cells->normal_rate != 0 || each != NULL)) {
        // dtheta/dt -= (alpha/b) theta d ln(pressure)/dt
        const double *response = lac_cellwise_from(&friction->response, cells->first);
        for (size_t i = 0; i < cells->n; i++) {
            values->g[i] -= response[i] * (each != NULL ? each[i] : cells->normal_rate);
        }
    }
}

double lac_friction_coefficient(const lac_friction *friction, size_t cell, double u, double w)
{
    double f, f_u, f_w;
    lac_form_evaluate(friction, cell, 1, &u, &w,
                      &(lac_friction_values){.f = &f, .f_u = &f_u, .f_w = &f_w}, NULL);
    return lac_friction_flashes(friction) ? lac_flash_of(friction, cell, u, f) : f;
}

double lac_friction_state_for(const lac_friction *friction, size_t cell, double u, double f)
{
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&friction->column[LAC_B], cell);
    double cold = lac_friction_flashes(friction) ? lac_flash_before(friction, cell, u, f) : f;
    double plain = lac_form_plain_of(friction, cell, cold);
    if (!(b > 0)) {
        return NAN;
    }
    // F is linear in W: F = F(u, W = 0) + b W
    double rest =
        lac_cellwise_of(&friction->constant, cell) + a * lac_cutoff_rate(friction, cell, u);
    return lac_cutoff_state_of(friction, cell, (plain - rest) / b);
}
