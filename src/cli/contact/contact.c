// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna contact CASE: presses the surface, measures the contact and follows its history of loads.
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "cli/common/command.h"
#include "cli/common/libraries.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "cli/contact/fractal.h"
#include "cli/contact/measures.h"
#include "cli/contact/steps.h"
#include "cli/contact/surface.h"
#include "cli/report/report.h"
#include "cli/run/run_outcome.h"
#include "data/dataset.h"

// Everything that the command holds.
typedef struct contact_job {
    const cli_request *request;
    lac_case *source;
    lac_scene_contact contact;
    cli_steps steps; // of the history, where the case has one
    char *path, *case_text;
} contact_job;

static void job_clear(contact_job *job)
{
    cli_steps_clear(&job->steps);
    lac_scene_contact_clear(&job->contact);
    lac_case_free(job->source);
    free(job->case_text);
    free(job->path);
}

static bool changes_pressure(const lac_history_def *history)
{
    for (size_t i = 0; i < history->count; i++) {
        if (!isnan(history->step[i].pressure)) {
            return true;
        }
    }
    return false;
}

// Follows the history, whose file is that of the contact too.
static lac_status follow_history(contact_job *job, const lac_provenance *provenance,
                                 lac_dataset *dataset, lac_error *err)
{
    static const lac_history_keep keeps[] = {[LAC_HISTORY_ALL] = LAC_KEEP_ALL,
                                             [LAC_HISTORY_LAST] = LAC_KEEP_LAST,
                                             [LAC_HISTORY_NONE] = LAC_KEEP_NONE};
    const lac_history_def *history = &job->source->history;
    const lac_history_store_def def = {
        .path = job->path,
        .force = cli_given(job->request, CLI_OPT_FORCE),
        .provenance = *provenance,
        .contact = dataset,
        .grid = &job->contact.grid,
        .friction = history->friction,
        .keep = keeps[history->fields],
        .pressed = changes_pressure(history),
    };
    cli_say(job->request, "following %zu steps", lac_scene_history_steps(job->source));
    lac_status status =
        cli_steps_run(job->request, job->source, &job->contact, &def, &job->steps, err);
    bool said = status == LAC_EINTERRUPT || status == LAC_EIO; // names its file already
    return said ? status : cli_blame(job->source, status, err);
}

static lac_status write_file(contact_job *job, lac_error *err)
{
    char libraries[256];
    job->case_text = lac_case_text(job->source);
    if (job->case_text == NULL) {
        return lac_fail_memory(err);
    }
    const lac_provenance provenance = cli_provenance(job->request, job->source, job->case_text,
                                                     cli_libraries(libraries, sizeof libraries));
    const bool history = job->source->history.count > 0;
    const lac_contact_outcome outcome = {.contact = &job->contact,
                                         .status = history ? NULL : "complete"};
    lac_dataset *dataset = NULL;
    lac_status status = lac_contact_describe(&outcome, &dataset, err);
    if (status == LAC_OK && history) {
        status = follow_history(job, &provenance, dataset, err);
    } else if (status == LAC_OK) {
        cli_signals_hold();
        status = lac_store_dataset(job->path, cli_given(job->request, CLI_OPT_FORCE), &provenance,
                                   dataset, err);
    }
    lac_dataset_free(dataset);
    return status;
}

static void print_result(const contact_job *job)
{
    const lac_case *c = job->source;
    const lac_scene_contact *contact = &job->contact;
    const lac_contact_report *report = &contact->report;
    char cpu[32];
    if (c->title != NULL) {
        puts(c->title);
    }
    if (contact->solved) {
        cli_surface_print(&contact->surface);
    }
    cli_row_quantity("nominal pressure", contact->mean_pressure, "Pa");
    cli_measures_print(contact);
    cli_fractal_print(contact);
    if (contact->solved) {
        cli_row("iterations", "%" PRId64 " (%" PRId64 " elastic products)", report->iterations,
                report->products);
        cli_row("complementarity", "%.2g", report->complementarity_error);
        cli_row_quantity("penetration", fabs(report->penetration), "m");
        cli_row_quantity("approach", report->approach, "m");
    }
    if (job->steps.record != NULL) {
        cli_steps_print(&job->steps);
    }
    cli_row("time taken", "CPU %s", cli_quantity(cli_cpu_time(), "s", cpu, sizeof cpu));
    cli_row("file", "%s", job->path);
}

static lac_status write_result(const contact_job *job, lac_error *err)
{
    const lac_contact_outcome outcome = {.contact = &job->contact};
    lac_json json = {.out = stdout};
    lac_dataset *dataset = NULL;
    lac_status status = lac_contact_describe(&outcome, &dataset, err);
    if (status != LAC_OK) {
        return status;
    }
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(dataset, &json);
    if (job->steps.record != NULL) {
        cli_steps_json(&json, &job->steps);
    }
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_text(&json, "output", job->path);
    lac_json_close(&json, '}');
    lac_dataset_free(dataset);
    return LAC_OK;
}

static lac_status show_result(const contact_job *job, lac_status status, lac_error *err)
{
    bool whole = status == LAC_OK || status == LAC_EINTERRUPT;
    if (cli_given(job->request, CLI_OPT_JSON)) {
        if (whole || job->steps.record != NULL) {
            const lac_status shown = write_result(job, status == LAC_OK ? err : NULL);
            status = status == LAC_OK ? shown : status;
        }
    } else if (whole) {
        print_result(job);
        if (cli_given(job->request, CLI_OPT_VERBOSE)) {
            cli_fractal_tables(&job->contact);
        }
    }
    return status;
}

lac_status cli_contact(const cli_request *request, lac_error *err)
{
    contact_job job = {.request = request};
    lac_scene_measure_def measure;
    lac_status status;
    LAC_TRY(cli_fractal_read(request, &measure, err));
    LAC_TRY(cli_case_read(request, LAC_FOR_CONTACT, &job.source, NULL, err));
    LAC_TRY(cli_output_path(request, job.source, NULL, "-contact.nc", &job.path, err));
    cli_say(request, "solving the contact of %s", request->argument[0]);
    LAC_TRY(
        cli_blame(job.source, lac_scene_contact_solve(job.source, true, &job.contact, err), err));
    LAC_TRY(cli_blame(job.source, lac_scene_contact_measure(&measure, &job.contact, err), err));
    status = show_result(&job, write_file(&job, err), err);
out:
    job_clear(&job);
    return status;
}
