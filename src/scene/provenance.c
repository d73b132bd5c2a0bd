// SPDX-License-Identifier: GPL-3.0-or-later
// What a file says of the case it was made from.
#include <string.h>

#include "scene/scene.h"

// The seed of the surface or domain, wherever its table keeps it.
static int64_t find_seed(const lac_slot *slot)
{
    for (size_t i = 0; slot->about != NULL && i < slot->about->param_count; i++) {
        const lac_param *param = &slot->about->params[i];
        if (param->type == LAC_INTEGER && strcmp(param->key, "seed") == 0) {
            int64_t seed;
            memcpy(&seed, (const char *)slot->params + param->offset, sizeof seed);
            return seed;
        }
    }
    return INT64_MIN;
}

lac_provenance lac_case_provenance(const lac_case *c, const char *case_text)
{
    return (lac_provenance){
        .title = c->title != NULL ? c->title : c->path,
        .institution = c->institution,
        .references = c->references,
        .case_text = case_text,
        .seed = find_seed(c->surface.about != NULL ? &c->surface : &c->domain),
    };
}

lac_status lac_made_from_case(const lac_case *c, lac_made_from *out, lac_error *err)
{
    out->case_text = lac_case_text(c);
    out->provenance = lac_case_provenance(c, out->case_text);
    return out->case_text != NULL ? LAC_OK : lac_fail_memory(err);
}
