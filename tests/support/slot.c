// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/slot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void test_slot_set(lac_model *model, const char *key, double value)
{
    for (size_t i = 0; i < model->info->param_count; i++) {
        const lac_param *param = &model->info->params[i];
        if (strcmp(param->key, key) != 0) {
            continue;
        }
        char *at = (char *)model->params + param->offset;
        if (param->type == LAC_CHOICE) {
            memcpy(at, &(int){(int)value}, sizeof(int));
        } else {
            memcpy(at, &value, sizeof value);
        }
        return;
    }
    (void)fprintf(stderr, "%s has no parameter %s\n", model->info->name, key);
    abort();
}

void test_slot_exponents(const lac_param *param, double *low, double *high)
{
    static const struct {
        const char *key;
        double low, high;
    } known[] = {{"f0", -1, 0.3}, {"a", -3, 0},   {"b", -3, 0},    {"dc", -7, 1},  {"v0", -9, 0},
                 {"v1", -12, 1},  {"v2", -12, 1}, {"m/s", -12, 2}, {"s", -12, 20}, {"m", -7, 1}};
    *low = -3;
    *high = 1;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(known[i].key, param->key) == 0 || strcmp(known[i].key, param->unit) == 0) {
            *low = known[i].low;
            *high = known[i].high;
            return;
        }
    }
}

void test_slot_fill(lac_model *model)
{
    for (size_t i = 0; i < model->info->param_count; i++) {
        const lac_param *own = &model->info->params[i];
        if (own->type == LAC_REAL && !lac_param_given(own, model->params) &&
            (own->flags & LAC_OPTIONAL) == 0) {
            double low, high;
            test_slot_exponents(own, &low, &high);
            double middle = pow(10, (low + high) / 2);
            test_slot_set(model, own->key, fmin(fmax(middle, own->min), own->max));
        }
    }
}

lac_model test_slot_shear(const char *name)
{
    lac_model model = {0};
    const lac_load_kind *kind;
    size_t i = 0;
    while ((kind = lac_shear_load_get(i)) != NULL && strcmp(kind->info.name, name) != 0) {
        i++;
    }
    if (kind == NULL || lac_model_create(&kind->info, &model, NULL) != LAC_OK) {
        (void)fprintf(stderr, "no shear load %s\n", name);
        abort();
    }
    return model;
}

lac_load_set test_load_set(const lac_load_models *models)
{
    lac_error err;
    lac_load_set set;
    if (lac_load_set_create(models, &(lac_load_clock){.end = NAN}, &set, &err) != LAC_OK) {
        (void)fprintf(stderr, "%s\n", err.message);
        abort();
    }
    return set;
}
