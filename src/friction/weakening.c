// SPDX-License-Identifier: GPL-3.0-or-later
// The table of mechanisms that weaken cells besides friction, and what a case names of it.
#include "friction/weakening.h"

static const lac_weakening_kind *const kinds[] = {LAC_WEAKENINGS(LAC_ROW_ADDRESS)};

LAC_KINDS_AT(lac_weakening_kind, lac_weakening_get, kinds)

lac_status lac_weakening_set_create(const lac_model *models, size_t count, lac_weakening_set *out,
                                    lac_error *err)
{
    *out = (lac_weakening_set){.count = 0};
    for (size_t i = 0; i < count; i++) {
        // The descriptor is the first member of the mechanism's row.
        const lac_weakening_kind *kind = (const void *)models[i].info;
        for (size_t k = 0; k < out->count; k++) {
            LAC_FAIL_IF(out->item[k].kind == kind, err, LAC_EINPUT,
                        "weakening.%zu: %s stands there twice", i, kind->info.name);
        }
        lac_weakening *item = &out->item[out->count++];
        item->kind = kind;
        item->params = models[i].params;
        item->first = out->modes;
        kind->modes(item->params, &item->modes);
        out->modes += item->modes.n;
        out->pore = out->pore || kind->pore;
        out->bridges = out->bridges || !kind->pore;
        out->warm = out->warm || kind->warm;
    }
    return LAC_OK;
}
