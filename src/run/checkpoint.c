// SPDX-License-Identifier: GPL-3.0-or-later
// What a run goes on from. The integrator has begun anew from y and slip alone when it is saved, so
// that nothing of its past counts; docs/theory/restart.md.
#include "run/run_state.h"

bool lac_run_state_plans(const lac_run_def *def)
{
    const lac_cadence *every = &def->checkpoint;
    return every->steps > 0 || every->time > 0.0 || every->per_decade > 0.0;
}

bool lac_run_state_checkpoint_due(lac_run_state *r)
{
    lac_run_clock *clock = &r->checkpoint_clock;
    bool due = lac_clock_due(clock, r->mean_rate);
    double now = lac_engine_time(r->engine);
    if (lac_clock_next(clock) <= now) {
        due = true;
        clock->count = (int64_t)floor(now / clock->every.time) + 1;
    }
    return due;
}

// What tells a scene from another.
typedef struct identity {
    uint64_t cells, formulation, start;
} identity;

static void sum(void *context, double *x, size_t n)
{
    *(uint64_t *)context = lac_sum_bytes(*(uint64_t *)context, x, n * sizeof *x);
}

static void keep(void *context, double *x, size_t n)
{
    lac_archive_pass(context, x, n * sizeof *x);
}

// `start` sums the values that the problem starts from; 0 where memory is short, which is no sum of
// anything.
static identity identify(const lac_problem *problem)
{
    const lac_range *range = lac_problem_range(problem);
    identity scene = {.cells = range->all,
                      .formulation = (uint64_t)lac_problem_formulation(problem)};
    double *y = lac_team_alloc(range->team, lac_problem_unknowns(problem) * sizeof *y);
    if (y != NULL) {
        uint64_t of_all = LAC_SUM_OF_NOTHING;
        lac_problem_initial(problem, y);
        const bool good = lac_range_hand(range, y, lac_problem_arrays(problem), sum, &of_all);
        scene.start = good ? of_all | 1 : 0;
    }
    lac_team_follow(range->team, &scene.start);
    free(y);
    return scene;
}

// Arrays of the cells, in the archive those of all: a run goes on on any number of ranks.
static void pass_cells(lac_archive *archive, const lac_range *range, double *x, size_t arrays)
{
    if (!archive->loading) {
        const bool good = lac_range_hand(range, x, arrays, keep, archive);
        archive->no_memory = archive->no_memory || !good;
        return;
    }
    for (size_t a = 0; a < arrays; a++) {
        const size_t at = archive->at, bytes = range->all * sizeof *x;
        archive->short_of = archive->short_of || bytes > archive->size - at;
        if (lac_archive_good(archive)) {
            archive->at += range->first * sizeof *x;
            lac_archive_pass(archive, x + a * range->n, range->n * sizeof *x);
            archive->at = at + bytes;
        }
    }
}

static void pass_engine(lac_archive *archive, lac_engine *engine)
{
    LAC_PASS_RUN(archive, engine->origin, engine->order);
    LAC_PASS(archive, engine->beginnings);
    LAC_PASS_RUN(archive, engine->counts.steps, engine->counts.restarts);
    pass_cells(archive, engine->range, engine->y, lac_problem_arrays(engine->problem));
    pass_cells(archive, engine->range, engine->slip, 1);
}

// Everything in one order, both ways.
static void pass_course(lac_archive *archive, lac_run_state *r)
{
    lac_run_clock *clocks[] = {&r->record_clock, &r->snapshot_clock, &r->checkpoint_clock};
    lac_instant *instants[] = {&r->last_record, &r->last_snapshot, &r->looked};
    pass_engine(archive, r->engine);
    for (size_t i = 0; i < 3; i++) {
        LAC_PASS_RUN(archive, clocks[i]->count, clocks[i]->last_log_rate);
    }
    for (size_t i = 0; i < 3; i++) {
        LAC_PASS(archive, instants[i]->set);
        LAC_PASS_RUN(archive, instants[i]->origin, instants[i]->local);
    }
    LAC_PASS_RUN(archive, r->next_break, r->steps);
    LAC_PASS_RUN(archive, r->result->restarts, r->result->max_slip_rate);
    LAC_PASS_RUN(archive, r->result->balance_residual, r->result->rate_drift);
    if (lac_problem_safety_asked(r->problem).asked) {
        LAC_PASS(archive, r->result->safety);
        LAC_PASS(archive, r->safety_time);
    }
    if (lac_problem_bends(r->problem)) {
        LAC_PASS(archive, r->result->arrest.largest);
        LAC_PASS(archive, r->result->arrest.largest_time);
    }
    if (r->sink != NULL && r->sink->serialize != NULL) {
        r->sink->serialize(r->sink->context, archive);
    }
}

lac_status lac_run_state_checkpoint(lac_run_state *r, bool planned, lac_error *err)
{
    lac_archive archive = {.loading = false};
    if ((r->takes & LAC_TAKES_CHECKPOINT) == 0) {
        return LAC_OK;
    }
    identity scene = identify(r->problem);
    LAC_PASS(&archive, scene);
    pass_course(&archive, r);
    lac_status status = LAC_OK;
    if (scene.start == 0 || archive.no_memory) {
        status = lac_fail_memory(err);
    } else if (archive.refused != NULL && planned) {
        status = lac_fail(
            err, LAC_EINPUT,
            "the analysis %s cannot be kept in a checkpoint: leave it or output.checkpoint out",
            archive.refused);
    } else if (archive.refused == NULL && lac_run_state_leads(r)) {
        lac_checkpoint checkpoint = {.planned = planned,
                                     .time = lac_engine_time(r->engine),
                                     .size = archive.size,
                                     .state = archive.bytes};
        status = r->sink->checkpoint(r->sink->context, &checkpoint, err);
    }
    free(archive.bytes);
    return lac_run_state_agree(r, status, err);
}

static lac_status check_identity(const lac_run_state *r, lac_archive *archive, lac_error *err)
{
    identity kept = {0}, scene = identify(r->problem);
    LAC_FAIL_MEMORY_IF(scene.start == 0, err);
    LAC_PASS(archive, kept);
    LAC_FAIL_IF(
        !lac_archive_good(archive) || memcmp(&kept, &scene, sizeof kept) != 0, err, LAC_EINPUT,
        "the checkpoint is of another scene: %s",
        r->def->fidelity == LAC_FIDELITY_LUMPED
            ? "other cells stand for all: the end of the run, a file or the program has changed"
            : "its cells or what they start from have changed, perhaps a file of the case");
    return LAC_OK;
}

lac_status lac_run_state_resume(lac_run_state *r, lac_error *err)
{
    const lac_checkpoint *from = r->def->resume;
    lac_archive archive = {.loading = true, .size = from->size};
    archive.bytes = (unsigned char *)from->state; // only read
    r->record_clock.every = r->def->record;
    r->snapshot_clock.every = r->def->snapshot;
    r->checkpoint_clock.every = r->def->checkpoint;
    LAC_TRY_RETURN(check_identity(r, &archive, err));
    pass_course(&archive, r);
    LAC_FAIL_MEMORY_IF(archive.no_memory, err);
    const bool alone =
        r->def->reached != NULL || !lac_run_state_leads(r); // what sinks kept is left
    LAC_FAIL_IF(!lac_archive_good(&archive) || (archive.at != archive.size && !alone), err,
                LAC_EINPUT, "the checkpoint does not fit this case and program");
    LAC_FAIL_IF(!(lac_engine_time(r->engine) < r->def->end) &&
                    !(alone && lac_engine_time(r->engine) == r->def->end),
                err, LAC_EINPUT,
                "the checkpoint is at t = %.9g s, not before the end of the run, %.9g s",
                lac_engine_time(r->engine), r->def->end);
    r->engine->before = r->engine->counts;
    return LAC_OK;
}
