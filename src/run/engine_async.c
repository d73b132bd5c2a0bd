// SPDX-License-Identifier: GPL-3.0-or-later
// Fidelity `events`: every cell at steps of its own. A step of this engine is a sweep of some
// updates for every cell, or up to a limit of the run; docs/theory/fidelity-events.md.
#include "async/async.h"
#include "run/engine.h"

enum { UPDATES_A_CELL = 4, FEWEST_UPDATES = 64, ORDER = 2 };

typedef struct cells {
    lac_async *micro;
    double *y;           // [3n] state and slip
    double *rate, *slip; // [n] of every cell at its last update; NULL: nobody looks
    bool too_early;      // the last sweep ended at a limit that it had not reached
    double ask;          // then: mean rate that cells tell at which it may have [m/s]
    double lack;         // what the state had slipped less than told, at the limit of slip [m]
    int64_t looks;       // at all cells
} cells;

static void cells_free(lac_engine *engine)
{
    cells *c = engine->inner;
    if (c != NULL) {
        lac_async_free(c->micro);
        free(c->y);
        free(c->rate);
        free(c);
    }
    engine->inner = NULL;
}

// What each cell may err by, in ln v, over one of its steps.
static double tolerance_of(const lac_run_def *def) { return 10.0 * sqrt(def->rtol); }

lac_status lac_run_async_follows(const lac_async_scene *scene, lac_error *err)
{
    LAC_FAIL_IF(scene->transfer->blocks == NULL, err, LAC_EINPUT,
                "solver.fidelity events goes with transfer hierarchy, not with %s",
                scene->transfer->info.name);
    LAC_FAIL_IF(!scene->linear, err, LAC_EINPUT,
                "solver.fidelity events follows loads that are linear in time between jumps and "
                "bends: ratio, slope, ramp, step, spring, constant, field, water_table");
    LAC_FAIL_IF(scene->formulation != LAC_FORMULATION_RATE, err, LAC_EINPUT,
                "solver.fidelity events needs formulation rate");
    return lac_async_follows(scene->law, scene->cut_off, err);
}

lac_status lac_engine_events_check(const lac_problem *problem, lac_error *err)
{
    const lac_problem_parts parts = lac_problem_parts_of(problem);
    const lac_async_scene scene = {.transfer = parts.transfer->kind,
                                   .law = &parts.friction->law->info,
                                   .linear = parts.linear,
                                   .formulation = lac_problem_formulation(problem)};
    LAC_FAIL_IF(lac_problem_weakening(problem) != NULL, err, LAC_EINPUT,
                "solver.fidelity events knows no weakening: leave one of them out");
    LAC_TRY_RETURN(lac_run_async_follows(&scene, err));
    return lac_async_supports(parts.friction, err);
}

static lac_status make(lac_engine *engine, cells *c, lac_error *err)
{
    const lac_problem_parts parts = lac_problem_parts_of(engine->problem);
    lac_status status = LAC_OK;
    double *k = NULL;
    LAC_TRY(lac_engine_events_check(engine->problem, err));
    const lac_transfer *transfer = parts.transfer;
    const lac_hierarchy *h = transfer->kind->blocks(transfer->state);
    size_t levels = lac_hierarchy_levels(h);
    k = calloc(levels + 1, sizeof *k);
    c->y = calloc(3 * engine->n, sizeof *c->y);
    LAC_TRY(k != NULL && c->y != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t l = 0; l < levels; l++) {
        k[l] = transfer->kind->stiffness(transfer->state, l);
    }
    const lac_async_def def = {.hierarchy = h,
                               .k = k,
                               .friction = parts.friction,
                               .pressure = parts.pressure,
                               .damping = parts.damping.cell,
                               .drag = parts.damping.shared,
                               .tolerance = tolerance_of(engine->def)};
    LAC_TRY(lac_async_create(&def, &c->micro, err));
    engine->y = c->y;
    engine->slip = c->y + 2 * engine->n;
    lac_problem_initial(engine->problem, engine->y);
out:
    free(k);
    return status;
}

static lac_status cells_create(lac_engine *engine, lac_error *err)
{
    cells *c = calloc(1, sizeof *c);
    LAC_FAIL_MEMORY_IF(c == NULL, err);
    engine->inner = c;
    return make(engine, c, err);
}

static lac_async_state state_of(lac_engine *engine)
{
    return (lac_async_state){engine->y, engine->y + engine->n, engine->slip};
}

static void cells_count(lac_engine *engine)
{
    const cells *c = engine->inner;
    lac_async_counts counts = lac_async_count(c->micro);
    const lac_run_result *before = &engine->before;
    engine->counts.steps = before->steps + counts.updates;
    // What was evaluated cell by cell, in evaluations of all.
    int64_t n = (int64_t)engine->n;
    engine->counts.rhs_evaluations =
        before->rhs_evaluations + c->looks + (counts.steps + n - 1) / n;
    engine->counts.error_test_fails = before->error_test_fails + counts.steps - counts.updates;
    engine->order = ORDER;
}

static lac_status cells_restart(lac_engine *engine, double h, lac_error *err)
{
    (void)h;
    cells *c = engine->inner;
    lac_problem_loads_at now;
    const double clock = lac_engine_clock(engine, engine->t);
    // A cell that a jump has let go would not be looked at for years.
    LAC_TRY_RETURN(lac_check_slipping(engine->problem, engine->y,
                                      lac_engine_clock(engine, engine->t), engine->work, err));
    LAC_TRY_RETURN(lac_problem_lifted(engine->problem, clock, engine->y, 0.0, engine->work, err));
    (void)lac_problem_drive(engine->problem, clock, engine->y, engine->work, &now);
    if (engine->sink != NULL && engine->sink->step != NULL && c->rate == NULL) {
        c->rate = calloc(2 * engine->n, sizeof *c->rate);
        LAC_FAIL_MEMORY_IF(c->rate == NULL, err);
        c->slip = c->rate + engine->n;
    }
    const lac_async_load load = {.ratio = now.ratio,
                                 .ratio_rate = now.ratio_rate,
                                 .common = now.spring,
                                 .common_rate = now.spring_rate,
                                 .share = now.share,
                                 .share_rate = now.share_rate,
                                 .shares = now.shares,
                                 .share_rates = now.share_rates,
                                 .k_mean = now.spring_stiffness};
    const lac_problem_parts parts = lac_problem_parts_of(engine->problem);
    const lac_async_state state = state_of(engine);
    cells_count(engine);
    engine->before = engine->counts;
    c->looks = 0;
    c->too_early = false;
    c->lack = 0.0;
    lac_async_start(c->micro, &load, parts.traction, &state);
    return LAC_OK;
}

// Hands an update to the sink as a step of one cell.
static lac_status tell(void *context, const lac_async_update *update, lac_error *err)
{
    lac_engine *engine = context;
    cells *c = engine->inner;
    c->rate[update->cell] = update->rate;
    c->slip[update->cell] = update->slip;
    const lac_step step = {.time_origin = engine->origin,
                           .time_local = engine->base + update->t,
                           .step = update->step,
                           .max_rate = update->rate,
                           .n = engine->n,
                           .slip_rate = c->rate,
                           .slip = c->slip,
                           .changed = &update->cell,
                           .changes = 1};
    return engine->sink->step(engine->sink->context, &step, err);
}

// Moves the time reached into base and origin, to the digits of base.
static double move_origin(lac_engine *engine, double by)
{
    double local = engine->base + by;
    double origin = engine->origin + local;
    engine->base = local - (origin - engine->origin);
    engine->origin = origin;
    return by;
}

// The mean slip that ends the run; INFINITY: none.
static double slip_limit(const lac_engine *engine)
{
    return fmin(engine->def->stop_slip, engine->failure.slip);
}

static lac_async_limits limits_of(lac_engine *engine, double stop)
{
    const lac_run_def *def = engine->def;
    const cells *c = engine->inner;
    int64_t updates = UPDATES_A_CELL * (int64_t)engine->n;
    updates = updates > FEWEST_UPDATES ? updates : FEWEST_UPDATES;
    return (lac_async_limits){.stop = stop,
                              .mean_rate = c->too_early ? c->ask : engine->failure.rate,
                              .max_rate = isnan(def->stop_rate) ? INFINITY : def->stop_rate,
                              .mean_slip = slip_limit(engine) + c->lack,
                              .updates = c->too_early ? updates / UPDATES_A_CELL : updates,
                              .observation = c->rate != NULL ? tell : NULL,
                              .context = engine};
}

// What cells tell is linear within their steps; whether a limit is reached, the state says. Looks
// are dear: where cells slide on below it, the next one waits until they tell as much more.
static bool too_early(lac_engine *engine, const lac_async_limits *limits)
{
    cells *c = engine->inner;
    double mean, max;
    double t = lac_engine_clock(engine, engine->t);
    const double least = 0.1;
    double past =
        lac_problem_past_failure(engine->problem, &engine->failure, t, engine->y, engine->work);
    bool failed = past >= 0.0;
    lac_problem_speed(engine->problem, t, engine->y, false, &mean, &max, engine->work);
    c->ask = lac_async_told(c->micro) * exp(fmax(-past, least));
    double slip = lac_engine_mean_slip(engine, engine->slip);
    double most = slip_limit(engine);
    if (slip < most && isfinite(most) && !failed) {
        c->lack = fmax(limits->mean_slip - slip, 1e-12 * slip);
    }
    return !failed && max < limits->max_rate && !(slip >= most);
}

static lac_status cells_advance(lac_engine *engine, double stop, lac_error *err)
{
    cells *c = engine->inner;
    lac_async *micro = c->micro;
    double before = lac_async_time(micro);
    double passed = 0.0;
    if (lac_async_wants_shift(micro)) {
        double by = move_origin(engine, lac_async_shift(micro));
        passed += by;
        stop -= by;
    }
    const lac_async_limits limits = limits_of(engine, stop);
    const lac_async_state state = state_of(engine);
    lac_status status = lac_async_advance(micro, &limits, err);
    if (status == LAC_OK) {
        status = lac_async_evaluate(micro, &state, err);
    }
    if (status == LAC_ENUMERIC) {
        engine->t = lac_async_time(micro);
        LAC_TRY_RETURN(lac_engine_lifted(engine, err));
    }
    LAC_TRY_RETURN(status);
    engine->t = lac_async_time(micro);
    engine->step = engine->t + passed - before;
    engine->peak = lac_async_peak(micro);
    engine->order = ORDER;
    c->looks++;
    c->too_early = lac_async_at_limit(micro) && too_early(engine, &limits);
    return LAC_OK;
}

static bool cells_at(lac_engine *engine, double t, double *observation)
{
    size_t n = engine->n;
    (void)t;
    memcpy(observation, engine->y, 2 * n * sizeof *observation);
    memcpy(observation + 2 * n, engine->slip, n * sizeof *observation);
    return true;
}

const lac_engine_kind lac_engine_events = {.create = cells_create,
                                           .free = cells_free,
                                           .restart = cells_restart,
                                           .advance = cells_advance,
                                           .at = cells_at,
                                           .count = cells_count,
                                           .sweeps = true};
