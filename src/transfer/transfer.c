// SPDX-License-Identifier: GPL-3.0-or-later
// The stress transfer that a case names, from the table of those that it can; where it names none,
// cells do not feel each other.
#include "transfer/transfer.h"

#include "base/rows.h"

// Whether parameters are in their ranges, and go together and with the place.
static lac_status check(const lac_transfer_kind *kind, const void *params,
                        const lac_transfer_scene *scene, lac_error *err)
{
    const lac_domain *domain = scene->domain;
    const lac_transfer_place place = {.periodic = domain->grid.periodic,
                                      .full = domain->n == lac_grid_cells(&domain->grid),
                                      .line = scene->line};
    lac_transfer_validate fault[LAC_TRANSFER_FAULTS] = {0};
    for (size_t i = 0; i < kind->info.param_count; i++) {
        const lac_param *param = &kind->info.params[i];
        const double *value = (const void *)((const char *)params + param->offset);
        char why[128];
        LAC_FAIL_IF(param->type == LAC_REAL && lac_param_given(param, params) &&
                        !lac_param_allows(param, *value, why, sizeof why),
                    err, LAC_EINPUT, "%s: %g %s", param->key, *value, why);
    }
    if (kind->check != NULL) {
        kind->check(params, &place, fault);
    }
    for (size_t i = 0; i < LAC_TRANSFER_FAULTS; i++) {
        const char *key = fault[i].key; // "" or ".ratio"
        LAC_FAIL_IF(fault[i].text != NULL, err, LAC_EINPUT, "%s%s%s", *key != '\0' ? key + 1 : "",
                    *key != '\0' ? ": " : "", fault[i].text);
    }
    return LAC_OK;
}

lac_status lac_transfer_create(const lac_model *model, const lac_transfer_scene *scene,
                               lac_transfer *transfer, lac_error *err)
{
    // The descriptor is the first member of the kind's row.
    const lac_transfer_kind *kind = &lac_none_kind;
    if (model->info != NULL) {
        kind = (const void *)model->info;
    }
    *transfer = (lac_transfer){.kind = kind};
    lac_status status = check(kind, model->params, scene, err);
    if (status == LAC_OK) {
        status = kind->create(model->params, scene, &transfer->state, err);
    }
    if (status != LAC_OK) {
        *transfer = (lac_transfer){0};
        return lac_fail_within(err, status, "transfer %s", kind->info.name);
    }
    return LAC_OK;
}

lac_status lac_transfer_direct(const lac_model *model, const lac_transfer_scene *scene,
                               lac_transfer *transfer, lac_error *err)
{
    const lac_transfer_kind *kind = transfer->kind;
    LAC_FAIL_IF(kind->pair == NULL, err, LAC_EINPUT, "transfer %s: knows slip along x only",
                kind->info.name);
    lac_status status = kind->pair->direct(model->params, scene, transfer->state, err);
    return lac_fail_within(err, status, "transfer %s", kind->info.name);
}

bool lac_transfer_outline_of(const lac_model *model, lac_transfer_outline *outline)
{
    const lac_transfer_kind *kind = (const void *)model->info;
    const bool tied = kind != NULL && kind->outline != NULL;
    *outline = tied ? kind->outline(model->params) : (lac_transfer_outline){0};
    return tied;
}

void lac_transfer_clear(lac_transfer *transfer)
{
    if (transfer->kind != NULL) {
        transfer->kind->free(transfer->state);
    }
    *transfer = (lac_transfer){0};
}

static const lac_transfer_kind *const registry[] = {
    &lac_hierarchy_kind,
    &lac_elastic_kind,
    &lac_none_kind,
};

LAC_KINDS_AT(lac_transfer_kind, lac_transfer_kind_get, registry)
