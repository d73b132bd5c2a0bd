// SPDX-License-Identifier: GPL-3.0-or-later
// The stress transfer that a case names; where it names none, cells do not feel each other.
#include "transfer/transfer.h"

#include "transfer/kinds.h"

lac_status lac_transfer_create(const lac_model *model, const lac_transfer_scene *scene,
                               lac_transfer *transfer, lac_error *err)
{
    // The descriptor is the first member of the kind's row.
    const lac_transfer_kind *kind = &lac_none_kind;
    if (model->info != NULL) {
        kind = (const void *)model->info;
    }
    *transfer = (lac_transfer){.kind = kind};
    lac_status status = kind->create(model->params, scene, &transfer->state, err);
    if (status != LAC_OK) {
        *transfer = (lac_transfer){0};
        return lac_fail_within(err, status, "transfer %s", kind->info.name);
    }
    return LAC_OK;
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
