// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna contact CASE: presses the surface, measures the contact and follows its history of loads.
#include "cli/contact/contact.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/report/report.h"

// Everything that the command holds.
typedef struct contact_job {
    const cli_request *request;
    lac_case *source;
    lac_scene_contact contact;
    lac_contact_outcome outcome;
    lac_history_result result; // of the history, where the case has one
    lac_history_record *record;
    lac_history_store *store;
    size_t done;
    cli_progress progress;
    char *path;
} contact_job;

static lac_status on_step(void *context, const lac_history_record *record, lac_error *err)
{
    contact_job *job = context;
    job->record[job->done++] = *record;
    return lac_history_store_step(job->store, record, err);
}

static lac_status on_maps(void *context, const lac_history_maps *maps, lac_error *err)
{
    return lac_history_store_maps(((const contact_job *)context)->store, maps, err);
}

static bool on_interrupted(void *context)
{
    contact_job *job = context;
    cli_progress_stage(&job->progress, "steps of the history", job->done,
                       lac_scene_history_steps(job->source));
    return cli_signals_stop(NULL);
}

// Goes through the history, a step written as it is solved.
static lac_status follow(contact_job *job, const lac_history_store_def *def, lac_error *err)
{
    const lac_history_sink sink = {
        .context = job, .step = on_step, .maps = on_maps, .interrupted = on_interrupted};
    lac_error late = {""};
    job->outcome.status = "failed";
    cli_signals_hold();
    LAC_TRY_RETURN(lac_history_store_create(def, &job->store, err));
    cli_progress_start(&job->progress, job->request);
    lac_status status = lac_scene_history_run(job->source, &job->contact, &sink, &job->result, err);
    cli_progress_clear(&job->progress);
    const bool whole = status == LAC_OK || status == LAC_EINTERRUPT;
    job->outcome.status = status == LAC_OK ? "complete" : whole ? "interrupted" : "failed";
    const lac_status finished = lac_history_store_finish(job->store, job->outcome.status, &late);
    lac_history_store_free(job->store);
    if (finished != LAC_OK && whole) {
        job->outcome.status = "failed"; // the file is not whole
        *err = late;
        return finished;
    }
    return status == LAC_EINTERRUPT
               ? lac_fail(err, status, "interrupted after step %zu of %zu; %s holds those",
                          job->result.steps, job->result.planned, job->path)
               : status;
}

// The history's file is that of the contact too.
static lac_status follow_history(contact_job *job, lac_dataset *dataset, lac_error *err)
{
    char *text = lac_case_text(job->source);
    const size_t steps = lac_scene_history_steps(job->source);
    const lac_history_store_def def = {
        .path = job->path,
        .force = cli_given(job->request, CLI_OPT_FORCE),
        .provenance = cli_provenance(job->request, job->source, text),
        .contact = dataset,
        .keep = (lac_history_keep)job->source->history.fields,
        .pressed = lac_scene_history_presses(job->source),
    };
    cli_say(job->request, "following %zu steps", steps);
    job->outcome.record = job->record = calloc(steps, sizeof *job->record);
    const bool good = text != NULL && job->record != NULL;
    job->outcome.result = good ? &job->result : NULL;
    const lac_status status = good ? follow(job, &def, err) : lac_fail_memory(err);
    free(text);
    const bool said = status == LAC_EINTERRUPT || status == LAC_EIO; // names its file already
    return said ? status : cli_blame(job->source, status, err);
}

static lac_status write_file(contact_job *job, lac_error *err)
{
    const bool history = job->source->history.count > 0;
    lac_dataset *dataset = NULL;
    job->outcome = (lac_contact_outcome){.contact = &job->contact,
                                         .status = history ? NULL : "complete",
                                         .friction = job->source->history.friction,
                                         .result = history ? &job->result : NULL};
    lac_status status = lac_contact_describe(&job->outcome, &dataset, err);
    if (status == LAC_OK && history) {
        status = follow_history(job, dataset, err);
    } else if (status == LAC_OK) {
        cli_signals_hold();
        status = cli_store_dataset(job->request, job->source, INT64_MIN, job->path, dataset, err);
    }
    lac_dataset_free(dataset);
    return status;
}

static lac_status show_result(const contact_job *job, lac_status status, lac_error *err)
{
    const bool whole = status == LAC_OK || status == LAC_EINTERRUPT;
    if (!cli_given(job->request, CLI_OPT_JSON)) {
        if (whole) {
            cli_contact_print(job->source, &job->outcome, job->path,
                              cli_given(job->request, CLI_OPT_VERBOSE));
        }
    } else if (whole || job->outcome.result != NULL) {
        lac_error *const to = status == LAC_OK ? err : NULL;
        lac_dataset *dataset = NULL;
        const lac_status shown = lac_contact_describe(&job->outcome, &dataset, to);
        if (shown == LAC_OK) {
            cli_print_json(dataset, job->path);
        }
        lac_dataset_free(dataset);
        status = status == LAC_OK ? shown : status;
    }
    return status;
}

lac_status cli_contact(const cli_request *request, lac_error *err)
{
    contact_job job = {.request = request};
    const lac_measure_words words = {request->boxes, request->coarsest, request->coarsening,
                                     request->sizes};
    lac_scene_measure_def measure;
    lac_error why = {""};
    lac_status status = lac_scene_measure_read(&words, &measure, &why);
    LAC_FAIL_IF(status != LAC_OK, err, status, "%s%s", status == LAC_EINPUT ? "--" : "",
                why.message);
    LAC_TRY(cli_case_read(request, LAC_FOR_CONTACT, &job.source, NULL, err));
    job.source->team = request->team;
    LAC_TRY(cli_output_path(request, job.source, NULL, "-contact.nc", &job.path, err));
    cli_say(request, "solving the contact of %s", request->argument[0]);
    status = lac_scene_contact_solve(job.source, LAC_SCENE_MEASURED, &job.contact, err);
    LAC_TRY(cli_blame(job.source, status, err));
    if (lac_team_leads(request->team)) { // the others wait for what it does by itself
        status = lac_scene_contact_measure(&measure, &job.contact, err);
        status = status == LAC_OK ? show_result(&job, write_file(&job, err), err)
                                  : cli_blame(job.source, status, err);
    }
    status = lac_team_agree(request->team, status, err);
out:
    free(job.record);
    lac_scene_contact_clear(&job.contact);
    lac_case_free(job.source);
    free(job.path);
    return status;
}
