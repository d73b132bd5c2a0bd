// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a case by their dotted keys.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case/sections.h"

// The rest of a key behind a first part and its dot; NULL where the key begins otherwise.
static const char *behind(const char *key, const char *part)
{
    size_t n = strlen(part);
    return strncmp(key, part, n) == 0 && key[n] == '.' ? key + n + 1 : NULL;
}

static bool find_in(const lac_param *params, size_t count, const char *key, void *at,
                    lac_case_value *out)
{
    for (size_t i = 0; i < count; i++) {
        if (params[i].type == LAC_REAL && strcmp(params[i].key, key) == 0 &&
            lac_param_given(&params[i], at)) {
            out->at = (double *)(void *)((char *)at + params[i].offset);
            out->param = &params[i];
            return true;
        }
    }
    return false;
}

static bool find_in_slot(const lac_slot *slot, const char *key, lac_case_value *out)
{
    const char *rest = slot->about != NULL && key != NULL ? behind(key, slot->about->name) : NULL;
    return rest != NULL &&
           find_in(slot->about->params, slot->about->param_count, rest, slot->params, out);
}

static bool find_in_slots(const lac_slot_list *list, const char *key, lac_case_value *out)
{
    char *end = NULL;
    if (key == NULL || key[0] < '0' || key[0] > '9') {
        return false;
    }
    unsigned long index = strtoul(key, &end, 10);
    return *end == '.' && index < list->count && find_in_slot(&list->item[index], end + 1, out);
}

static bool find_in_section(int section, const char *key, lac_case *c, lac_case_value *out)
{
    lac_table table = lac_section_table(section);
    return key != NULL && find_in(table.params, table.count, key, c, out);
}

static bool find_state(lac_case *c, const char *key, lac_case_value *out)
{
    bool time = c->initial.state == LAC_STATE_TIME && strcmp(key, "initial.state") == 0;
    bool ratio =
        c->initial.state == LAC_STATE_RATIO && strcmp(key, "initial.state.ratio_to_steady") == 0;
    out->at = &c->initial.state_value;
    out->param = time ? &lac_state_row : &lac_ratio_row;
    return time || ratio;
}

bool lac_case_find(lac_case *c, const char *key, lac_case_value *out)
{
    return find_in_slot(&c->friction, behind(key, "friction"), out) || find_state(c, key, out) ||
           find_in_section(LAC_SECTION_INITIAL, behind(key, "initial"), c, out) ||
           find_in_slot(&c->normal, behind(key, "load.normal"), out) ||
           find_in_slots(&c->shear, behind(key, "load.shear"), out) ||
           find_in_slots(&c->pore, behind(key, "load.pore_pressure"), out) ||
           find_in_slot(&c->transfer, behind(key, "transfer"), out) ||
           find_in_slot(&c->surface, behind(key, "interface.surface"), out) ||
           find_in_slot(&c->domain, behind(key, "interface.domain"), out) ||
           find_in_section(LAC_SECTION_MATERIAL, behind(key, "material"), c, out) ||
           find_in_section(LAC_SECTION_INTERFACE, behind(key, "interface"), c, out);
}

static const char *fault_of(const lac_slot *slot)
{
    return slot->about != NULL && slot->about->fault != NULL ? slot->about->fault(slot->params)
                                                             : NULL;
}

const char *lac_case_fault(const lac_case *c)
{
    const lac_slot *single[] = {&c->friction, &c->normal, &c->transfer, &c->surface, &c->domain};
    const lac_slot_list *lists[] = {&c->shear, &c->pore};
    const char *fault = NULL;
    for (size_t i = 0; fault == NULL && i < sizeof single / sizeof single[0]; i++) {
        fault = fault_of(single[i]);
    }
    for (size_t k = 0; k < 2; k++) {
        for (size_t i = 0; fault == NULL && i < lists[k]->count; i++) {
            fault = fault_of(&lists[k]->item[i]);
        }
    }
    return fault;
}

static lac_status rebase(char **path, const char *folder, lac_error *err)
{
    if (*path == NULL || (*path)[0] == '/') {
        return LAC_OK;
    }
    size_t size = strlen(folder) + strlen(*path) + 1;
    char *whole = malloc(size);
    if (whole == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(whole, size, "%s%s", folder, *path);
    free(*path);
    *path = whole;
    return LAC_OK;
}

static lac_status rebase_slot(const lac_slot *slot, const char *folder, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; slot->about != NULL && i < slot->about->param_count; i++) {
        const lac_param *param = &slot->about->params[i];
        if (param->type == LAC_PATH && status == LAC_OK) {
            status = rebase((char **)(void *)((char *)slot->params + param->offset), folder, err);
        }
    }
    return status;
}

static lac_status rebase_spreads(const lac_spread_list *list, const char *folder, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; status == LAC_OK && i < list->count; i++) {
        status = rebase_slot(&list->item[i].slot, folder, err);
    }
    return status;
}

lac_status lac_case_rebase(lac_case *c, const char *folder, lac_error *err)
{
    const lac_slot *single[] = {&c->friction, &c->normal, &c->transfer, &c->surface, &c->domain};
    const lac_slot_list *lists[] = {&c->shear, &c->pore};
    const lac_spread_list *spreads[] = {&c->friction_spread, &c->initial_spread,
                                        &c->interface_spread};
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof single / sizeof single[0]; i++) {
        LAC_TRY(rebase_slot(single[i], folder, err));
    }
    for (size_t k = 0; k < 2; k++) {
        for (size_t i = 0; i < lists[k]->count; i++) {
            LAC_TRY(rebase_slot(&lists[k]->item[i], folder, err));
        }
    }
    for (size_t i = 0; i < sizeof spreads / sizeof spreads[0]; i++) {
        LAC_TRY(rebase_spreads(spreads[i], folder, err));
    }
    for (size_t i = 0; i < c->compare_count; i++) {
        LAC_TRY(rebase(&c->compare[i].path, folder, err));
    }
out:
    return status;
}
