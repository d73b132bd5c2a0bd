// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>

#include "base/units.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/inputs.h"
#include "cli/libraries.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/resume.h"
#include "cli/run_accuracy.h"
#include "cli/run_outcome.h"
#include "cli/signals.h"
#include "cli/view.h"
#include "cli/words.h"
#include "lacuna/scene_analysis.h"

enum { RECORDS_BETWEEN_SYNCS = 64 };

// Everything that a run holds.
typedef struct run_job {
    const cli_request *request;
    lac_case *source;
    cli_compare compare;
    lac_scene *scene;
    lac_analysis *analysis; // NULL where the case names no indicator
    lac_store *store;
    cli_history history;
    cli_progress progress;
    cli_view *view; // with --view
    char *path, *case_text, *inputs;
    char libraries[256];
    lac_kept_checkpoint resume; // with --resume
    lac_accuracy_pick accuracy; // with solver.accuracy; else it has no pilots
    double started;
} run_job;

static void job_clear(run_job *job)
{
    cli_view_close(job->view);
    lac_store_free(job->store);
    lac_analysis_free(job->analysis);
    lac_scene_free(job->scene);
    cli_history_clear(&job->history);
    cli_compare_clear(&job->compare);
    lac_kept_checkpoint_clear(&job->resume);
    free(job->path);
    free(job->case_text);
    free(job->inputs);
    lac_case_free(job->source);
}

// --until as seconds since the start of the run.
static lac_status parse_until(const char *text, const lac_case *c, double *until, lac_error *err)
{
    lac_status status = cli_parse_time(text, c, until, err);
    return status == LAC_EINPUT ? lac_fail_within(err, status, "--until: \"%s\"", text) : status;
}

static lac_status shorten(const char *text, lac_case *c, lac_error *err)
{
    double until = NAN;
    if (text == NULL) {
        return LAC_OK;
    }
    lac_status status = parse_until(text, c, &until, err);
    if (status != LAC_OK) {
        return status;
    }
    if (!(until > 0) || until > c->run.end) {
        char end[64];
        return lac_fail(err, LAC_EINPUT, "--until: \"%s\" must be > 0 and <= time.end, %s", text,
                        lac_units_format(c->run.end, "s", end, sizeof end));
    }
    c->run.end = until;
    return LAC_OK;
}

// Reads what --resume goes on from.
static lac_status read_checkpoint(run_job *job, lac_error *err)
{
    char time[64];
    lac_status status =
        cli_resume_read(job->path, job->case_text, job->inputs, job->libraries, &job->resume, err);
    if (status == LAC_OK && job->resume.from.time >= job->source->run.end) {
        return lac_fail(err, LAC_EINPUT,
                        "--resume: the checkpoint of %s is at %s, not before the end of the run",
                        job->path, lac_units_format(job->resume.from.time, "s", time, sizeof time));
    }
    return status;
}

// The case as it is run, and what a run before this one has kept of it.
static lac_status settle(run_job *job, lac_error *err)
{
    job->case_text = lac_case_text(job->source);
    job->inputs = cli_inputs_sums(job->source);
    if (job->case_text == NULL || job->inputs == NULL) {
        return lac_fail_memory(err);
    }
    (void)cli_libraries(job->libraries, sizeof job->libraries);
    return cli_given(job->request, CLI_OPT_RESUME) ? read_checkpoint(job, err) : LAC_OK;
}

// All that can be wrong with the request is found here, before anything is computed.
static lac_status prepare(run_job *job, lac_error *err)
{
    lac_status status;
    if (cli_given(job->request, CLI_OPT_RESUME) && cli_given(job->request, CLI_OPT_FORCE)) {
        return lac_fail(err, LAC_EINPUT, "--resume keeps the file, --force replaces it: not both");
    }
    LAC_TRY(cli_case_read(job->request, LAC_FOR_RUN, &job->source, NULL, err));
    if (job->source->history.count > 0 && !cli_given(job->request, CLI_OPT_QUIET)) {
        cli_note("warning: %s: load.history is for lacuna contact; run does not use it",
                 job->source->path);
    }
    LAC_TRY(shorten(job->request->until, job->source, err));
    LAC_TRY(cli_output_path(job->request, job->source, job->source->output_file, ".nc", &job->path,
                            err));
    LAC_TRY(cli_compare_read(job->request, job->source, &job->compare, err));
    if (isnan(job->source->accuracy)) {
        LAC_TRY(settle(job, err));
    }
out:
    return status;
}

static bool goes_on(const run_job *job) { return cli_given(job->request, CLI_OPT_RESUME); }

static lac_status open_store(run_job *job, lac_error *err)
{
    const lac_case *c = job->source;
    lac_store_def def = {
        .path = job->path,
        .force = cli_given(job->request, CLI_OPT_FORCE),
        .provenance = cli_provenance(job->request, c, job->case_text, job->libraries),
        .dated = c->dated,
        .start_date = c->start_date,
        .domain = job->scene->contact.domain,
        .hierarchy = job->scene->hierarchy,
        .transfer = &job->scene->transfer,
        .fields = c->fields,
        .compression = c->compression,
        .single = c->single != 0,
        .sync_every = RECORDS_BETWEEN_SYNCS,
        .events = lac_analysis_has_events(job->analysis),
        .inputs = job->inputs,
        .resume = goes_on(job) ? &job->resume : NULL,
    };
    char accuracy[CLI_ACCURACY_TEXT];
    if (job->accuracy.pilots > 0) {
        def.provenance.accuracy = cli_accuracy_text(&job->accuracy, accuracy, sizeof accuracy);
        def.provenance.accuracy_asked = job->accuracy.asked;
        def.provenance.accuracy_estimated = job->accuracy.estimated;
    }
    def.provenance.fidelity = lac_fidelity_name(c->run.fidelity);
    const double *once = NULL;
    if (job->analysis != NULL) {
        def.extras = lac_analysis_extras(job->analysis, &def.extra, &once);
    }
    cli_view_begin(job->view, &def, once);
    lac_status status = lac_store_create(&def, &job->store, err);
    return status == LAC_OK && once != NULL ? lac_store_once(job->store, once, err) : status;
}

static bool on_interrupted(void *context)
{
    (void)context;
    return cli_signals_stop();
}

static void on_progress(void *context, const lac_progress *now)
{
    run_job *job = context;
    cli_progress_show(&job->progress, now);
    cli_view_progress(job->view, now);
}

static lac_status integrate(run_job *job, lac_run_result *result, lac_error *err)
{
    const lac_sink stored = lac_store_sink(job->store);
    job->history = (cli_history){
        .next = cli_view_sink(job->view, &stored),
        .keep = job->compare.count > 0,
        .clock = job->source->dated ? job->source->start_date : 0,
    };
    lac_sink sink = cli_history_sink(&job->history);
    if (job->analysis != NULL) {
        sink = lac_analysis_sink(job->analysis, &sink);
    }
    lac_run_def def = job->source->run;
    def.interrupted = on_interrupted;
    def.progress = on_progress;
    def.context = job;
    def.resume = goes_on(job) ? &job->resume.from : NULL;
    cli_progress_start(&job->progress, job->request);
    lac_status status = lac_run(job->scene->problem, &def, &sink, result, err);
    cli_progress_clear(&job->progress);
    return status;
}

static const char *status_word(lac_status status)
{
    return status == LAC_OK ? "complete" : status == LAC_EINTERRUPT ? "interrupted" : "failed";
}

// What the indicators know only now.
static lac_status sum_up(run_job *job, const lac_run_result *result, lac_error *err)
{
    const lac_extra *extra;
    const double *once;
    if (job->analysis == NULL) {
        return LAC_OK;
    }
    lac_status status = lac_analysis_finish(job->analysis, result, err);
    (void)lac_analysis_extras(job->analysis, &extra, &once);
    return status == LAC_OK ? lac_store_once(job->store, once, err) : status;
}

static lac_status close_store(run_job *job, lac_status status, const cli_outcome *outcome,
                              lac_error *err)
{
    lac_error late = {0};
    lac_status summed = sum_up(job, &outcome->result, &late);
    lac_status finished = lac_store_finish(job->store, outcome->status, &outcome->result,
                                           outcome->wall_time, summed == LAC_OK ? &late : NULL);
    finished = summed == LAC_OK ? finished : summed;
    if (finished != LAC_OK && (status == LAC_OK || status == LAC_EINTERRUPT)) {
        *err = late;
        return finished;
    }
    if (status == LAC_EINTERRUPT) {
        char time[64];
        bool saved = job->history.saved || goes_on(job);
        return lac_fail(err, status, "interrupted at %s; %s holds the run up to there%s",
                        lac_units_format(outcome->result.time, "s", time, sizeof time), job->path,
                        saved ? ", and --resume goes on" : "");
    }
    return status;
}

// What mends a balance that is off.
static const char *remedy(const run_job *job, const cli_outcome *outcome, bool integrated)
{
    if (outcome->accuracy != NULL) {
        return "the accuracy asked for is kept, but single cells are further off: ask for a "
               "smaller one";
    }
    if (job->source->run.fidelity == LAC_FIDELITY_EVENTS) {
        return "tighten solver.rtol; a spring far stiffer than k_crit = p (b - a)/dc, or damping "
               "where few cells touch on little of the area, needs solver.fidelity: ode";
    }
    return integrated ? "tighten solver.rtol, or see solver.projection and formulation: slip"
                      : "cells at rest are held at the slowest rate that is followed";
}

// A hundredth of the strength: it then shows in what is drawn from the run. Slip is off by some
// five times the drift, which grows as the steps do that a load's swings ask for.
static void warn_of_balance(const run_job *job, const cli_outcome *outcome)
{
    double residual = outcome->result.balance_residual;
    double drift = outcome->result.rate_drift;
    double most = fmin(0.01, fmax(1e-4, 300.0 * job->source->run.rtol));
    bool all_at_once = job->source->run.fidelity == LAC_FIDELITY_ODE;
    bool integrated = lac_problem_formulation(outcome->scene->problem) != LAC_FORMULATION_SLIP;
    const char *mend = remedy(job, outcome, integrated);
    if (!(residual <= 0.01)) {
        cli_note("warning: the traction balance %s by %.2g of the strength; %s",
                 integrated ? "drifted" : "is off", residual, mend);
    } else if (all_at_once && drift > most) {
        cli_note("warning: the mean slip rate is off the traction balance by %.2g of itself, and "
                 "slip by more; %s, or take method: erk",
                 drift, mend);
    }
}

static lac_status print_outcome(const run_job *job, const cli_outcome *outcome, lac_status status,
                                lac_error *err)
{
    if (!cli_given(job->request, CLI_OPT_QUIET)) {
        warn_of_balance(job, outcome);
        cli_failure_warn(&outcome->result.failure);
    }
    if (cli_given(job->request, CLI_OPT_JSON)) {
        const lac_status shown = cli_outcome_json(outcome, status == LAC_OK ? err : NULL);
        status = status == LAC_OK ? shown : status;
    } else if (status == LAC_OK || status == LAC_EINTERRUPT) {
        cli_outcome_print(outcome);
    }
    return status;
}

static lac_status compute(run_job *job, lac_error *err)
{
    // Refused here, a file that --force would replace is still there.
    lac_status status = lac_run_check(job->scene->problem, &job->source->run, err);
    if (status != LAC_OK) {
        return cli_blame(job->source, status, err);
    }
    cli_signals_hold();
    status = open_store(job, err);
    if (status != LAC_OK) {
        return status;
    }
    cli_outcome outcome = {
        .source = job->source,
        .scene = job->scene,
        .history = &job->history,
        .compare = &job->compare,
        .analysis = job->analysis,
        .path = job->path,
        .resumed = goes_on(job) ? &job->resume.from : NULL,
        .accuracy = job->accuracy.pilots > 0 ? &job->accuracy : NULL,
    };
    cli_say(job->request, "integrating to %g s", job->source->run.end);
    status = integrate(job, &outcome.result, err);
    outcome.status = status_word(status);
    outcome.wall_time = cli_clock() - job->started;
    status = close_store(job, status, &outcome, err);
    if (status == LAC_EIO) {
        outcome.status = "failed"; // the file is not whole
    }
    status = print_outcome(job, &outcome, status, err);
    cli_view_end(job->view, outcome.status, cli_outcome_failed(&outcome),
                 status != LAC_OK ? err->message : "");
    return status;
}

lac_status cli_run(const cli_request *request, lac_error *err)
{
    run_job job = {.request = request, .started = cli_clock()};
    lac_status status;
    LAC_TRY(prepare(&job, err));
    LAC_TRY(cli_view_open(request, &job.view, err));
    cli_say(request, "building the scene of %s", request->argument[0]);
    LAC_TRY(cli_blame(job.source, lac_scene_create(job.source, &job.scene, err), err));
    cli_say(request, "%zu contact cells after %.2f s", job.scene->contact.domain->n,
            cli_clock() - job.started);
    if (!isnan(job.source->accuracy)) {
        LAC_TRY(cli_blame(
            job.source,
            cli_accuracy_pick(&job.progress, request, job.scene, job.source, &job.accuracy, err),
            err));
        LAC_TRY(settle(&job, err));
    }
    if (job.source->analysis.count > 0) {
        cli_say(request, "preparing the indicators");
    }
    LAC_TRY(
        cli_blame(job.source, lac_scene_analysis_create(job.scene, NULL, &job.analysis, err), err));
    LAC_TRY(compute(&job, err));
out:
    job_clear(&job);
    return status;
}
