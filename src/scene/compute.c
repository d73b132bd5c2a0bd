// SPDX-License-Identifier: GPL-3.0-or-later
// A case to the dataset of its contact or of its cascade, in one call.
#include <stdlib.h>

#include "base/ask.h"
#include "data/dataset.h"
#include "lacuna/contact.h"
#include "lacuna/rg.h"
#include "scene/scene_rg.h"

// What a dataset is of, which it keeps.
typedef struct contact_result {
    lac_scene_contact contact;
    lac_contact_outcome outcome;
    lac_made_from made;
} contact_result;

typedef struct rg_result {
    lac_scene_rg rg;
    lac_rg_outcome outcome;
    lac_made_from made;
} rg_result;

static void contact_free(void *result)
{
    contact_result *r = result;
    lac_scene_contact_clear(&r->contact);
    free(r->made.case_text);
    free(r);
}

static void rg_free(void *result)
{
    rg_result *r = result;
    lac_scene_rg_clear(&r->rg);
    free(r->made.case_text);
    free(r);
}

lac_status lac_contact_compute(const lac_case *c, const lac_contact_options *options,
                               lac_dataset **out, lac_error *err)
{
    const lac_scene_measure_def measure = lac_scene_measure_default();
    lac_contact_options own = lac_contact_options_default();
    contact_result *r = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_contact_options", options, &own, sizeof own, err));
    LAC_TRY(lac_case_serves(c, LAC_FOR_CONTACT, err));
    r = calloc(1, sizeof *r);
    LAC_TRY(r != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_made_from_case(c, &r->made, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &r->contact, err));
    LAC_TRY(own.quick ? LAC_OK : lac_scene_contact_measure(&measure, &r->contact, err));
    r->outcome = (lac_contact_outcome){.contact = &r->contact, .status = "complete"};
    LAC_TRY(lac_contact_describe(&r->outcome, out, err));
    lac_dataset_keep(*out, r, contact_free, &r->made.provenance);
    r = NULL;
out:
    if (r != NULL) {
        contact_free(r);
    }
    return status;
}

lac_status lac_rg_compute(const lac_case *c, const lac_rg_options *options, lac_dataset **out,
                          lac_error *err)
{
    lac_rg_options own = lac_rg_options_default();
    rg_result *r = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_rg_options", options, &own, sizeof own, err));
    LAC_TRY(lac_case_serves(c, LAC_FOR_RG, err));
    const lac_rg_watch watch = {own.context, own.go_on};
    r = calloc(1, sizeof *r);
    LAC_TRY(r != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_made_from_case(c, &r->made, err));
    LAC_TRY(lac_scene_rg_run(c, own.go_on != NULL ? &watch : NULL, &r->rg, err));
    r->outcome = (lac_rg_outcome){.source = c, .rg = &r->rg};
    LAC_TRY(lac_scene_rg_describe(&r->outcome, out, err));
    lac_dataset_keep(*out, r, rg_free, &r->made.provenance);
    r = NULL;
out:
    if (r != NULL) {
        rg_free(r);
    }
    return status;
}
