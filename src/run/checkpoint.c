// SPDX-License-Identifier: GPL-3.0-or-later
// What a run goes on from. The integrator has begun anew from y and slip alone when it is saved, so
// that nothing of its past counts; docs/theory/restart.md.
#include <math.h>
#include <stdlib.h>

#include "base/archive.h"
#include "run/run_state.h"

bool lac_run_state_plans(const lac_run_def *def)
{
    const lac_cadence *every = &def->checkpoint;
    return every->steps > 0 || every->time > 0.0 || every->per_decade > 0.0;
}

bool lac_run_state_checkpoint_due(lac_run_state *r)
{
    lac_clock *clock = &r->checkpoint_clock;
    bool due = lac_clock_due(clock, r->mean_rate);
    double now = lac_engine_time(r->engine);
    if (lac_clock_next(clock) <= now) {
        due = true;
        clock->count = (int64_t)floor(now / clock->every.time) + 1;
    }
    return due;
}

// Sum of the values that the problem starts from, as another scene has others; 0 where memory is
// short, which is no sum of anything.
static uint64_t identify(const lac_problem *problem)
{
    double *y = calloc(lac_problem_unknowns(problem), sizeof *y);
    if (y == NULL) {
        return 0;
    }
    lac_problem_initial(problem, y);
    const size_t size = lac_problem_unknowns(problem) * sizeof *y;
    const uint64_t sum = lac_sum_bytes(LAC_SUM_OF_NOTHING, y, size);
    free(y);
    return sum | 1;
}

static void pass_instant(lac_archive *archive, lac_instant *instant)
{
    LAC_PASS(archive, instant->set);
    LAC_PASS(archive, instant->origin);
    LAC_PASS(archive, instant->local);
}

static void pass_clock(lac_archive *archive, lac_clock *clock)
{
    LAC_PASS(archive, clock->count);
    LAC_PASS(archive, clock->steps);
    LAC_PASS(archive, clock->last_log_rate);
}

static void pass_counts(lac_archive *archive, lac_run_result *counts)
{
    LAC_PASS(archive, counts->steps);
    LAC_PASS(archive, counts->rhs_evaluations);
    LAC_PASS(archive, counts->newton_iterations);
    LAC_PASS(archive, counts->linear_solves);
    LAC_PASS(archive, counts->error_test_fails);
    LAC_PASS(archive, counts->nonlinear_fails);
    LAC_PASS(archive, counts->restarts);
}

static void pass_engine(lac_archive *archive, lac_engine *engine)
{
    LAC_PASS(archive, engine->origin);
    LAC_PASS(archive, engine->base);
    LAC_PASS(archive, engine->t);
    LAC_PASS(archive, engine->limit);
    LAC_PASS(archive, engine->step);
    LAC_PASS(archive, engine->order);
    LAC_PASS(archive, engine->beginnings);
    pass_counts(archive, &engine->counts);
    lac_archive_pass(archive, engine->y, engine->unknowns * sizeof *engine->y);
    lac_archive_pass(archive, engine->slip, engine->n * sizeof *engine->slip);
}

// Everything in one order, both ways.
static void pass_course(lac_archive *archive, lac_run_state *r)
{
    pass_engine(archive, r->engine);
    pass_clock(archive, &r->record_clock);
    pass_clock(archive, &r->snapshot_clock);
    pass_clock(archive, &r->checkpoint_clock);
    pass_instant(archive, &r->last_record);
    pass_instant(archive, &r->last_snapshot);
    pass_instant(archive, &r->looked);
    LAC_PASS(archive, r->next_break);
    LAC_PASS(archive, r->mean_rate);
    LAC_PASS(archive, r->max_rate);
    LAC_PASS(archive, r->first_step);
    LAC_PASS(archive, r->steps);
    LAC_PASS(archive, r->result->restarts);
    LAC_PASS(archive, r->result->max_slip_rate);
    LAC_PASS(archive, r->result->balance_residual);
    LAC_PASS(archive, r->result->rate_drift);
    if (r->sink != NULL && r->sink->serialize != NULL) {
        r->sink->serialize(r->sink->context, archive);
    }
}

static void pass_identity(lac_archive *archive, uint64_t *n, uint64_t *formulation, uint64_t *start)
{
    LAC_PASS(archive, *n);
    LAC_PASS(archive, *formulation);
    LAC_PASS(archive, *start);
}

lac_status lac_run_state_checkpoint(lac_run_state *r, bool planned, lac_error *err)
{
    lac_archive archive = {.loading = false};
    uint64_t n = r->engine->n;
    uint64_t formulation = (uint64_t)lac_problem_formulation(r->problem);
    uint64_t start = identify(r->problem);
    if (r->sink == NULL || r->sink->checkpoint == NULL) {
        return LAC_OK;
    }
    pass_identity(&archive, &n, &formulation, &start);
    pass_course(&archive, r);
    lac_status status = LAC_OK;
    if (start == 0 || archive.no_memory) {
        status = lac_fail_memory(err);
    } else if (archive.refused != NULL && planned) {
        status = lac_fail(
            err, LAC_EINPUT,
            "the analysis %s cannot be kept in a checkpoint: leave it or output.checkpoint out",
            archive.refused);
    } else if (archive.refused == NULL) {
        lac_checkpoint checkpoint = {.planned = planned,
                                     .time = lac_engine_time(r->engine),
                                     .size = archive.size,
                                     .state = archive.bytes};
        status = r->sink->checkpoint(r->sink->context, &checkpoint, err);
    }
    free(archive.bytes);
    return status;
}

static lac_status check_identity(const lac_run_state *r, lac_archive *archive, lac_error *err)
{
    uint64_t n = 0;
    uint64_t formulation = 0;
    uint64_t start = 0;
    uint64_t now = identify(r->problem);
    LAC_FAIL_MEMORY_IF(now == 0, err);
    pass_identity(archive, &n, &formulation, &start);
    LAC_FAIL_IF(!lac_archive_good(archive) || n != r->engine->n ||
                    formulation != (uint64_t)lac_problem_formulation(r->problem) || start != now,
                err, LAC_EINPUT,
                "the checkpoint is of another scene: its cells or what they start from have "
                "changed, perhaps a file that the case reads");
    return LAC_OK;
}

lac_status lac_run_state_resume(lac_run_state *r, lac_error *err)
{
    const lac_checkpoint *from = r->def->resume;
    lac_archive archive = {.loading = true, .size = from->size};
    lac_status status = LAC_OK;
    archive.bytes = (unsigned char *)from->state; // only read
    r->record_clock.every = r->def->record;
    r->snapshot_clock.every = r->def->snapshot;
    r->checkpoint_clock.every = r->def->checkpoint;
    LAC_TRY(check_identity(r, &archive, err));
    pass_course(&archive, r);
    LAC_FAIL_MEMORY_IF(archive.no_memory, err);
    LAC_FAIL_IF(!lac_archive_good(&archive) || archive.at != archive.size, err, LAC_EINPUT,
                "the checkpoint does not fit this case and program");
    LAC_FAIL_IF(!(lac_engine_time(r->engine) < r->def->end), err, LAC_EINPUT,
                "the checkpoint is at t = %.9g s, not before the end of the run, %.9g s",
                lac_engine_time(r->engine), r->def->end);
    r->engine->before = r->engine->counts;
out:
    return status;
}
