// SPDX-License-Identifier: GPL-3.0-or-later
// A case to the dataset of its contact, with its history of loads, or of its cascade, in one call.
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
    // Of a contact's history.
    lac_contact_options options;
    lac_history_result history;
    lac_history_record *record; // [planned]
    lac_history_maps maps;      // arrays over `kept` steps
    double *field[5];           // [kept][cells] what they are: pressure, traction, slip
    uint8_t *state;
    size_t cells, mapped;
} computed;

static void computed_free(void *result)
{
    computed *r = result;
    if (r != NULL) {
        lac_scene_contact_clear(&r->contact);
        lac_scene_rg_clear(&r->rg);
        free(r->made.case_text);
        free(r->record);
        for (size_t k = 0; k < 5; k++) {
            free(r->field[k]);
        }
        free(r->state);
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

static lac_status keep_step(void *context, const lac_history_record *record, lac_error *err)
{
    computed *r = context;
    (void)err;
    r->record[record->number - 1] = *record;
    return LAC_OK;
}

static lac_status keep_maps(void *context, const lac_history_maps *maps, lac_error *err)
{
    computed *r = context;
    const size_t at = r->mapped++ * r->cells, bytes = r->cells * sizeof(double);
    (void)err;
    memcpy(r->field[0] + at, maps->pressure, bytes);
    for (size_t k = 0; k < 2; k++) {
        memcpy(r->field[1 + k] + at, maps->traction[k], bytes);
        memcpy(r->field[3 + k] + at, maps->slip[k], bytes);
    }
    memcpy(r->state + at, maps->state, r->cells);
    return LAC_OK;
}

static bool is_interrupted(void *context)
{
    const lac_contact_options *options = &((const computed *)context)->options;
    return options->interrupted != NULL && options->interrupted(options->context);
}

static lac_status make_room(const lac_case *c, computed *r, lac_error *err)
{
    const size_t steps = lac_scene_history_steps(c);
    const size_t kept = c->history.fields == LAC_KEEP_ALL    ? steps
                        : c->history.fields == LAC_KEEP_LAST ? 1
                                                             : 0;
    r->cells = lac_grid_cells(&r->contact.grid);
    r->record = calloc(steps, sizeof *r->record);
    r->state = calloc(kept + 1, r->cells);
    bool all = r->record != NULL && r->state != NULL;
    for (size_t k = 0; k < 5; k++) {
        r->field[k] = malloc((kept * r->cells + 1) * sizeof(double));
        all = all && r->field[k] != NULL;
    }
    r->maps = (lac_history_maps){.pressure = r->field[0],
                                 .traction = {r->field[1], r->field[2]},
                                 .slip = {r->field[3], r->field[4]},
                                 .state = r->state,
                                 .pressed = lac_scene_history_presses(c)};
    return all ? LAC_OK : lac_fail_memory(err);
}

// Follows the history of a case and keeps all of it.
static lac_status follow(const lac_case *c, computed *r, lac_error *err)
{
    lac_contact_outcome *o = &r->contact_outcome;
    const lac_history_sink sink = {
        .context = r, .step = keep_step, .maps = keep_maps, .interrupted = is_interrupted};
    LAC_TRY_RETURN(make_room(c, r, err));
    LAC_TRY_RETURN(lac_scene_history_run(c, &r->contact, &sink, &r->history, err));
    o->friction = c->history.friction;
    o->result = &r->history;
    o->record = r->record;
    o->keep = (lac_history_keep)c->history.fields;
    o->maps = o->keep != LAC_KEEP_NONE ? &r->maps : NULL;
    return LAC_OK;
}

lac_status lac_contact_compute(const lac_case *c, const lac_contact_options *options,
                               lac_dataset **out, lac_error *err)
{
    lac_scene_measure_def measure;
    lac_contact_options own = lac_contact_options_default();
    computed *r = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_contact_options", options, &own, sizeof own, err));
    const lac_measure_words words = {own.boxes, own.coarsest, own.coarsening, own.sizes};
    LAC_TRY(lac_scene_measure_read(&words, &measure, err));
    LAC_TRY(begin(c, LAC_FOR_CONTACT, &r, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &r->contact, err));
    LAC_TRY(own.quick ? LAC_OK : lac_scene_contact_measure(&measure, &r->contact, err));
    r->contact_outcome = (lac_contact_outcome){.contact = &r->contact, .status = "complete"};
    r->options = own;
    LAC_TRY(c->history.count > 0 && !own.quick ? follow(c, r, err) : LAC_OK);
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
