// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/laws.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/rng.h"
#include "base/vmath.h"
#include "support/slot.h"
#include "support/test.h"

double laws_uniform(uint64_t i, uint64_t what, double low, double high)
{
    return low + (high - low) * lac_random_uniform(11, LAC_STREAM_TEST, i, what);
}

double laws_biased(uint64_t i, uint64_t what, double low, double high)
{
    double side = laws_uniform(i, what + 100, 0, 8);
    return side < 1 ? low : side < 2 ? high : laws_uniform(i, what, low, high);
}

lac_friction *laws_make(const variant *kind, size_t n, double a, double b, double dc)
{
    lac_model model;
    lac_friction *friction = NULL;
    const lac_model_info *info = &lac_friction_law_get(kind->law)->info;
    assert_int_equal(lac_model_create(info, &model, NULL), LAC_OK);
    test_slot_set(&model, "a", a);
    test_slot_set(&model, "b", b);
    test_slot_set(&model, "dc", dc);
    test_slot_set(&model, "form", kind->form);
    test_slot_fill(&model);
    if (kind->v1) {
        test_slot_set(&model, "v1", 1e-3);
    }
    if (kind->v2) {
        test_slot_set(&model, "v2", 1e-5);
    }
    assert_int_equal(lac_friction_create(&model, n, &friction, NULL), LAC_OK);
    lac_model_clear(&model);
    return friction;
}

void laws_must(bool holds, const lac_friction *friction, size_t cell, const double at[2],
               const char *what)
{
    if (holds) {
        return;
    }
    char text[1000];
    const lac_model_info *info = &friction->law->info;
    int n = snprintf(text, sizeof text, "law %s, form %s: %s at v %.6g m/s, theta %.6g s;",
                     info->name, friction->form == LAC_FORM_PLAIN ? "plain" : "regularised", what,
                     exp(at[0]), exp(at[1]));
    for (size_t k = 0; k < info->param_count && n < (int)sizeof text; k++) {
        const lac_cellwise *has = lac_friction_values_of(friction, info->params[k].key);
        if (has != NULL) {
            n += snprintf(text + n, sizeof text - (size_t)n, " %s %.6g", info->params[k].key,
                          lac_cellwise_of(has, cell));
        }
    }
    fail_msg("%s", text);
}

lac_friction *laws_make_varied(const variant *kind)
{
    lac_friction *friction = laws_make(kind, LAWS_CELLS, 0.01, 0.015, 1e-4);
    const lac_model_info *info = &friction->law->info;
    double values[LAWS_CELLS];
    lac_error err = {""};
    for (size_t k = 0; k < info->param_count; k++) {
        const char *key = info->params[k].key;
        double low, high;
        if (lac_friction_values_of(friction, key) == NULL) {
            continue;
        }
        test_slot_exponents(&info->params[k], &low, &high);
        for (size_t i = 0; i < LAWS_CELLS; i++) {
            values[i] = fmin(fmax(pow(10, laws_biased(i, k, low, high)), info->params[k].min),
                             info->params[k].max);
        }
        if (lac_friction_set(friction, key, values, &err) != LAC_OK) {
            fail_msg("law %s: %s", info->name, err.message);
        }
    }
    return friction;
}

void laws_evaluate(const lac_friction *friction, size_t first, size_t n, evaluation *e)
{
    lac_vexp(n, e->u, e->v);
    lac_friction_evaluate(
        friction, &(lac_friction_cells){first, n, e->u, e->w, e->v, 0, NULL},
        &(lac_friction_values){
            .f = e->out[F], .f_u = e->out[F_U], .f_w = e->out[F_W], .g = e->out[G]},
        &(lac_friction_slopes){.f_uu = e->out[F_UU],
                               .f_uw = e->out[F_UW],
                               .f_ww = e->out[F_WW],
                               .g_u = e->out[G_U],
                               .g_w = e->out[G_W]});
}
