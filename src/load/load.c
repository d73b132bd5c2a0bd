// SPDX-License-Identifier: GPL-3.0-or-later
// The loads of a case, made ready from what it names, and their sum at any time.
#include "load/load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "load/kinds.h"
#include "load/signal.h"

const char *const lac_share_names[] = {"pressure", "equal", "elastic", NULL};

// The descriptor is the first member of the kind's row.
static const lac_load_kind *kind_of(const lac_slot *slot)
{
    return (const lac_load_kind *)(const void *)slot->about;
}

static void add_all(const lac_load *loads, size_t count, double t, lac_load_state *sum)
{
    for (size_t i = 0; i < count; i++) {
        loads[i].kind->add(&loads[i], t, sum);
    }
}

static double first_break(const lac_load *loads, size_t count, double t)
{
    double first = INFINITY;
    for (size_t i = 0; i < count; i++) {
        if (loads[i].kind->next_break != NULL) {
            first = fmin(first, loads[i].kind->next_break(&loads[i], t));
        }
    }
    return first;
}

static double longest_step(const lac_load *loads, size_t count, double t)
{
    double longest = INFINITY;
    for (size_t i = 0; i < count; i++) {
        if (loads[i].kind->longest_step != NULL) {
            longest = fmin(longest, loads[i].kind->longest_step(&loads[i], t));
        }
    }
    return longest;
}

void lac_load_evaluate(const lac_load_set *set, double t, lac_load_state *sum)
{
    *sum = (lac_load_state){0};
    add_all(set->shear, set->shear_count, t, sum);
    add_all(set->pore, set->pore_count, t, sum);
}

double lac_load_next_break(const lac_load_set *set, double t)
{
    return fmin(first_break(set->shear, set->shear_count, t),
                first_break(set->pore, set->pore_count, t));
}

double lac_load_longest_step(const lac_load_set *set, double t)
{
    return fmin(longest_step(set->shear, set->shear_count, t),
                longest_step(set->pore, set->pore_count, t));
}

lac_share lac_load_slot_share(const lac_slot *slot)
{
    for (size_t i = 0; i < slot->about->param_count; i++) {
        const lac_param *param = &slot->about->params[i];
        if (param->choices == lac_share_names) {
            int share;
            memcpy(&share, (const char *)slot->params + param->offset, sizeof share);
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

static bool need_files(const lac_slot *slots, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (kind_of(&slots[i])->prepare != NULL) {
            return true;
        }
    }
    return false;
}

bool lac_load_slots_need_files(const lac_load_slots *slots)
{
    return need_files(slots->shear, slots->shear_count) ||
           need_files(slots->pore, slots->pore_count);
}

bool lac_load_slots_constant(const lac_load_slots *slots)
{
    bool constant = true;
    for (size_t i = 0; i < slots->shear_count; i++) {
        constant = constant && kind_of(&slots->shear[i])->constant;
    }
    for (size_t i = 0; i < slots->pore_count; i++) {
        constant = constant && kind_of(&slots->pore[i])->constant;
    }
    return constant;
}

// Makes the loads of one list ready, up to the first that cannot be.
static lac_status prepare_all(const lac_slot *slots, size_t count, const char *list,
                              const lac_load_clock *clock, lac_load **out, size_t *ready,
                              lac_error *err)
{
    if (count == 0) {
        return LAC_OK;
    }
    *out = calloc(count, sizeof **out);
    if (*out == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < count; i++) {
        lac_load *load = &(*out)[i];
        load->kind = kind_of(&slots[i]);
        load->params = slots[i].params;
        load->share = lac_load_slot_share(&slots[i]);
        lac_status status = load->kind->prepare == NULL
                                ? LAC_OK
                                : load->kind->prepare(load->params, clock, &load->state, err);
        if (status != LAC_OK) {
            return lac_fail_within(err, status, "%s.%zu.%s", list, i, load->kind->about.name);
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

lac_status lac_load_set_create(const lac_load_slots *slots, const lac_load_clock *clock,
                               lac_load_set *set, lac_error *err)
{
    lac_status status = LAC_OK;
    *set = (lac_load_set){0};
    LAC_TRY(prepare_all(slots->shear, slots->shear_count, "load.shear", clock, &set->shear,
                        &set->shear_count, err));
    LAC_TRY(prepare_all(slots->pore, slots->pore_count, "load.pore_pressure", clock, &set->pore,
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
