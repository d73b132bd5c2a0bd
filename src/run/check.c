// SPDX-License-Identifier: GPL-3.0-or-later
// What is common to runs: settings where none are given, words, sinks that stand before another
// one; and refusals: settings, starts and rates that cannot be, slip that cannot be followed.
#include "run/engine.h"

lac_status lac_check_slipping(const lac_problem *problem, const double *y, double t, double *work,
                              lac_error *err)
{
    size_t cell;
    LAC_FAIL_IF(lac_problem_rests(problem, t, y, &cell, work) &&
                    !lac_problem_settles(problem, t, y, work),
                err, LAC_ENUMERIC,
                "cell %zu comes to rest at t = %.17g s: with so small a direct effect a its "
                "friction holds it only below %.2g m/s, beyond what is followed",
                cell, t, exp(LAC_AT_REST));
    if (lac_problem_slips(problem, t, y, &cell, work)) {
        return LAC_OK;
    }
    const char *lost =
        !lac_problem_has_slip(problem)
            ? NULL
            : lac_problem_lost_transfer(problem, y + lac_problem_slip_place(problem), work);
    LAC_FAIL_IF(lost != NULL, err, LAC_ENUMERIC,
                "the transfer %s finds no stress for the slip at t = %.17g s", lost, t);
    LAC_FAIL_IF(lac_problem_coheres(problem), err, LAC_ENUMERIC,
                "the shear traction of cell %zu falls to its cohesion at t = %.17g s: cohesion "
                "holds what slides forward only, and slip that stops or turns back is not followed",
                cell, t);
    lac_formulation formulation = lac_problem_formulation(problem);
    bool log_rate = formulation == LAC_FORMULATION_RATE;
    bool massive = formulation == LAC_FORMULATION_INERTIA;
    return lac_fail(err, LAC_ENUMERIC,
                    "the shear traction of cell %zu falls to nothing at t = %.17g s: what takes it "
                    "away or reverses it (a load, or damping of the mean where few cells slip "
                    "fast) %s; %sthe friction law's form regularised follows it",
                    cell, t,
                    log_rate ? "cannot be followed with ln v as unknown"
                             : "is beyond the plain form of friction, which is infinite at rest",
                    massive ? "" : "solver.formulation traction or slip with ");
}

lac_status lac_check_rates(const lac_problem *problem, double max, double t, const double *v,
                           lac_error *err)
{
    // where the rate is solved for, what is faster is held there: one bound for all formulations
    const double most = exp(LAC_FASTEST) * (1.0 - 1e-9);
    if (max <= most) {
        return LAC_OK;
    }
    const size_t n = lac_problem_cells(problem);
    size_t i = 0;
    while (i < n && fabs(v[i]) <= most) {
        i++;
    }
    size_t cell = lac_problem_first_cell(problem, i < n ? i : SIZE_MAX);
    cell = cell == SIZE_MAX ? lac_problem_range(problem)->all - 1 : cell;
    return lac_fail(err, LAC_ENUMERIC,
                    "the slip rate of cell %zu overflows at t = %.17g s: beyond %.3g m/s; "
                    "nothing but friction holds it back there (no radiation damping?)",
                    cell, t, most);
}

lac_status lac_check_def(const lac_run_def *def, lac_error *err)
{
    LAC_FAIL_IF(def->fidelity == LAC_FIDELITY_STATIC, err, LAC_EINPUT,
                "solver.fidelity static has no time to run through: lacuna rg works out the "
                "cascade; ode and events run");
    return LAC_OK;
}

// Slip of a start in the midst of time; NULL: none yet.
static const double *slip_of(const lac_problem *problem, const lac_start_state *at)
{
    return lac_problem_has_slip(problem) ? at->y + lac_problem_slip_place(problem) : at->slip;
}

static lac_status check_slip(const lac_problem *problem, const lac_run_def *def,
                             const lac_failure *failure, const lac_start_state *at, lac_error *err)
{
    const double *slip = slip_of(problem, at);
    const double gone = slip != NULL ? lac_problem_mean_slip(problem, slip) : 0.0;
    LAC_FAIL_IF(gone >= failure->slip, err, LAC_EINPUT,
                "the mean slip at the start, %g m, is not below that of failure, %g m", gone,
                failure->slip);
    LAC_FAIL_IF(gone >= def->stop_slip, err, LAC_EINPUT,
                "the mean slip at the start, %g m, is not below the one to stop at, %g m", gone,
                def->stop_slip);
    return LAC_OK;
}

// The slip at the start is 0, whatever the unknowns are, unless it is given.
static lac_status check_safety(const lac_problem *problem, const lac_run_def *def,
                               const lac_start_state *at, double *work, lac_error *err)
{
    const lac_safety asked = lac_problem_safety_asked(problem);
    if (isnan(def->stop_safety) && !(asked.reference_rate > 0.0)) {
        return LAC_OK;
    }
    LAC_FAIL_IF(!isnan(def->stop_safety) && def->fidelity == LAC_FIDELITY_ASYNC, err, LAC_EINPUT,
                "time.stop_when.factor_of_safety goes with solver.fidelity ode: with events the "
                "cells are together only at the ends of sweeps");
    double *none = calloc(lac_problem_cells(problem) + 1, sizeof *none);
    LAC_FAIL_MEMORY_IF(none == NULL, err);
    const double *slip = slip_of(problem, at) != NULL ? slip_of(problem, at) : none;
    const double safety = lac_problem_safety(problem, at->t, at->y, slip, work);
    free(none);
    LAC_FAIL_IF(safety <= 0.0, err, LAC_EINPUT,
                "the factor of safety at the start is %g: at so slow a reference rate the plain "
                "form of friction has no strength; "
                "output.factor_of_safety.reference_rate must be faster",
                safety);
    LAC_FAIL_IF(safety <= def->stop_safety, err, LAC_EINPUT,
                "the factor of safety at the start, %g, is not above the one to stop at, %g",
                safety, def->stop_safety);
    return LAC_OK;
}

lac_status lac_check_start(const lac_problem *problem, const lac_run_def *def,
                           const lac_failure *failure, const lac_start_state *at, double *work,
                           lac_error *err)
{
    double mean, max;
    lac_problem_speed(problem, at->t, at->y, false, &mean, &max, work);
    LAC_TRY_RETURN(lac_check_rates(problem, max, at->t, work, err));
    LAC_FAIL_IF(lac_problem_past_failure(problem, failure, at->t, at->y, work) >= 0.0, err,
                LAC_EINPUT,
                "the mean slip rate at the start, %g m/s, is not below that of failure, %g m/s",
                mean, failure->rate);
    LAC_FAIL_IF(
        max >= def->stop_rate, err, LAC_EINPUT,
        "the largest slip rate at the start, %g m/s, is not below the one to stop at, %g m/s", max,
        def->stop_rate);
    LAC_TRY_RETURN(check_slip(problem, def, failure, at, err));
    LAC_TRY_RETURN(check_safety(problem, def, at, work, err));
    return lac_check_slipping(problem, at->y, at->t, work, err);
}

lac_status lac_run_check(const lac_problem *problem, const lac_run_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    LAC_TRY_RETURN(lac_check_def(def, err));
    const size_t unknowns = lac_problem_unknowns(problem), n = lac_problem_cells(problem);
    double *y = calloc(unknowns + n + lac_problem_work(problem), sizeof *y);
    LAC_FAIL_MEMORY_IF(y == NULL, err);
    lac_start_state at = {0.0, y, y + unknowns};
    lac_problem_initial(problem, y);
    if (def->fidelity == LAC_FIDELITY_ASYNC) {
        LAC_TRY(lac_engine_events_check(problem, err));
    }
    if (def->start != NULL) {
        at.t = def->start->origin + def->start->base;
        LAC_TRY(lac_run_start_take(def->start, problem, y, y + unknowns, err));
    }
    const lac_failure failure = lac_problem_failure(problem, def->failure_rate, def->failure_slip);
    status = lac_check_start(problem, def, &failure, &at, y + unknowns + n, err);
out:
    free(y);
    return status;
}

lac_run_def lac_run_default(void)
{
    return (lac_run_def){.method = LAC_BDF,
                         .rtol = 1e-6,
                         .first_step = NAN,
                         .max_steps = 10000000,
                         .end = NAN,
                         .failure_rate = 1.0,
                         .failure_slip = INFINITY,
                         .stop_slip = NAN,
                         .stop_rate = NAN,
                         .stop_safety = NAN,
                         .record = {.time = NAN, .steps = 1, .per_decade = NAN},
                         .snapshot = {.time = NAN, .steps = 0, .per_decade = 1.0},
                         .checkpoint = {.time = NAN, .steps = 0, .per_decade = NAN}};
}

lac_formulation lac_formulation_choose(int asked, lac_method method, lac_friction_form form)
{
    if (asked != LAC_FORMULATION_AUTO) {
        return (lac_formulation)asked;
    }
    if (method == LAC_ADAMS) {
        return LAC_FORMULATION_SLIP;
    }
    bool forwards = form == LAC_FORM_PLAIN;
    return method == LAC_BDF && forwards ? LAC_FORMULATION_RATE : LAC_FORMULATION_TRACTION;
}

const char *lac_end_name(lac_end end)
{
    static const char *const names[] = {[LAC_END_TIME] = "end",
                                        [LAC_END_FAILURE] = "rate",
                                        [LAC_END_SLIP] = "slip",
                                        [LAC_END_STOP] = "stop_when",
                                        [LAC_END_INTERRUPT] = "interrupted",
                                        [LAC_END_ERROR] = "error",
                                        [LAC_END_REST] = "rest"};
    return (unsigned)end < sizeof names / sizeof *names ? names[end] : NULL;
}

const char *lac_fidelity_name(lac_fidelity fidelity)
{
    static const char *const names[] = {[LAC_FIDELITY_ODE] = "ode",
                                        [LAC_FIDELITY_ASYNC] = "events",
                                        [LAC_FIDELITY_STATIC] = "static",
                                        [LAC_FIDELITY_AUTO] = "auto",
                                        [LAC_FIDELITY_LUMPED] = "lumped"};
    return names[fidelity];
}

#define PASS(what, type)                                                    \
    static lac_status pass_##what(void *context, type what, lac_error *err) \
    {                                                                       \
        const lac_sink *next = context;                                     \
        return next->what(next->context, what, err);                        \
    }
PASS(record, const lac_record *)
PASS(snapshot, const lac_snapshot *)
PASS(step, const lac_step *)
PASS(event, const lac_event *)
PASS(once, const double *)
PASS(checkpoint, const lac_checkpoint *)

static void pass_serialize(void *context, lac_archive *archive)
{
    const lac_sink *next = context;
    next->serialize(next->context, archive);
}

lac_sink lac_sink_before(lac_sink *next)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = next,
                      .record = next->record != NULL ? pass_record : NULL,
                      .snapshot = next->snapshot != NULL ? pass_snapshot : NULL,
                      .step = next->step != NULL ? pass_step : NULL,
                      .event = next->event != NULL ? pass_event : NULL,
                      .once = next->once != NULL ? pass_once : NULL,
                      .serialize = next->serialize != NULL ? pass_serialize : NULL,
                      .checkpoint = next->checkpoint != NULL ? pass_checkpoint : NULL,
                      .cells_from = next->cells_from};
}
