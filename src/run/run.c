// SPDX-License-Identifier: GPL-3.0-or-later
// The course of a run: steps, outputs, breaks of the loads, checkpoints, and why it ends.
#include "run/run.h"

#include "run/run_state.h"

typedef lac_run_state run;

static bool interrupted(const run *r)
{
    const bool here = r->def->interrupted != NULL && r->def->interrupted(r->def->context);
    return lac_team_any(r->engine->range->team, here);
}

static void measure_speed(run *r)
{
    lac_engine *engine = r->engine;
    lac_problem_speed(r->problem, lac_engine_clock(engine, engine->t), engine->y, engine->found,
                      &r->mean_rate, &r->max_rate, engine->work);
    engine->found = false;
    r->measured = true;
}

// Ends the run at a time within the step, whose state is in `between`.
static void stop_at(run *r, double t)
{
    lac_engine *engine = r->engine;
    engine->step -= engine->t - t;
    engine->t = t;
    memcpy(engine->y, r->between, engine->unknowns * sizeof *engine->y);
    memcpy(engine->slip, r->between + engine->unknowns, engine->n * sizeof *engine->slip);
    measure_speed(r);
    r->end = LAC_END_INTERRUPT;
    r->done = true;
}

// Records and snapshots that are due at exact times within the step just made. An interrupt ends
// the run in the midst of them, at the next one.
static lac_status output_between(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    double now = lac_engine_time(engine);
    for (;;) {
        double next_record = lac_clock_next(&r->record_clock);
        double next_snapshot = r->fields == NULL ? INFINITY : lac_clock_next(&r->snapshot_clock);
        double next = fmin(next_record, next_snapshot);
        if (!(next <= now)) {
            return LAC_OK;
        }
        double t = fmin(lac_engine_inner(engine, next), engine->t);
        const double *slip = lac_engine_slip_in(engine, r->between);
        r->measured = false;
        LAC_FAIL_IF(!lac_engine_at(engine, t, r->between), err, LAC_ENUMERIC,
                    "no state at t = %.17g s", next);
        bool stops = interrupted(r);
        if (stops && (!r->done || r->end == LAC_END_INTERRUPT)) {
            stop_at(r, t);
            now = next; // what else is due then
        } else if (stops && next < now) {
            return LAC_OK;
        }
        if (next_record == next) {
            r->record_clock.count++;
            LAC_TRY_RETURN(lac_run_state_record(r, t, r->between, slip, err));
        }
        if (next_snapshot == next) {
            r->snapshot_clock.count++;
            LAC_TRY_RETURN(lac_run_state_snapshot(r, t, r->between, slip, err));
        }
    }
    return LAC_OK;
}

// What is due at the end of the step; everything at the end of the run.
static lac_status output_step(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    if (lac_clock_due(&r->record_clock, r->mean_rate) || r->done) {
        LAC_TRY_RETURN(lac_run_state_record(r, engine->t, engine->y, engine->slip, err));
    }
    if (r->fields != NULL && (lac_clock_due(&r->snapshot_clock, r->mean_rate) || r->done)) {
        LAC_TRY_RETURN(lac_run_state_snapshot(r, engine->t, engine->y, engine->slip, err));
    }
    return LAC_OK;
}

// Begins the integrator's time anew: origin + base is the time reached, to the digits of base.
static void move_origin(lac_engine *engine)
{
    double local = engine->base + engine->t;
    double origin = engine->origin + local;
    engine->base = local - (origin - engine->origin);
    engine->origin = origin;
    engine->t = 0.0;
}

static lac_status restart(run *r, double h, lac_error *err)
{
    r->result->restarts++;
    r->first_step = h;
    return lac_engine_restart(r->engine, h, err);
}

// Beyond numbers no result is one. The rates are not kept: they are measured again where they are.
static lac_status check_rates(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    double t = lac_engine_time(engine);
    lac_status status = lac_check_rates(r->problem, r->max_rate, t, engine->work, err);
    if (status != LAC_OK) {
        measure_speed(r);
        status = lac_check_rates(r->problem, r->max_rate, t, engine->work, err);
    }
    return status;
}

static double own_step(lac_engine *engine)
{
    return lac_problem_first_step(engine->problem, lac_engine_clock(engine, engine->t), engine->y,
                                  engine->work);
}

// Takes the state across a jump or bend of the loads. A jump can be the failure itself.
static lac_status cross_break(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    double t = r->next_break;
    r->broken = true;
    engine->origin = t;
    engine->base = 0.0;
    engine->t = 0.0;
    r->next_break = lac_problem_next_break(r->problem, t);
    engine->limit = nextafter(r->next_break, -INFINITY);
    LAC_TRY_RETURN(lac_problem_lifted(r->problem, t, engine->y, 0.0, engine->work, err));
    LAC_FAIL_IF(!lac_problem_jump(r->problem, t, engine->y, engine->work), err, LAC_ENUMERIC,
                "no slip rate and state balance the load that jumps at t = %g s", t);
    measure_speed(r);
    bool failed =
        lac_problem_past_failure(r->problem, &engine->failure, t, engine->y, engine->work) >= 0.0;
    if (failed || lac_run_state_stops(r, t)) {
        r->done = true;
        r->end = failed ? LAC_END_FAILURE : LAC_END_STOP;
    }
    return LAC_OK;
}

static lac_status look_for_end(run *r, const double speed[2], lac_error *err)
{
    lac_engine *engine = r->engine;
    lac_crossing_kind crossing;
    LAC_TRY_RETURN(lac_crossing_find(engine, r->def, speed, &crossing, err));
    if (crossing != LAC_CROSSING_NONE) {
        measure_speed(r);
        r->done = true;
        r->end = lac_crossing_end(crossing);
    } else if (engine->t >= lac_engine_inner(engine, r->def->end)) {
        r->done = true;
        r->end = LAC_END_TIME;
    } else if (interrupted(r)) {
        r->done = true;
        r->end = LAC_END_INTERRUPT;
    }
    return LAC_OK;
}

// What stability asks an explicit method of fifth order for, in the step just made; in scratch of
// its own, so that looking leaves nothing behind. A look costs as much as a step: of a long run
// every fourth step is looked at, for those before it too.
static lac_status count_stiff_steps(run *r, lac_error *err)
{
    enum { ALL_OF = 128, EVERY = 4 };
    const double stable = 3.3; // times the inverse of the fastest decay
    lac_engine *engine = r->engine;
    double *all = &r->result->stiff_steps;
    r->unseen += engine->step;
    if (r->steps > ALL_OF && r->steps % EVERY != 0) {
        return LAC_OK;
    }
    *all +=
        r->unseen / stable *
        lac_problem_fastest(r->problem, lac_engine_clock(engine, engine->t), engine->y, r->aside);
    r->unseen = 0.0;
    const double made = (double)(r->steps + 1);
    const bool stiff = fmin(*all, made) > r->def->most_stiff && *all > 0.5 * made;
    return stiff ? lac_fail(err, LAC_ENUMERIC, "stability asks for more than %g explicit steps",
                            r->def->most_stiff)
                 : LAC_OK;
}

// One step, cut short where the run ends within it.
static lac_status step(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    double stop = fmin(fmin(r->def->end, r->next_break), lac_run_state_sweep_end(r));
    r->measured = false;
    LAC_TRY_RETURN(lac_engine_advance(engine, lac_engine_inner(engine, stop), err));
    if (r->aside != NULL) {
        LAC_TRY_RETURN(count_stiff_steps(r, err));
    }
    measure_speed(r);
    const double speed[2] = {r->mean_rate, r->max_rate};
    r->max_rate = fmax(r->max_rate, engine->peak);
    LAC_TRY_RETURN(lac_check_slipping(r->problem, engine->y, lac_engine_clock(engine, engine->t),
                                      engine->work, err));
    LAC_TRY_RETURN(look_for_end(r, speed, err));
    if (!engine->kind->sweeps) {
        LAC_TRY_RETURN(lac_run_state_watch(r, engine->step, err));
    }
    if (r->between != NULL) {
        LAC_TRY_RETURN(output_between(r, err));
    }
    // What is put out at a break is what holds from then on.
    bool goes_on = !r->done || r->end == LAC_END_INTERRUPT;
    if (goes_on && engine->t >= lac_engine_inner(engine, r->next_break)) {
        LAC_TRY_RETURN(cross_break(r, err));
        LAC_TRY_RETURN(lac_run_state_watch(r, 0.0, err));
    }
    LAC_TRY_RETURN(check_rates(r, err));
    r->result->max_slip_rate = fmax(r->result->max_slip_rate, r->max_rate);
    return output_step(r, err);
}

// Begins anew at the time reached, from nothing but what a checkpoint holds.
static lac_status begin_anew(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    double own = own_step(engine);
    if (r->broken) {
        engine->beginnings += engine->turn == LAC_TURN_OWN ? 1 : 0;
        r->broken = false;
        return restart(r, own, err);
    }
    move_origin(engine);
    return restart(r, fmax(own, 0.1 * engine->step), err);
}

// After a step: beyond a break of the loads, at a checkpoint, or with a new origin where time runs
// out of digits.
static lac_status go_on(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    const double digits = 1e-9; // a step has at least 16 - 9 of the 16 digits of a double
    if (lac_run_state_checkpoint_due(r)) {
        LAC_TRY_RETURN(begin_anew(r, err));
        return lac_run_state_checkpoint(r, true, err);
    }
    if (r->broken) {
        return begin_anew(r, err);
    }
    if (!engine->kind->sweeps && engine->step < digits * engine->t) {
        move_origin(engine);
        return restart(r, 0.1 * engine->step, err);
    }
    return LAC_OK;
}

static void report_progress(const run *r)
{
    if (r->def->progress == NULL) {
        return;
    }
    lac_progress progress = {.time = lac_engine_time(r->engine),
                             .end = r->def->end,
                             .mean_rate = r->mean_rate,
                             .failure_rate = r->engine->failure.rate,
                             .steps = r->engine->counts.steps};
    r->def->progress(r->def->context, &progress);
}

static lac_status integrate(run *r, lac_error *err)
{
    while (!r->done) {
        LAC_TRY_RETURN(lac_run_state_check(r, err));
        LAC_TRY_RETURN(step(r, err));
        report_progress(r);
        r->steps++;
        if (!r->done) {
            LAC_TRY_RETURN(go_on(r, err));
        }
    }
    return LAC_OK;
}

// A run that plans checkpoints has one to go back to, exactly; else one is made here.
static lac_status interrupt(run *r, lac_error *err)
{
    double time = lac_engine_time(r->engine);
    if (!lac_run_state_plans(r->def)) {
        LAC_TRY_RETURN(begin_anew(r, err));
        LAC_TRY_RETURN(lac_run_state_checkpoint(r, false, err));
    }
    return lac_fail(err, LAC_EINTERRUPT, "interrupted at t = %g s", time);
}

// What the sink takes, whoever has it.
static void ask_sink(run *r)
{
    const lac_sink *sink = r->sink;
    const lac_team *team = r->engine->range->team;
    if (sink != NULL) {
        r->takes = (sink->record != NULL ? LAC_TAKES_RECORD : 0U) |
                   (sink->snapshot != NULL ? LAC_TAKES_SNAPSHOT : 0U) |
                   (sink->step != NULL ? LAC_TAKES_STEP : 0U) |
                   (sink->checkpoint != NULL ? LAC_TAKES_CHECKPOINT : 0U);
        r->cells_from = sink->cells_from;
    }
    r->stepped = true; // none or the last one before a kill may have
    lac_team_follow(team, &r->takes);
    lac_team_follow(team, &r->cells_from);
}

static lac_status allocate_output(run *r, lac_error *err)
{
    const bool by_time = !isnan(r->def->record.time) || !isnan(r->def->snapshot.time);
    const bool weakens = lac_problem_weakening(r->problem) != NULL;
    const size_t cells = r->engine->n * sizeof(double);
    const size_t bytes = r->engine->unknowns * sizeof(double) + cells;
    const bool vector = lac_problem_is_vector(r->problem);
    const size_t fields = (r->def->cell_safety ? 5U : 4U) + (weakens ? 3U : 0U) +
                          (vector ? (size_t)LAC_POINT_ALONG : 0U);
    r->between = by_time ? malloc(bytes) : NULL;
    r->fields = r->def->snapshots ? malloc(fields * cells) : NULL;
    // Where slip is the unknown the balance holds as it is.
    bool drifts = r->def->projection != 0 && !lac_problem_has_slip(r->problem);
    r->onto = drifts ? malloc(bytes) : NULL;
    const lac_points *points = r->def->points;
    const size_t values = LAC_POINT_VALUES + LAC_POINT_ALONG;
    const size_t watched = points != NULL ? values * points->n + r->engine->n : 0;
    r->watched = watched > 0 ? malloc(watched * sizeof *r->watched) : NULL;
    const bool aside = r->def->most_stiff > 0.0;
    r->aside = aside ? calloc(lac_problem_work(r->problem), sizeof *r->aside) : NULL;
    const lac_range *range = r->engine->range;
    const bool gathers = range->team != NULL && lac_run_state_leads(r);
    r->all = gathers ? malloc(LAC_GATHERED * range->all * sizeof *r->all) : NULL;
    LAC_FAIL_MEMORY_IF((by_time && r->between == NULL) || (gathers && r->all == NULL) ||
                           (aside && r->aside == NULL) ||
                           (r->def->snapshots && r->fields == NULL) ||
                           (drifts && r->onto == NULL) || (watched > 0 && r->watched == NULL),
                       err);
    return LAC_OK;
}

// The first step from where the run begins.
static double begin_step(const run *r)
{
    const lac_run_def *def = r->def;
    const double t = lac_engine_time(r->engine);
    // A first step longer than an e-fold of the fastest cell could leap over its failure.
    double h = own_step(r->engine);
    h = isnan(def->first_step) ? h : fmin(def->first_step, 1e3 * h);
    h = fmin(h, 0.5 * fmin(def->end - t, r->next_break - t));
    return def->start != NULL && def->start->same ? def->start->first_step : h;
}

// Everything at the start: first record, first step, clocks.
static lac_status begin(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    const lac_run_def *def = r->def;
    if (def->start != NULL) {
        LAC_TRY_RETURN(lac_run_state_start(r, err));
    }
    const double t = lac_engine_time(engine);
    measure_speed(r);
    const lac_start_state at = {t, engine->y, engine->slip};
    LAC_TRY_RETURN(lac_check_start(r->problem, def, &engine->failure, &at, engine->work, err));
    r->result->max_slip_rate = r->max_rate;
    r->record_clock = lac_clock_start(def->record, r->mean_rate);
    r->snapshot_clock = lac_clock_start(def->snapshot, r->mean_rate);
    LAC_TRY_RETURN(lac_run_state_watch(r, 0.0, err));
    r->checkpoint_clock = lac_clock_start(def->checkpoint, r->mean_rate);
    lac_run_state_start_clocks(r);
    LAC_TRY_RETURN(lac_run_state_record(r, 0.0, engine->y, engine->slip, err));
    if (r->fields != NULL) {
        LAC_TRY_RETURN(lac_run_state_snapshot(r, 0.0, engine->y, engine->slip, err));
    }
    r->next_break = lac_problem_next_break(r->problem, t);
    engine->limit = nextafter(r->next_break, -INFINITY);
    r->first_step = begin_step(r);
    LAC_TRY_RETURN(lac_engine_restart(engine, r->first_step, err));
    if (lac_run_state_plans(def)) {
        LAC_TRY_RETURN(lac_run_state_checkpoint(r, true, err));
    }
    return LAC_OK;
}

// Takes up a run where its checkpoint left it. Times that a forced one already put out are over.
static lac_status take_up(run *r, lac_error *err)
{
    lac_run_clock *clocks[] = {&r->record_clock, &r->snapshot_clock};
    LAC_TRY_RETURN(lac_run_state_resume(r, err));
    r->done = !(lac_engine_time(r->engine) < r->def->end); // there already
    for (size_t i = 0; i < 2; i++) {
        while (lac_clock_next(clocks[i]) <= lac_engine_time(r->engine)) {
            clocks[i]->count++;
        }
    }
    return lac_engine_restart(r->engine, r->first_step, err);
}

// Where the run came to, the loads that jump there behind it.
static lac_status hand_over(run *r, lac_error *err)
{
    lac_engine *engine = r->engine;
    if (engine->t >= lac_engine_inner(engine, r->next_break)) {
        LAC_TRY_RETURN(cross_break(r, err));
    }
    if (r->steps > 0 && r->end == LAC_END_TIME) {
        r->first_step = fmax(own_step(engine), r->broken ? 0.0 : 0.1 * engine->step);
        move_origin(engine);
    }
    return r->end == LAC_END_TIME ? lac_run_state_reach(r, err) : LAC_OK;
}

// A balance that is off by all that friction holds: what was put out is no motion of the joint.
static lac_status check_balance(const run *r, lac_error *err)
{
    const double off = r->result->balance_residual;
    LAC_FAIL_IF(!(off <= 1.0), err, LAC_ENUMERIC,
                "the traction balance is off by %.2g of the strength at worst, up to t = %g s: the "
                "numbers of this run mean nothing; tighten solver.rtol, or see solver.projection",
                off, lac_engine_time(r->engine));
    return LAC_OK;
}

static void finish(run *r, lac_status status)
{
    lac_run_result *result = r->result;
    lac_engine *engine = r->engine;
    lac_engine_count(engine);
    lac_run_result counts = engine->counts;
    result->steps = counts.steps;
    result->rhs_evaluations = counts.rhs_evaluations;
    result->newton_iterations = counts.newton_iterations;
    result->linear_solves = counts.linear_solves;
    result->error_test_fails = counts.error_test_fails;
    result->nonlinear_fails = counts.nonlinear_fails;
    result->restarts += counts.restarts;
    result->time = lac_engine_time(engine);
    result->end = status == LAC_OK || status == LAC_EINTERRUPT ? r->end : LAC_END_ERROR;
    result->mean_slip = lac_engine_mean_slip(engine, engine->slip);
    if (result->end == LAC_END_FAILURE || result->end == LAC_END_SLIP) {
        result->failed = true;
        result->failure_origin = engine->origin;
        result->failure_local = engine->base + engine->t;
    }
    lac_run_state_keep_peak(r);
}

lac_status lac_run(const lac_problem *problem, const lac_run_def *def, const lac_sink *sink,
                   lac_run_result *result, lac_error *err)
{
    lac_status status = LAC_OK;
    *result = (lac_run_result){.end = LAC_END_ERROR,
                               .failure_origin = NAN,
                               .failure_local = NAN,
                               .safety = {NAN, NAN, NAN, NAN, NAN},
                               .arrest = {false, NAN, NAN, NAN}};
    run r = {.problem = problem,
             .def = def,
             .sink = sink,
             .result = result,
             .bends = lac_problem_bends(problem)};
    LAC_TRY(lac_check_def(def, err));
    result->failure = lac_problem_failure(problem, def->failure_rate, def->failure_slip);
    LAC_TRY(lac_engine_create(problem, def, &r.engine, err));
    r.engine->failure = result->failure;
    r.engine->sink = sink;
    ask_sink(&r);
    LAC_TRY(lac_run_state_agree(&r, allocate_output(&r, err), err));
    LAC_TRY(def->resume != NULL ? take_up(&r, err) : begin(&r, err));
    LAC_TRY(integrate(&r, err));
    if (r.end == LAC_END_INTERRUPT) {
        LAC_TRY(interrupt(&r, err));
    }
    if (def->reached != NULL && r.end == LAC_END_TIME) {
        LAC_TRY(hand_over(&r, err));
    }
    LAC_TRY(check_balance(&r, err));
out:
    if (r.engine != NULL) {
        finish(&r, status);
    }
    free(r.all);
    free(r.between);
    free(r.fields);
    free(r.onto);
    free(r.watched);
    free(r.aside);
    lac_engine_free(r.engine);
    return status;
}
