// SPDX-License-Identifier: GPL-3.0-or-later
// The history of a contact for `lacuna contact`: each step is written and shown as it is solved.
#include "cli/contact/steps.h"

#include <math.h>
#include <stdlib.h>

#include "cli/common/progress.h"
#include "cli/common/signals.h"

// What the history's sink needs.
typedef struct steps_job {
    cli_steps *steps;
    size_t done, planned;
    lac_history_store *store;
    cli_progress progress;
} steps_job;

static lac_status on_step(void *context, const lac_history_record *record, lac_error *err)
{
    steps_job *job = context;
    job->steps->record[job->done++] = *record;
    cli_progress_steps(&job->progress, job->done, job->planned);
    return lac_history_store_step(job->store, record, err);
}

static lac_status on_maps(void *context, const lac_history_maps *maps, lac_error *err)
{
    return lac_history_store_maps(((const steps_job *)context)->store, maps, err);
}

static bool on_interrupted(void *context)
{
    const steps_job *job = context;
    cli_progress_steps(&((steps_job *)context)->progress, job->done, job->planned);
    return cli_signals_stop();
}

// What the history is summed up in, as attributes of the file.
static lac_status put_summary(const steps_job *job, lac_error *err)
{
    const lac_history_result *r = &job->steps->result;
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"first_slip_q_over_fp", r->loaded ? r->first_slip.factor : NAN},
        {"first_slip_x_m", r->loaded ? r->first_place[0] : NAN},
        {"first_slip_y_m", r->loaded ? r->first_place[1] : NAN},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; status == LAC_OK && i < sizeof numbers / sizeof numbers[0]; i++) {
        status = lac_history_store_number(job->store, numbers[i].name, numbers[i].value, err);
    }
    return status;
}

static lac_status close_store(steps_job *job, lac_status status, const char *path, lac_error *err)
{
    lac_error late = {""};
    const lac_history_result *result = &job->steps->result;
    lac_status summed = put_summary(job, &late);
    const char *word = summed == LAC_OK ? job->steps->status : "failed";
    lac_status closed = lac_history_store_finish(job->store, word, summed == LAC_OK ? &late : NULL);
    lac_status finished = summed != LAC_OK ? summed : closed;
    if (finished != LAC_OK && (status == LAC_OK || status == LAC_EINTERRUPT)) {
        job->steps->status = "failed"; // the file is not whole
        *err = late;
        return finished;
    }
    if (status == LAC_EINTERRUPT) {
        return lac_fail(err, status, "interrupted after step %zu of %zu; %s holds those",
                        result->steps, result->planned, path);
    }
    return status;
}

static const char *status_word(lac_status status)
{
    return status == LAC_OK ? "complete" : status == LAC_EINTERRUPT ? "interrupted" : "failed";
}

lac_status cli_steps_run(const cli_request *request, const lac_case *c,
                         const lac_scene_contact *contact, const lac_history_store_def *def,
                         cli_steps *steps, lac_error *err)
{
    steps_job job = {.steps = steps, .planned = lac_scene_history_steps(c)};
    const lac_history_sink sink = {
        .context = &job, .step = on_step, .maps = on_maps, .interrupted = on_interrupted};
    lac_status status = LAC_OK;
    *steps = (cli_steps){.status = "failed",
                         .friction = def->friction,
                         .grid = contact->grid,
                         .record = calloc(job.planned, sizeof *steps->record)};
    if (steps->record == NULL) {
        return lac_fail_memory(err);
    }
    cli_signals_hold();
    LAC_TRY(lac_history_store_create(def, &job.store, err));
    cli_progress_start(&job.progress, request);
    status = lac_scene_history_run(c, contact, &sink, &steps->result, err);
    cli_progress_clear(&job.progress);
    steps->status = status_word(status);
    status = close_store(&job, status, def->path, err);
out:
    lac_history_store_free(job.store);
    return status;
}

void cli_steps_clear(cli_steps *steps)
{
    free(steps->record);
    *steps = (cli_steps){0};
}
