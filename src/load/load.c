// SPDX-License-Identifier: GPL-3.0-or-later
// The loads of a case, made ready from what it names, and their sum at any time.
#include "load/load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "load/kinds.h"

const char *const lac_share_names[] = {"pressure", "equal", "elastic", NULL};

// The descriptor is the first member of the kind's row.
static const lac_load_kind *kind_of(const lac_model *model)
{
    return (const lac_load_kind *)(const void *)model->info;
}

// Adds shear stress over the nominal area [Pa], [Pa/s], to what the load is shared as. A spring's
// stress is the same on all cells; here it has no stiffness.
static void add_stress(const lac_load *load, lac_load_state *sum, lac_signal s)
{
    bool equal = load->share == LAC_SHARE_EQUAL, elastic = load->share == LAC_SHARE_ELASTIC;
    *(equal ? &sum->spring_stress : elastic ? &sum->elastic : &sum->stress) += s.value;
    *(equal ? &sum->spring_rate : elastic ? &sum->elastic_rate : &sum->stress_rate) += s.rate;
}

void lac_load_evaluate(const lac_load_set *set, double t, lac_load_state *sum)
{
    *sum = (lac_load_state){0};
    for (size_t i = 0; i < set->shear_count; i++) {
        const lac_load *load = &set->shear[i];
        if (load->kind->signal != NULL) {
            add_stress(load, sum, load->kind->signal(load, t));
        } else {
            load->kind->add(load, t, sum);
        }
    }
    for (size_t i = 0; i < set->pore_count; i++) {
        const lac_load *load = &set->pore[i];
        if (load->kind->signal != NULL) {
            const lac_signal pore = load->kind->signal(load, t);
            sum->pore += pore.value;
            sum->pore_rate += pore.rate;
        } else {
            load->kind->add(load, t, sum);
        }
    }
}

// The index-th load of a set, shear before pore; NULL past the end.
static const lac_load *load_at(const lac_load_set *set, size_t index)
{
    const size_t pore = index - set->shear_count;
    return index < set->shear_count ? &set->shear[index]
           : pore < set->pore_count ? &set->pore[pore]
                                    : NULL;
}

double lac_load_next_break(const lac_load_set *set, double t)
{
    const lac_load *load;
    double first = INFINITY;
    for (size_t i = 0; (load = load_at(set, i)) != NULL; i++) {
        first =
            load->kind->next_break != NULL ? fmin(first, load->kind->next_break(load, t)) : first;
    }
    return first;
}

double lac_load_longest_step(const lac_load_set *set, double t)
{
    const lac_load *load;
    double longest = INFINITY;
    for (size_t i = 0; (load = load_at(set, i)) != NULL; i++) {
        longest = load->kind->longest_step != NULL
                      ? fmin(longest, load->kind->longest_step(load, t))
                      : longest;
    }
    return longest;
}

double lac_window_break(double start, double end, double t)
{
    double next = t < start ? start : isnan(end) || t >= end ? INFINITY : end;
    return end <= start ? INFINITY : next;
}

lac_share lac_load_models_share(const lac_model *model)
{
    for (size_t i = 0; i < model->info->param_count; i++) {
        const lac_param *param = &model->info->params[i];
        if (param->choices == lac_share_names) {
            int share;
            memcpy(&share, (const char *)model->params + param->offset, sizeof share);
            return (lac_share)share;
        }
    }
    return LAC_SHARE_PRESSURE;
}

bool lac_load_set_is_shaped(const lac_load_set *set)
{
    for (size_t i = 0; i < set->shear_count; i++) {
        if (set->shear[i].share == LAC_SHARE_ELASTIC) {
            return true;
        }
    }
    return false;
}

double lac_load_shear(const lac_load_state *state, double pressure)
{
    double ratio = state->ratio + state->equal_ratio + state->elastic_ratio;
    return ratio * pressure + state->stress + state->elastic + state->spring_stress;
}

// Whether all loads are constant in time, or any reads a file.
static bool all_constant(const lac_model *models, size_t count)
{
    bool constant = true;
    for (size_t i = 0; i < count; i++) {
        constant = constant && kind_of(&models[i])->constant;
    }
    return constant;
}

static bool any_reads(const lac_model *models, size_t count)
{
    bool reads = false;
    for (size_t i = 0; i < count; i++) {
        reads = reads || kind_of(&models[i])->prepare != NULL;
    }
    return reads;
}

bool lac_load_models_need_files(const lac_load_models *models)
{
    return any_reads(models->shear, models->shear_count) ||
           any_reads(models->pore, models->pore_count);
}

bool lac_load_models_constant(const lac_load_models *models)
{
    return all_constant(models->shear, models->shear_count) &&
           all_constant(models->pore, models->pore_count);
}

// Makes the loads of one list ready, up to the first that cannot be.
static lac_status prepare_all(const lac_model *models, size_t count, const char *list,
                              const lac_load_clock *clock, lac_load **out, size_t *ready,
                              lac_error *err)
{
    if (count == 0) {
        return LAC_OK;
    }
    *out = calloc(count, sizeof **out);
    LAC_FAIL_MEMORY_IF(*out == NULL, err);
    for (size_t i = 0; i < count; i++) {
        lac_load *load = &(*out)[i];
        load->kind = kind_of(&models[i]);
        load->params = models[i].params;
        load->share = lac_load_models_share(&models[i]);
        lac_status status = load->kind->prepare == NULL
                                ? LAC_OK
                                : load->kind->prepare(load->params, clock, &load->state, err);
        if (status != LAC_OK) {
            return lac_fail_within(err, status, "%s.%zu.%s", list, i, load->kind->info.name);
        }
        (*ready)++;
    }
    return LAC_OK;
}

static void release_all(lac_load *loads, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (loads[i].kind->release != NULL && loads[i].state != NULL) {
            loads[i].kind->release(loads[i].state);
        }
    }
    free(loads);
}

lac_status lac_load_set_create(const lac_load_models *models, const lac_load_clock *clock,
                               lac_load_set *set, lac_error *err)
{
    lac_status status = LAC_OK;
    *set = (lac_load_set){0};
    LAC_TRY(prepare_all(models->shear, models->shear_count, "load.shear", clock, &set->shear,
                        &set->shear_count, err));
    LAC_TRY(prepare_all(models->pore, models->pore_count, "load.pore_pressure", clock, &set->pore,
                        &set->pore_count, err));
    return LAC_OK;
out:
    lac_load_set_clear(set);
    return status;
}

void lac_load_set_clear(lac_load_set *set)
{
    release_all(set->shear, set->shear_count);
    release_all(set->pore, set->pore_count);
    free(set->shape);
    *set = (lac_load_set){0};
}
