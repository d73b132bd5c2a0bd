// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of any model by the rows of its table: defaults, allowed ranges, what is to be freed.
#include "base/param.h"

static void *field(const lac_param *param, void *params) { return (char *)params + param->offset; }

void lac_param_reset(const lac_param *param, void *params)
{
    void *at = field(param, params);
    bool absent = isnan(param->fallback);
    switch (param->type) {
    case LAC_REAL:
        memcpy(at, &param->fallback, sizeof(double));
        break;
    case LAC_INTEGER:
        memcpy(at, &(int64_t){absent ? INT64_MIN : (int64_t)param->fallback}, sizeof(int64_t));
        break;
    case LAC_CHOICE:
        memcpy(at, &(int){absent ? -1 : (int)param->fallback}, sizeof(int));
        break;
    case LAC_TEXT:
    case LAC_PATH:
        memcpy(at, &(char *){NULL}, sizeof(char *));
        break;
    }
}

void lac_params_default(const lac_model_info *info, void *params)
{
    memset(params, 0, info->params_size);
    for (size_t i = 0; i < info->param_count; i++) {
        lac_param_reset(&info->params[i], params);
    }
}

bool lac_param_allows(const lac_param *param, double value, char *why, size_t size)
{
    const char *unit = strcmp(param->unit, "1") == 0 ? "" : param->unit;
    const char *gap = unit[0] == '\0' ? "" : " ";
    bool open = (param->flags & LAC_ABOVE_MIN) != 0;
    if (!isfinite(value)) {
        (void)snprintf(why, size, "must be a finite number");
        return false;
    }
    if (value < param->min || (open && value <= param->min)) {
        (void)snprintf(why, size, "must be %s %g%s%s", open ? ">" : ">=", param->min, gap, unit);
        return false;
    }
    if (value > param->max) {
        (void)snprintf(why, size, "must be <= %g%s%s", param->max, gap, unit);
        return false;
    }
    return true;
}

const lac_param *lac_param_find(const lac_param *params, size_t count, const char *key)
{
    size_t i = 0;
    while (i < count && strcmp(params[i].key, key) != 0) {
        i++;
    }
    return i < count ? &params[i] : NULL;
}

bool lac_param_required(const lac_param *param)
{
    return isnan(param->fallback) && (param->flags & LAC_OPTIONAL) == 0;
}

bool lac_param_given(const lac_param *param, const void *params)
{
    const void *at = (const char *)params + param->offset;
    switch (param->type) {
    case LAC_REAL:
        return !isnan(*(const double *)at);
    case LAC_INTEGER:
        return *(const int64_t *)at != INT64_MIN;
    case LAC_CHOICE:
        return *(const int *)at >= 0;
    case LAC_TEXT:
    case LAC_PATH:
        break;
    }
    return *(char *const *)at != NULL;
}

lac_status lac_model_create(const lac_model_info *info, lac_model *model, lac_error *err)
{
    model->info = info;
    model->params = calloc(1, info->params_size > 0 ? info->params_size : 1);
    if (model->params == NULL) {
        model->info = NULL;
        return lac_fail_memory(err);
    }
    lac_params_default(info, model->params);
    return LAC_OK;
}

void lac_model_clear(lac_model *model)
{
    if (model->info != NULL && model->params != NULL) {
        for (size_t i = 0; i < model->info->param_count; i++) {
            const lac_param *param = &model->info->params[i];
            if (param->type == LAC_TEXT || param->type == LAC_PATH) {
                free(*(char **)field(param, model->params));
            }
        }
    }
    free(model->params);
    *model = (lac_model){0};
}
