// SPDX-License-Identifier: GPL-3.0-or-later
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "cli/command.h"
#include "cli/fractal.h"
#include "cli/libraries.h"
#include "cli/measures.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/run_outcome.h"
#include "cli/signals.h"
#include "cli/steps.h"
#include "cli/surface.h"
#include "cli/words.h"

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
                                 const lac_contact_view *view, lac_error *err)
{
    static const lac_history_keep keeps[] = {[LAC_HISTORY_ALL] = LAC_KEEP_ALL,
                                             [LAC_HISTORY_LAST] = LAC_KEEP_LAST,
                                             [LAC_HISTORY_NONE] = LAC_KEEP_NONE};
    const lac_history_def *history = &job->source->history;
    const lac_history_store_def def = {
        .path = job->path,
        .force = cli_given(job->request, CLI_OPT_FORCE),
        .provenance = *provenance,
        .contact = *view,
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
    const lac_scene_contact *contact = &job->contact;
    job->case_text = lac_case_text(job->source);
    if (job->case_text == NULL) {
        return lac_fail_memory(err);
    }
    const lac_provenance provenance = cli_provenance(job->request, job->source, job->case_text,
                                                     cli_libraries(libraries, sizeof libraries));
    const lac_scene_fractal *f = &contact->fractal;
    const lac_contact_view view = {.grid = &contact->grid,
                                   .heights = contact->heights,
                                   .gap = contact->gap,
                                   .pressure = contact->pressure,
                                   .report = contact->solved ? &contact->report : NULL,
                                   .boxes = contact->counted ? &contact->boxes : NULL,
                                   .blocks = &contact->blocks,
                                   .clusters = f->clustered ? &f->clusters : NULL,
                                   .scaling = f->scaled ? &f->scaling : NULL,
                                   .sizes = f->sizes,
                                   .size = f->size,
                                   .surface = contact->solved ? &contact->surface : NULL};
    if (job->source->history.count > 0) {
        return follow_history(job, &provenance, &view, err);
    }
    cli_signals_hold();
    return lac_store_contact(job->path, cli_given(job->request, CLI_OPT_FORCE), &provenance, &view,
                             err);
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

static void write_result(const contact_job *job)
{
    const lac_scene_contact *contact = &job->contact;
    const lac_contact_report *report = &contact->report;
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    cli_measures_json(&json, contact);
    cli_surface_json(&json, contact->solved ? &contact->surface : NULL);
    cli_json_number(&json, "mean_pressure_Pa", contact->mean_pressure);
    if (contact->solved) {
        cli_json_integer(&json, "iterations", report->iterations);
        cli_json_integer(&json, "products", report->products);
    } else {
        cli_json_null(&json, "iterations");
        cli_json_null(&json, "products");
    }
    cli_json_number(&json, "complementarity_error",
                    contact->solved ? report->complementarity_error : NAN);
    cli_json_number(&json, "penetration_m", contact->solved ? fabs(report->penetration) : NAN);
    cli_json_number(&json, "approach_m", contact->solved ? report->approach : NAN);
    cli_fractal_json(&json, contact);
    if (job->steps.record != NULL) {
        cli_steps_json(&json, &job->steps);
    }
    cli_json_number(&json, "cpu_time_s", cli_cpu_time());
    cli_json_text(&json, "output", job->path);
    cli_json_close(&json, '}');
}

static void show_result(const contact_job *job, lac_status status)
{
    bool whole = status == LAC_OK || status == LAC_EINTERRUPT;
    if (cli_given(job->request, CLI_OPT_JSON)) {
        if (whole || job->steps.record != NULL) {
            write_result(job);
        }
    } else if (whole) {
        print_result(job);
        if (cli_given(job->request, CLI_OPT_VERBOSE)) {
            cli_fractal_tables(&job->contact);
        }
    }
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
    status = write_file(&job, err);
    show_result(&job, status);
out:
    job_clear(&job);
    return status;
}
