// SPDX-License-Identifier: GPL-3.0-or-later
// The one way from a case to what came out of its run, which goes into a sink, into memory or into
// a file.
#include "simulation/internal.h"
#include "simulation/lumped.h"

#include <omp.h>

#include "base/ask.h"
#include "scene/estimate.h"

struct lac_simulation {
    lac_case source; // the caller's, which owns all, but for what pilot runs picked
    lac_simulation_options options;
    lac_scene *scene;
    lac_points *points;             // NULL where the case names none
    lac_critical_fraction critical; // for its indicators
    lac_analysis *analysis;         // NULL where the case names none
    lac_fidelity_choice fidelity;
    lac_accuracy_pick accuracy;
    lac_take take;      // a pilot run that is the run, with its indicators
    lac_branch *branch; // NULL where the case goes on from no other run
    const lac_checkpoint *resume;
    char *case_text; // NULL: not asked for yet
    char lumped[160];
    bool begun;
    lac_outcome outcome;
};

static void prepared(lac_simulation *s, lac_stage stage)
{
    if (s->options.prepared != NULL) {
        s->options.prepared(s->options.context, stage, s);
    }
}

// The scene, and what it begins from where it goes on from another run.
static lac_status build_scene(lac_simulation *s, lac_error *err)
{
    if (s->source.from.file == NULL) {
        return lac_scene_create(&s->source, NULL, &s->scene, err);
    }
    LAC_TRY_RETURN(lac_branch_open(&s->source, &s->branch, err));
    LAC_TRY_RETURN(lac_branch_reach(s->branch, &s->options, &s->scene, err));
    s->source.run.start = &s->branch->start;
    s->outcome.branch = s->branch;
    return LAC_OK;
}

// Indicators that know nothing yet. Those of a pilot run stay with it, as others may know of them.
static lac_status make_indicators(lac_simulation *s, lac_error *err)
{
    return lac_indicators_create(s->scene, &s->critical, &s->analysis, err);
}

static void show_indicators(lac_simulation *s)
{
    s->outcome.analysis = s->analysis;
    if (s->analysis != NULL) {
        s->outcome.extras = lac_analysis_extras(s->analysis, &s->outcome.extra, &s->outcome.once);
    }
}

static lac_status pick_settings(lac_simulation *s, lac_error *err)
{
    const lac_accuracy_def how = {
        .scene = s->scene, .points = s->points, .critical = &s->critical, .options = &s->options};
    LAC_TRY_RETURN(lac_accuracy_choose(&how, &s->source, &s->accuracy, &s->take, err));
    s->outcome.accuracy = &s->accuracy;
    return LAC_OK;
}

static lac_status build(lac_simulation *s, lac_error *err)
{
    // Half of an error for all is for the pilot runs, half for taking cells together.
    const bool halves = s->source.run.fidelity == LAC_FIDELITY_LUMPED && !isnan(s->source.accuracy);
    if (halves) {
        s->source.accuracy *= 0.5;
        s->source.lump.error = fmin(s->source.lump.error, s->source.accuracy);
    }
    LAC_TRY_RETURN(build_scene(s, err));
    s->outcome.scene = s->scene;
    LAC_TRY_RETURN(lac_fidelity_settle(s->scene, &s->source, &s->fidelity, err));
    s->outcome.fidelity_why = s->fidelity.why[0] != '\0' ? s->fidelity.why : NULL;
    s->outcome.fidelity_error = s->fidelity.error;
    if (s->source.points > 0) {
        LAC_TRY_RETURN(lac_points_create(s->scene->contact.domain, s->source.points,
                                         s->source.point, &s->points, err));
        s->outcome.points = s->points;
    }
    prepared(s, LAC_STAGE_SCENE);
    const bool picks = !isnan(s->source.accuracy);
    if (picks) {
        LAC_TRY_RETURN(lac_indicators_prepare(s->scene, &s->critical, err));
        LAC_TRY_RETURN(pick_settings(s, err));
    }
    s->accuracy.asked *= halves ? 2.0 : 1.0;
    prepared(s, LAC_STAGE_ACCURACY);
    LAC_TRY_RETURN(picks ? LAC_OK : lac_indicators_prepare(s->scene, &s->critical, err));
    s->analysis = s->take.whole ? s->take.analysis : NULL;
    LAC_TRY_RETURN(s->take.whole ? LAC_OK : make_indicators(s, err));
    show_indicators(s);
    return lac_run_check(lac_scene_problem(s->scene), &s->source.run, err);
}

// Sets a number of threads, 0: leaves it.
// @return what sets it back
static int set_threads(int threads)
{
    const int before = omp_get_max_threads();
    if (threads > 0) {
        omp_set_num_threads(threads);
    }
    return threads > 0 ? before : 0;
}

lac_status lac_simulation_create(const lac_case *c, const lac_simulation_options *options,
                                 lac_simulation **out, lac_error *err)
{
    lac_status status;
    LAC_TRY_RETURN(LAC_NEED(err, c, out));
    lac_simulation *s = *out = calloc(1, sizeof *s);
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    s->source = *c;
    if (c->use != NULL) {
        c->use->simulations++; // it does not change from now on
    }
    s->outcome = (lac_outcome){.source = &s->source, .status = "running"};
    s->options = lac_simulation_options_default();
    LAC_TRY(
        lac_take_options("lac_simulation_options", options, &s->options, sizeof s->options, err));
    LAC_TRY(lac_case_serves(c, LAC_FOR_RUN, err));
    const int before = set_threads(s->options.threads);
    status = build(s, err);
    (void)set_threads(before);
    LAC_TRY(status);
out:
    LAC_MADE(status, out, lac_simulation_free);
}

void lac_simulation_free(lac_simulation *simulation)
{
    if (simulation == NULL) {
        return;
    }
    if (simulation->analysis != simulation->take.analysis) {
        lac_analysis_free(simulation->analysis);
    }
    lac_take_clear(&simulation->take);
    lac_points_free(simulation->points);
    lac_scene_free(simulation->scene);
    lac_branch_free(simulation->branch);
    lac_case_use *use = simulation->source.use;
    if (use != NULL && --use->simulations == 0 && use->freed) {
        free(use);
    }
    free(simulation->case_text);
    free(simulation);
}

void lac_simulation_resume(lac_simulation *simulation, const lac_checkpoint *from)
{
    simulation->resume = from;
}

const lac_outcome *lac_simulation_outcome(const lac_simulation *simulation)
{
    return &simulation->outcome;
}

const lac_run_result *lac_simulation_result(const lac_simulation *simulation)
{
    return simulation != NULL ? &simulation->outcome.run : NULL;
}

const lac_accuracy_pick *lac_simulation_accuracy(const lac_simulation *simulation)
{
    return simulation != NULL ? simulation->outcome.accuracy : NULL;
}

const lac_extra *lac_simulation_extra(const lac_simulation *simulation, size_t index)
{
    return simulation != NULL && index < simulation->outcome.extras
               ? &simulation->outcome.extra[index]
               : NULL;
}

// What the indicators know by now.
static lac_status put_once(lac_simulation *s, const lac_sink *sink, lac_error *err)
{
    if (s->analysis == NULL) {
        return LAC_OK;
    }
    (void)lac_analysis_extras(s->analysis, &s->outcome.extra, &s->outcome.once);
    return sink != NULL && sink->once != NULL ? sink->once(sink->context, s->outcome.once, err)
                                              : LAC_OK;
}

static lac_status sum_up(lac_simulation *s, const lac_sink *sink, lac_error *err)
{
    if (s->analysis != NULL && !s->take.whole && lac_team_leads(s->source.team)) {
        LAC_TRY_RETURN(lac_analysis_finish(s->analysis, &s->outcome.run, err));
    }
    return put_once(s, sink, err);
}

// The pilot run is the run, but for who looks at every step or goes on from a checkpoint.
static lac_status decide(lac_simulation *s, const lac_sink *sink, lac_error *err)
{
    const bool again =
        s->resume != NULL || (sink != NULL && sink->step != NULL && !s->take.tape.steps);
    if (!s->take.whole || !again) {
        return LAC_OK;
    }
    s->take.whole = s->accuracy.kept = false;
    LAC_TRY_RETURN(make_indicators(s, err));
    show_indicators(s);
    return LAC_OK;
}

static lac_status integrate(lac_simulation *s, const lac_sink *sink, lac_error *err)
{
    static const lac_sink nowhere;
    if (s->take.whole) {
        s->outcome.run = s->take.run;
        return lac_tape_play(&s->take.tape, sink != NULL ? sink : &nowhere, err);
    }
    lac_sink through;
    lac_run_def def = s->source.run;
    def.interrupted = s->options.interrupted;
    def.progress = s->options.progress;
    def.context = s->options.context;
    def.resume = s->resume;
    def.points = s->points;
    if (s->analysis != NULL) {
        through = lac_analysis_sink(s->analysis, sink != NULL ? sink : &nowhere);
    }
    if (s->scene->lump != NULL) {
        return lac_lumped_run(s->scene, &def, sink, &s->outcome.run, err);
    }
    return lac_run(lac_scene_problem(s->scene), &def, s->analysis != NULL ? &through : sink,
                   &s->outcome.run, err);
}

static const char *status_word(lac_status status)
{
    return status == LAC_OK ? "complete" : status == LAC_EINTERRUPT ? "interrupted" : "failed";
}

lac_status lac_simulation_run(lac_simulation *simulation, const lac_sink *given, lac_error *err)
{
    lac_simulation *s = simulation;
    lac_sink own = lac_sink_default();
    const lac_sink *sink = given != NULL ? &own : NULL;
    lac_error late = {""};
    lac_status status;
    LAC_TRY(LAC_NEED(err, simulation));
    LAC_TRY(lac_take_options("lac_sink", given, &own, sizeof own, err));
    LAC_FAIL_IF(s->begun, err, LAC_EINPUT, "%s: this simulation was run already", s->source.path);
    s->begun = true;
    const int before = set_threads(s->options.threads);
    status = decide(s, sink, err);
    status = status == LAC_OK ? put_once(s, sink, err) : status;
    status = lac_team_agree(s->source.team, status, err);
    if (status == LAC_OK) {
        status = integrate(s, sink, err);
        // The indicators sum up however the run ended; why it broke counts for more.
        const lac_status summed = sum_up(s, sink, &late);
        if (summed != LAC_OK && (status == LAC_OK || status == LAC_EINTERRUPT)) {
            status = lac_fail(err, summed, "%s", late.message);
        }
    }
    (void)set_threads(before);
    s->outcome.status = status_word(status);
out:
    return status;
}

static lac_run_output output_of(const lac_outcome *of)
{
    return (lac_run_output){.vector = lac_problem_is_vector(of->scene->problem),
                            .domain = of->scene->contact.domain,
                            .hierarchy = of->scene->hierarchy,
                            .transfer = &of->scene->transfer,
                            .fields = of->source->fields,
                            .loads = &of->scene->loads,
                            .safety = of->source->safety,
                            .weakening = &of->scene->weakening,
                            .extras = of->extras,
                            .extra = of->extra,
                            .points = of->points,
                            .events = lac_analysis_has_events(of->analysis),
                            .dated = of->source->dated,
                            .start_date = of->source->start_date};
}

// Records between syncs: what a kill loses is little to compute again.
static int64_t records_between_syncs(const lac_simulation *s)
{
    const size_t work = 1 << 19, least = 64, most = 512; // cells times records
    const size_t records = work / s->scene->contact.domain->n;
    return (int64_t)(records < least ? least : records > most ? most : records);
}

lac_status lac_simulation_file(lac_simulation *simulation, lac_store_def *out, lac_error *err)
{
    lac_simulation *s = simulation;
    const lac_case *c = &s->source;
    s->case_text = s->case_text != NULL ? s->case_text : lac_case_text(c);
    LAC_FAIL_MEMORY_IF(s->case_text == NULL, err);
    *out = (lac_store_def){.path = c->output_file,
                           .provenance = lac_case_provenance(c, s->case_text),
                           .of = output_of(&s->outcome),
                           .compression = c->compression,
                           .single = c->single != 0,
                           .sync_every = records_between_syncs(s)};
    if (s->branch != NULL) {
        out->provenance.branch = s->branch->text;
        out->provenance.branch_file = c->from.file;
        out->provenance.branch_changes = s->branch->changes;
        out->provenance.branch_case_sum = s->branch->sum;
        out->provenance.branch_time = s->branch->time;
    }
    out->provenance.fidelity = lac_fidelity_name(c->run.fidelity);
    out->provenance.fidelity_why = s->outcome.fidelity_why;
    out->provenance.fidelity_error = s->outcome.fidelity_error;
    if (s->scene->lump != NULL) {
        (void)snprintf(
            s->lumped, sizeof s->lumped,
            "%zu cells stand for %zu: each cell has the values of the one that is most like it",
            s->scene->lump->domain->n, s->scene->contact.domain->n);
        out->provenance.lumped = s->lumped;
    }
    if (s->outcome.accuracy != NULL) {
        out->provenance.accuracy = s->accuracy.text;
        out->provenance.accuracy_asked = s->accuracy.asked;
        out->provenance.accuracy_estimated = s->accuracy.estimated;
    }
    return LAC_OK;
}

static lac_status conclude(lac_simulation *s, lac_recording *recording, lac_error *err)
{
    lac_store_def def;
    LAC_TRY_RETURN(lac_simulation_file(s, &def, err));
    return lac_recording_conclude(recording, &def.provenance, s->outcome.status, &s->outcome.run,
                                  def.single, err);
}

lac_status lac_simulation_record(lac_simulation *simulation, lac_dataset **out, lac_error *err)
{
    lac_recording *recording = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, simulation, out));
    *out = NULL;
    const lac_outcome *outcome = lac_simulation_outcome(simulation);
    const lac_recording_def def = output_of(outcome);
    LAC_TRY(lac_recording_create(&def, &recording, err));
    const lac_sink sink = lac_recording_sink(recording);
    const lac_status ended = lac_simulation_run(simulation, &sink, err);
    if (ended == LAC_OK || ended == LAC_EINTERRUPT) {
        LAC_TRY(conclude(simulation, recording, err));
        *out = lac_recording_hand_out(recording);
        recording = NULL;
    }
    status = ended;
out:
    lac_recording_free(recording);
    return status;
}

static lac_status open_file(lac_simulation *simulation, const char *path,
                            const lac_write_options *options, lac_store **out, lac_error *err)
{
    lac_store_def def;
    LAC_TRY_RETURN(lac_simulation_file(simulation, &def, err));
    lac_provenance_sign(&def.provenance, options);
    def.path = path != NULL ? path : def.path;
    def.force = options->force;
    return def.path != NULL
               ? lac_store_create(&def, out, err)
               : lac_fail(err, LAC_EINPUT, "%s: names no output.file, nor does the caller",
                          lac_simulation_outcome(simulation)->source->path);
}

lac_status lac_simulation_write(lac_simulation *simulation, const char *path,
                                const lac_write_options *options, lac_error *err)
{
    lac_write_options own = lac_write_options_default();
    lac_store *store = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, simulation));
    LAC_TRY(lac_take_options("lac_write_options", options, &own, sizeof own, err));
    LAC_TRY(open_file(simulation, path, &own, &store, err));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    const lac_sink sink = lac_store_sink(store);
    const lac_status ran = lac_simulation_run(simulation, &sink, err);
    status = lac_store_finish(store, of->status, &of->run, NAN, ran == LAC_OK ? err : NULL);
    status = ran == LAC_OK ? status : ran;
out:
    lac_store_free(store);
    return status;
}
