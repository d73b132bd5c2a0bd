// SPDX-License-Identifier: GPL-3.0-or-later
// A case to the dataset of its contact or of its cascade, in one call.
#include "base/ask.h"
#include "lacuna/contact.h"
#include "lacuna/rg.h"
#include "scene/scene_rg.h"

// What a dataset is of, which it keeps: a contact or a cascade, the other empty.
typedef struct computed {
    lac_scene_contact contact;
    lac_contact_outcome contact_outcome;
    lac_scene_rg rg;
    lac_rg_outcome rg_outcome;
    lac_made_from made;
} computed;

static void computed_free(void *result)
{
    computed *r = result;
    if (r != NULL) {
        lac_scene_contact_clear(&r->contact);
        lac_scene_rg_clear(&r->rg);
        free(r->made.case_text);
        free(r);
    }
}

static lac_status begin(const lac_case *c, lac_case_purpose purpose, computed **out, lac_error *err)
{
    LAC_TRY_RETURN(lac_case_serves(c, purpose, err));
    *out = calloc(1, sizeof **out);
    LAC_FAIL_MEMORY_IF(*out == NULL, err);
    return lac_made_from_case(c, &(*out)->made, err);
}

lac_status lac_contact_compute(const lac_case *c, const lac_contact_options *options,
                               lac_dataset **out, lac_error *err)
{
    const lac_scene_measure_def measure = lac_scene_measure_default();
    lac_contact_options own = lac_contact_options_default();
    computed *r = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_contact_options", options, &own, sizeof own, err));
    LAC_TRY(begin(c, LAC_FOR_CONTACT, &r, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &r->contact, err));
    LAC_TRY(own.quick ? LAC_OK : lac_scene_contact_measure(&measure, &r->contact, err));
    r->contact_outcome = (lac_contact_outcome){.contact = &r->contact, .status = "complete"};
    LAC_TRY(lac_contact_describe(&r->contact_outcome, out, err));
    lac_dataset_keep(*out, r, computed_free, &r->made.provenance);
    r = NULL;
out:
    computed_free(r);
    return status;
}

lac_status lac_rg_compute(const lac_case *c, const lac_rg_options *options, lac_dataset **out,
                          lac_error *err)
{
    lac_rg_options own = lac_rg_options_default();
    computed *r = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_rg_options", options, &own, sizeof own, err));
    const lac_rg_watch watch = {own.context, own.go_on};
    LAC_TRY(begin(c, LAC_FOR_RG, &r, err));
    LAC_TRY(lac_scene_rg_run(c, own.go_on != NULL ? &watch : NULL, &r->rg, err));
    r->rg_outcome = (lac_rg_outcome){.source = c, .rg = &r->rg};
    LAC_TRY(lac_scene_rg_describe(&r->rg_outcome, out, err));
    lac_dataset_keep(*out, r, computed_free, &r->made.provenance);
    r = NULL;
out:
    computed_free(r);
    return status;
}
