// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that begin in the midst of time, and what they begin from: where another run came to, or
// what a snapshot of one tells; docs/theory/restart.md.
#include "run/run_state.h"

void lac_run_start_clear(lac_run_start *start)
{
    lac_problem_state_clear(&start->state);
    free(start->y);
    *start = (lac_run_start){0};
}

lac_status lac_run_start_take(const lac_run_start *start, const lac_problem *problem, double *y,
                              double *slip, lac_error *err)
{
    const size_t n = lac_problem_cells(problem);
    if (!start->same || start->y == NULL ||
        start->formulation != lac_problem_formulation(problem)) {
        return lac_problem_take(problem, start->origin + start->base, &start->state, y, slip, err);
    }
    memcpy(y, start->y, lac_problem_unknowns(problem) * sizeof *y);
    if (!lac_problem_has_slip(problem)) {
        memcpy(slip, start->slip, n * sizeof *slip);
    }
    return LAC_OK;
}

lac_status lac_run_state_start(lac_run_state *r, lac_error *err)
{
    const lac_run_start *start = r->def->start;
    lac_engine *engine = r->engine;
    engine->origin = start->origin;
    engine->base = start->base;
    engine->beginnings = start->same ? start->beginnings : 0;
    const double t = lac_engine_time(engine);
    LAC_FAIL_IF(!(t < r->def->end), err, LAC_EINPUT,
                "the run would begin at t = %.9g s, not before its end, %.9g s", t, r->def->end);
    engine->limit = nextafter(lac_problem_next_break(r->problem, t), -INFINITY);
    return lac_run_start_take(start, r->problem, engine->y, engine->slip, err);
}

// Whether numbers are the same, not given being one too.
static bool alike(double a, double b) { return a == b || (isnan(a) && isnan(b)); }

static bool same_cadence(const lac_cadence *a, const lac_cadence *b)
{
    return alike(a->time, b->time) && a->steps == b->steps && alike(a->per_decade, b->per_decade);
}

void lac_run_state_start_clocks(lac_run_state *r)
{
    const lac_run_start *start = r->def->start;
    lac_run_clock *clocks[] = {&r->record_clock, &r->snapshot_clock, &r->checkpoint_clock};
    for (size_t i = 0; start != NULL && i < 3; i++) {
        lac_run_clock *clock = clocks[i];
        const double now = lac_engine_time(r->engine);
        if (start->same && same_cadence(&clock->every, &start->clock[i].every)) {
            *clock = start->clock[i];
        } else if (!isnan(clock->every.time)) {
            clock->count = (int64_t)floor(now / clock->every.time);
        }
        while (lac_clock_next(clock) <= now) {
            clock->count++;
        }
    }
}

lac_status lac_run_state_reach(lac_run_state *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    lac_run_start *out = r->def->reached;
    const size_t unknowns = engine->unknowns, n = engine->n;
    *out = (lac_run_start){.origin = engine->origin,
                           .base = engine->base,
                           .formulation = lac_problem_formulation(r->problem),
                           .first_step = r->first_step,
                           .beginnings = engine->beginnings,
                           .clock = {r->record_clock, r->snapshot_clock, r->checkpoint_clock}};
    LAC_TRY_RETURN(lac_problem_state_create(r->problem, &out->state, err));
    out->y = malloc((unknowns + n) * sizeof *out->y);
    LAC_FAIL_MEMORY_IF(out->y == NULL, err);
    out->slip = out->y + unknowns;
    memcpy(out->y, engine->y, unknowns * sizeof *out->y);
    memcpy(out->slip, engine->slip, n * sizeof *out->slip);
    lac_problem_give(r->problem, lac_engine_time(engine), engine->y, engine->slip, &out->state,
                     engine->work);
    return LAC_OK;
}
