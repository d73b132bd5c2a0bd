// SPDX-License-Identifier: GPL-3.0-or-later
// What a run goes on from. The integrator has begun anew from y and slip alone when it is saved, so
// that nothing of its past counts; docs/theory/restart.md.
#include <math.h>
#include <stdlib.h>

#include "run/course.h"

#define PASS(tape, thing) lac_tape_pass(tape, &(thing), sizeof(thing))

bool lac_course_plans(const lac_run_def *def)
{
    const lac_cadence *every = &def->checkpoint;
    return every->steps > 0 || every->time > 0.0 || every->per_decade > 0.0;
}

bool lac_course_checkpoint_due(lac_course *r)
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

// FNV-1a on the values that the problem starts from: another scene has others.
static uint64_t sum_start(const lac_problem *problem, const double *y)
{
    const unsigned char *bytes = (const unsigned char *)y;
    size_t size = lac_problem_unknowns(problem) * sizeof *y;
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < size; i++) {
        sum = (sum ^ bytes[i]) * UINT64_C(0x100000001b3);
    }
    return sum;
}

// Sum of the start; 0 where memory is short, which is no sum of anything.
static uint64_t identify(const lac_problem *problem)
{
    double *y = calloc(lac_problem_unknowns(problem), sizeof *y);
    if (y == NULL) {
        return 0;
    }
    lac_problem_initial(problem, y);
    uint64_t sum = sum_start(problem, y);
    free(y);
    return sum | 1;
}

static void pass_instant(lac_tape *tape, lac_instant *instant)
{
    PASS(tape, instant->set);
    PASS(tape, instant->origin);
    PASS(tape, instant->local);
}

static void pass_clock(lac_tape *tape, lac_clock *clock)
{
    PASS(tape, clock->count);
    PASS(tape, clock->steps);
    PASS(tape, clock->last_log_rate);
}

static void pass_counts(lac_tape *tape, lac_run_result *counts)
{
    PASS(tape, counts->steps);
    PASS(tape, counts->rhs_evaluations);
    PASS(tape, counts->newton_iterations);
    PASS(tape, counts->linear_solves);
    PASS(tape, counts->error_test_fails);
    PASS(tape, counts->nonlinear_fails);
    PASS(tape, counts->restarts);
}

static void pass_engine(lac_tape *tape, lac_engine *engine)
{
    PASS(tape, engine->origin);
    PASS(tape, engine->base);
    PASS(tape, engine->t);
    PASS(tape, engine->limit);
    PASS(tape, engine->step);
    PASS(tape, engine->order);
    PASS(tape, engine->beginnings);
    pass_counts(tape, &engine->counts);
    lac_tape_pass(tape, engine->y, engine->unknowns * sizeof *engine->y);
    lac_tape_pass(tape, engine->slip, engine->n * sizeof *engine->slip);
}

// Everything in one order, both ways.
static void pass_course(lac_tape *tape, lac_course *r)
{
    pass_engine(tape, r->engine);
    pass_clock(tape, &r->record_clock);
    pass_clock(tape, &r->snapshot_clock);
    pass_clock(tape, &r->checkpoint_clock);
    pass_instant(tape, &r->last_record);
    pass_instant(tape, &r->last_snapshot);
    pass_instant(tape, &r->looked);
    PASS(tape, r->next_break);
    PASS(tape, r->mean_rate);
    PASS(tape, r->max_rate);
    PASS(tape, r->first_step);
    PASS(tape, r->steps);
    PASS(tape, r->result->restarts);
    PASS(tape, r->result->max_slip_rate);
    PASS(tape, r->result->balance_residual);
    PASS(tape, r->result->rate_drift);
    if (r->sink != NULL && r->sink->keep != NULL) {
        r->sink->keep(r->sink->context, tape);
    }
}

static void pass_identity(lac_tape *tape, uint64_t *n, uint64_t *formulation, uint64_t *start)
{
    PASS(tape, *n);
    PASS(tape, *formulation);
    PASS(tape, *start);
}

lac_status lac_course_checkpoint(lac_course *r, bool planned, lac_error *err)
{
    lac_tape tape = {.loading = false};
    uint64_t n = r->engine->n;
    uint64_t formulation = (uint64_t)lac_problem_formulation(r->problem);
    uint64_t start = identify(r->problem);
    if (r->sink == NULL || r->sink->checkpoint == NULL) {
        return LAC_OK;
    }
    pass_identity(&tape, &n, &formulation, &start);
    pass_course(&tape, r);
    lac_status status = LAC_OK;
    if (start == 0 || tape.no_memory) {
        status = lac_fail_memory(err);
    } else if (tape.refused != NULL && planned) {
        status = lac_fail(err, LAC_EINPUT,
                          "the analysis %s cannot be kept in a checkpoint: leave it or "
                          "output.checkpoint out",
                          tape.refused);
    } else if (tape.refused == NULL) {
        lac_checkpoint checkpoint = {.planned = planned,
                                     .time = lac_engine_time(r->engine),
                                     .size = tape.size,
                                     .state = tape.bytes};
        status = r->sink->checkpoint(r->sink->context, &checkpoint, err);
    }
    free(tape.bytes);
    return status;
}

static lac_status check_identity(const lac_course *r, lac_tape *tape, lac_error *err)
{
    uint64_t n = 0;
    uint64_t formulation = 0;
    uint64_t start = 0;
    uint64_t now = identify(r->problem);
    if (now == 0) {
        return lac_fail_memory(err);
    }
    pass_identity(tape, &n, &formulation, &start);
    if (!lac_tape_good(tape) || n != r->engine->n ||
        formulation != (uint64_t)lac_problem_formulation(r->problem) || start != now) {
        return lac_fail(err, LAC_EINPUT,
                        "the checkpoint is of another scene: its cells or what they start from "
                        "have changed, perhaps a file that the case reads");
    }
    return LAC_OK;
}

lac_status lac_course_resume(lac_course *r, lac_error *err)
{
    const lac_checkpoint *from = r->def->resume;
    lac_tape tape = {.loading = true, .size = from->size};
    lac_status status = LAC_OK;
    tape.bytes = (unsigned char *)from->state; // only read
    r->record_clock.every = r->def->record;
    r->snapshot_clock.every = r->def->snapshot;
    r->checkpoint_clock.every = r->def->checkpoint;
    LAC_TRY(check_identity(r, &tape, err));
    pass_course(&tape, r);
    if (tape.no_memory) {
        return lac_fail_memory(err);
    }
    if (!lac_tape_good(&tape) || tape.at != tape.size) {
        return lac_fail(err, LAC_EINPUT, "the checkpoint does not fit this case and program");
    }
    if (!(lac_engine_time(r->engine) < r->def->end)) {
        return lac_fail(err, LAC_EINPUT,
                        "the checkpoint is at t = %.9g s, not before the end of the run, %.9g s",
                        lac_engine_time(r->engine), r->def->end);
    }
    r->engine->before = r->engine->counts;
out:
    return status;
}
