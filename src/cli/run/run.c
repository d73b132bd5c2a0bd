// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna run: a simulation with its file, its page and its progress.
#define _GNU_SOURCE // asprintf

#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/run/run_outcome.h"
#include "cli/view/view.h"
#include "simulation/branch.h"

// Everything that a run holds.
typedef struct run_job {
    const cli_request *request;
    lac_case *source;
    cli_outcome outcome;
    lac_simulation *simulation;
    lac_store *store; // NULL: not begun to write
    cli_progress progress;
    cli_view *view; // with --view
    char *inputs;
    lac_checkpoint_file resume; // with --resume
    double started;
} run_job;

static void job_clear(run_job *job)
{
    cli_view_close(job->view);
    lac_store_free(job->store);
    lac_simulation_free(job->simulation);
    cli_compare_clear(&job->outcome.compare);
    lac_checkpoint_file_clear(&job->resume);
    free(job->outcome.history.kept.values);
    lac_slip_events_clear(&job->outcome.history.slip_events);
    free(job->outcome.path);
    free(job->inputs);
    lac_case_free(job->source);
}

static bool goes_on(const run_job *job) { return cli_given(job->request, CLI_OPT_RESUME); }

enum { LINE = 199 }; // bytes of a line that messages show

// The line of a resolved case here, or the next that may not differ; "" at the end.
// @param section  that it is of
static const char *find_line(const char *at, const char **section)
{
    static const char *const free_lines[][2] = {
        {"time:\n", "  end:"}, {"solver:\n", "  max_steps:"}, {"output:\n", "  file:"}};
    for (bool differs = true; differs;) {
        *section = *at != ' ' ? at : *section;
        differs = false;
        for (size_t i = 0; i < sizeof free_lines / sizeof *free_lines; i++) {
            differs |= strncmp(*section, free_lines[i][0], strlen(free_lines[i][0])) == 0 &&
                       strncmp(at, free_lines[i][1], strlen(free_lines[i][1])) == 0;
        }
        at += differs ? strcspn(at, "\n") : 0;
        at += differs && *at == '\n';
    }
    return at;
}

static cli_text shown(const char *line, const char *nothing)
{
    const int length = (int)strcspn(line, "\n"), indent = (int)strspn(line, " ");
    return length == 0
               ? cli_format("%s", nothing)
               : cli_format("%.*s", (length < LINE ? length : LINE) - indent, line + indent);
}

static lac_status compare_cases(const char *path, const char *then, const char *now, lac_error *err)
{
    const char *section[] = {then, now};
    size_t length = 0;
    do {
        then = find_line(then + length, &section[0]);
        now = find_line(now + length, &section[1]);
        length = strcspn(then, "\n") + 1; // with its end
        LAC_FAIL_IF(strncmp(then, now, length) != 0, err, LAC_EINPUT,
                    "--resume: %s was begun with another case: it said %s %s, now %s %s", path,
                    shown(section[0], "").s, shown(then, "(nothing)").s, shown(section[1], "").s,
                    shown(now, "(nothing)").s);
    } while (then[length - 1] != '\0');
    return LAC_OK;
}

// Reads the checkpoint of a run's file and sees that this program and this case can go on from it.
// What may differ: time.end, solver.max_steps, and the name of the file.
static lac_status read_resumed(run_job *job, const char *case_text, lac_error *err)
{
    char status_word[32];
    const char *path = job->outcome.path, *libraries = job->request->libraries;
    const char *program = lac_checkpoint_file_program();
    lac_checkpoint_file *from = &job->resume;
    LAC_TRY_RETURN(lac_store_read_attribute(path, "status", status_word, sizeof status_word, err));
    LAC_FAIL_IF(strcmp(status_word, "complete") == 0, err, LAC_EINPUT, "--resume: %s is complete",
                path);
    LAC_TRY_RETURN(lac_checkpoint_file_read(path, from, err));
    LAC_FAIL_IF(strcmp(from->program, program) != 0 || strcmp(from->libraries, libraries) != 0, err,
                LAC_EINPUT, "--resume: the checkpoint of %s is of %s with %s; this is %s with %s",
                path, from->program, from->libraries, program, libraries);
    LAC_TRY_RETURN(compare_cases(path, from->case_text, case_text, err));
    LAC_FAIL_IF(from->from.time >= job->source->run.end, err, LAC_EINPUT,
                "--resume: the checkpoint of %s is at %s, not before the end of the run", path,
                cli_exact(from->from.time, "s").s);
    return LAC_OK;
}

// Reads what --resume goes on from, of the case as it is run.
static lac_status read_checkpoint(run_job *job, const lac_case *c, lac_error *err)
{
    char *text = lac_case_text(c), *whole = NULL;
    const bool there = text != NULL && asprintf(&whole, "%s%s", text, job->inputs) >= 0;
    const lac_status status = there ? read_resumed(job, whole, err) : lac_fail_memory(err);
    free(text);
    free(there ? whole : NULL);
    return status;
}

// Whether a case is the one that is run once its scene is there.
static bool settled_late(const lac_case *c)
{
    return !isnan(c->accuracy) || c->run.fidelity == LAC_FIDELITY_AUTO;
}

// All that can be wrong with the request is found here, before anything is computed.
static lac_status prepare(run_job *job, lac_error *err)
{
    LAC_FAIL_IF(goes_on(job) && cli_given(job->request, CLI_OPT_FORCE), err, LAC_EINPUT,
                "--resume keeps the file, --force replaces it: not both");
    LAC_TRY_RETURN(cli_case_read(job->request, LAC_FOR_RUN, &job->source, NULL, err));
    job->source->team = job->request->team;
    if (job->source->history.count > 0 && !cli_given(job->request, CLI_OPT_QUIET)) {
        cli_note("warning: %s: load.history is for lacuna contact; run does not use it",
                 job->source->path);
    }
    LAC_TRY_RETURN(cli_until(job->request, job->source, &job->source->run.end, err));
    const bool alone = job->request->count == 0; // the case of --from, whose file stays
    LAC_TRY_RETURN(cli_output_path(job->request, job->source,
                                   alone ? NULL : job->source->output_file,
                                   alone ? "-branch.nc" : ".nc", &job->outcome.path, err));
    LAC_TRY_RETURN(cli_compare_read(job->request, job->source, &job->outcome.compare, err));
    job->inputs = cli_inputs_sums(job->source);
    LAC_FAIL_MEMORY_IF(job->inputs == NULL, err);
    if (goes_on(job) && !settled_late(job->source)) {
        LAC_TRY_RETURN(read_checkpoint(job, job->source, err));
    }
    return LAC_OK;
}

// Of pilot runs too, which are not on the page.
static void on_progress(void *context, const lac_progress *now)
{
    run_job *job = context;
    cli_progress_show(&job->progress, now);
    if (job->store != NULL) {
        cli_view_progress(job->view, now);
    }
}

// Who asks where nothing touches gets the motion of what does.
static void warn_of_points(const lac_points *points)
{
    enum { MOST_TOLD = 5 };
    size_t beside = 0;
    for (size_t i = 0; points != NULL && i < points->n; i++) {
        const lac_point *p = &points->point[i];
        beside += p->beside ? 1 : 0;
        if (p->beside && beside <= MOST_TOLD) {
            cli_note("warning: output.points: %s is not in contact: what is kept is of the nearest "
                     "contact cell, %s away, at x %s, y %s",
                     p->name, cli_amount(p->distance, "m").s, cli_amount(p->cell_x, "m").s,
                     cli_amount(p->cell_y, "m").s);
        }
    }
    if (beside > MOST_TOLD) {
        cli_note("warning: output.points: so it is with %zu more (point_distance in the file)",
                 beside - MOST_TOLD);
    }
}

static void on_prepared(void *context, lac_stage stage, const lac_simulation *simulation)
{
    const lac_outcome *so_far = lac_simulation_outcome(simulation);
    run_job *job = context;
    const cli_request *request = job->request;
    if (stage == LAC_STAGE_SCENE) {
        cli_say(request, "%zu contact cells after %.2f s", so_far->scene->contact.domain->n,
                cli_clock() - job->started);
        if (!cli_given(request, CLI_OPT_QUIET)) {
            warn_of_points(so_far->points);
        }
        if (!isnan(job->source->accuracy)) {
            cli_signals_hold(); // to say what a signal cut
            cli_say(request, "pilot runs for an error of %g", job->source->accuracy);
            cli_progress_start(&job->progress, request);
        }
        return;
    }
    cli_progress_clear(&job->progress);
    if (so_far->branch != NULL && !cli_given(request, CLI_OPT_QUIET)) {
        cli_note("%s", so_far->branch->text);
    }
    if (so_far->accuracy != NULL && !cli_given(request, CLI_OPT_QUIET)) {
        cli_note("accuracy: %s", so_far->accuracy->text);
    }
    if (so_far->source->analysis.count > 0) {
        cli_say(request, "preparing the indicators");
    }
}

static lac_status create(run_job *job, lac_error *err)
{
    lac_simulation_options options = lac_simulation_options_default();
    options.interrupted = cli_signals_stop;
    options.progress = on_progress;
    options.prepared = on_prepared;
    options.cells_unread = true;
    options.steps = true; // slip_events
    options.live = job->view != NULL;
    options.context = job;
    const lac_status status = lac_simulation_create(job->source, &options, &job->simulation, err);
    cli_progress_clear(&job->progress);
    if (status == LAC_EINTERRUPT) {
        const lac_error when = *err;
        (void)lac_fail(err, status,
                       "%s of a pilot run for solver.accuracy: no run was picked yet, so that no "
                       "file was made; a case with rtol in its place keeps what it has come to",
                       when.message);
    }
    return cli_blame(job->source, status, err);
}

static lac_status open_store(run_job *job, const lac_outcome *so_far, lac_error *err)
{
    lac_store_def def;
    LAC_TRY_RETURN(lac_simulation_file(job->simulation, &def, err));
    cli_sign(job->request, &def.provenance);
    def.path = job->outcome.path;
    def.force = cli_given(job->request, CLI_OPT_FORCE);
    def.inputs = job->inputs;
    if (goes_on(job)) {
        def.resume = &job->resume;
        lac_simulation_resume(job->simulation, &job->resume.from);
    }
    cli_view_begin(job->view, &def, so_far->once);
    return lac_store_create(&def, &job->store, err);
}

static lac_status integrate(run_job *job, lac_error *err)
{
    const lac_sink stored = lac_store_sink(job->store);
    job->outcome.history = (cli_history){
        .next = cli_view_sink(job->view, &stored),
        .keep = job->outcome.compare.count > 0,
        .kept.points = job->source->points,
        .clock = job->source->dated ? job->source->start_date : 0,
    };
    const lac_sink sink = cli_history_sink(&job->outcome.history);
    cli_progress_start(&job->progress, job->request);
    lac_status status = lac_simulation_run(job->simulation, &sink, err);
    cli_progress_clear(&job->progress);
    return status;
}

static lac_status close_store(run_job *job, lac_status status, lac_error *err)
{
    lac_error late = {0};
    const cli_outcome *outcome = &job->outcome;
    const lac_run_result *run = &outcome->of->run;
    lac_status finished =
        lac_store_finish(job->store, outcome->status, run, outcome->wall_time, &late);
    if (finished != LAC_OK && (status == LAC_OK || status == LAC_EINTERRUPT)) {
        *err = late;
        return finished;
    }
    if (status == LAC_EINTERRUPT) {
        const bool saved = lac_store_has_checkpoint(job->store);
        return lac_fail(err, status, "interrupted at %s; %s holds the run up to there%s",
                        cli_exact(run->time, "s").s, outcome->path,
                        saved ? ", and --resume goes on" : "");
    }
    return status;
}

// What mends a balance that is off.
static const char *remedy(const lac_outcome *of, bool integrated)
{
    if (of->accuracy != NULL) {
        return "the accuracy asked for is kept, but single cells are further off: ask for a "
               "smaller one";
    }
    if (of->source->run.fidelity == LAC_FIDELITY_ASYNC) {
        return "tighten solver.rtol; a spring far stiffer than k_crit = p (b - a)/dc, or damping "
               "where few cells touch on little of the area, needs solver.fidelity: ode";
    }
    return integrated ? "tighten solver.rtol, or see solver.projection and formulation: slip"
                      : "cells at rest are held at the slowest rate that is followed";
}

// A hundredth of the strength: it then shows in what is drawn from the run. Slip is off by some
// five times the drift, which grows as the steps do that a load's swings ask for.
static void warn_of_balance(const lac_outcome *of)
{
    double residual = of->run.balance_residual, drift = of->run.rate_drift;
    double most = fmin(0.01, fmax(1e-4, 300.0 * of->source->run.rtol));
    bool all_at_once = of->source->run.fidelity != LAC_FIDELITY_ASYNC;
    bool integrated = lac_problem_formulation(of->scene->problem) != LAC_FORMULATION_SLIP;
    const char *mend = remedy(of, integrated);
    if (!(residual <= 0.01)) {
        cli_note("warning: the traction balance %s by %.2g of the strength; %s",
                 integrated ? "drifted" : "is off", residual, mend);
    } else if (all_at_once && drift > most) {
        cli_note("warning: the mean slip rate is off the traction balance by %.2g of itself, and "
                 "slip by more; %s, or take method: erk",
                 drift, mend);
    }
}

// Checkpoints that a run planned closer than its steps bear: docs/theory/restart.md.
static void warn_of_checkpoints(const lac_outcome *of)
{
    const lac_cadence *every = &of->source->run.checkpoint;
    const double steps = (double)of->run.steps;
    double planned = every->steps > 0 ? steps / (double)every->steps : 0.0;
    planned = every->time > 0.0 ? fmax(planned, fmin(of->run.time / every->time, steps)) : planned;
    if (planned > 10.0 && steps < LAC_CLOSE_STEPS * planned) {
        cli_note("warning: output.checkpoint: some %.2g in %.0f steps, %.2g steps apart: the "
                 "integrator began anew at each, so that most of these steps are theirs; %d steps "
                 "or more between them cost little",
                 planned, steps, steps / planned, 5 * LAC_CLOSE_STEPS);
    }
}

static lac_status print_outcome(const run_job *job, lac_status status, lac_error *err)
{
    const cli_outcome *outcome = &job->outcome;
    if (!cli_given(job->request, CLI_OPT_QUIET)) {
        if (status == LAC_OK || status == LAC_EINTERRUPT) {
            warn_of_balance(outcome->of);
        }
        warn_of_checkpoints(outcome->of);
        cli_failure_warn(&outcome->of->run.failure);
    }
    if (cli_given(job->request, CLI_OPT_JSON)) {
        const lac_status shown = cli_outcome_json(outcome, status == LAC_OK ? err : NULL);
        return status == LAC_OK ? shown : status;
    }
    if (status == LAC_OK || status == LAC_EINTERRUPT) {
        cli_outcome_print(outcome);
    }
    return status;
}

static lac_status compute(run_job *job, lac_error *err)
{
    cli_outcome *outcome = &job->outcome;
    outcome->of = lac_simulation_outcome(job->simulation);
    outcome->resumed = goes_on(job) ? &job->resume.from : NULL;
    cli_signals_hold();
    lac_team *team = job->request->team;
    lac_status status = lac_team_leads(team) ? open_store(job, outcome->of, err) : LAC_OK;
    if (!lac_team_leads(team) && goes_on(job)) {
        lac_simulation_resume(job->simulation, &job->resume.from);
    }
    LAC_TRY_RETURN(lac_team_agree(team, status, err));
    if (!lac_team_leads(team)) { // which has the file, and tells
        return lac_simulation_run(job->simulation, NULL, err);
    }
    cli_say(job->request, "integrating to %g s", job->source->run.end);
    status = integrate(job, err);
    outcome->status = outcome->of->status;
    outcome->wall_time = cli_clock() - job->started;
    status = close_store(job, status, err);
    if (status == LAC_EIO) {
        outcome->status = "failed"; // the file is not whole
    }
    status = print_outcome(job, status, err);
    cli_view_end(job->view, outcome->status, cli_outcome_failed(outcome),
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
    LAC_TRY(create(&job, err));
    if (goes_on(&job) && settled_late(job.source)) {
        LAC_TRY(read_checkpoint(&job, lac_simulation_outcome(job.simulation)->source, err));
    }
    LAC_TRY(compute(&job, err));
out:
    job_clear(&job);
    return status;
}
