// SPDX-License-Identifier: GPL-3.0-or-later
// What a file says of the case it was made from.
#include "scene/scene.h"

lac_provenance lac_case_provenance(const lac_case *c, const char *case_text)
{
    const int64_t *seed = lac_model_seed(c->surface.info != NULL ? &c->surface : &c->domain);
    return (lac_provenance){
        .title = c->title != NULL ? c->title : c->path,
        .institution = c->institution,
        .references = c->references,
        .case_text = case_text,
        .seed = seed != NULL ? *seed : INT64_MIN,
    };
}

lac_status lac_made_from_case(const lac_case *c, lac_made_from *out, lac_error *err)
{
    out->case_text = lac_case_text(c);
    out->provenance = lac_case_provenance(c, out->case_text);
    return out->case_text != NULL ? LAC_OK : lac_fail_memory(err);
}
