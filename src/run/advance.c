// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a run still gets on: by the number of its steps, and by the time that they add up to.
#include "run/run_state.h"

static lac_status too_many_steps(const lac_run_state *r, lac_error *err)
{
    return lac_fail(
        err, LAC_ENUMERIC,
        "%lld %s were not enough: t = %.17g s of %g s, last step %.3g s, mean slip rate %g m/s",
        (long long)r->def->max_steps, r->engine->kind->sweeps ? "sweeps over the cells" : "steps",
        lac_engine_time(r->engine), r->def->end, r->engine->step, r->mean_rate);
}

// Looks now and then whether time goes on: far less than the cells' own time scale in a thousand
// steps is none at all. The steps are summed: near a stop they are too short for a difference of
// times.
static lac_status check_advance(lac_run_state *r, lac_error *err)
{
    const int64_t window = 1000;
    lac_engine *engine = r->engine;
    r->looked.local += engine->step;
    if (r->steps % window != 0) {
        return LAC_OK;
    }
    double advanced = r->looked.local;
    double pace = lac_problem_first_step(r->problem, lac_engine_clock(engine, engine->t), engine->y,
                                         engine->work);
    bool stalled = r->looked.set && advanced < 1e-9 * pace;
    r->looked = (lac_instant){.set = true};
    if (!stalled) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_engine_lifted(engine, err));
    return lac_fail(err, LAC_ENUMERIC,
                    "time no longer advances: %lld steps of %.3g s at t = %.17g s, mean slip rate "
                    "%g m/s; nothing holds the cells back there (no direct effect, no damping?)",
                    (long long)window, engine->step, lac_engine_time(engine), r->mean_rate);
}

lac_status lac_run_state_check(lac_run_state *r, lac_error *err)
{
    if (r->bends) {
        lac_run_state_keep_peak(r);
    }
    return r->steps >= r->def->max_steps ? too_many_steps(r, err) : check_advance(r, err);
}

double lac_run_state_sweep_end(const lac_run_state *r)
{
    if (!r->engine->kind->sweeps || r->between == NULL) {
        return INFINITY;
    }
    double snapshot = r->fields == NULL ? INFINITY : lac_clock_next(&r->snapshot_clock);
    return fmin(lac_clock_next(&r->record_clock), snapshot);
}

lac_status lac_run_state_watch(lac_run_state *r, double step, lac_error *err)
{
    const lac_engine *engine = r->engine;
    if ((r->takes & LAC_TAKES_STEP) == 0) {
        return LAC_OK;
    }
    const bool moves = lac_run_state_shows(r, r->max_rate);
    lac_step observation = {.time_origin = engine->origin,
                            .time_local = engine->base + engine->t,
                            .step = step,
                            .max_rate = r->max_rate,
                            .n = engine->range->all};
    if (moves || r->stepped) {
        const double *size = lac_problem_slip_size(r->problem, engine->slip, engine->work);
        observation.slip_rate = lac_run_state_gather(r, engine->work, 0);
        observation.slip = lac_run_state_gather(r, size, 1);
    }
    r->stepped = moves;
    return lac_run_state_agree(
        r, lac_run_state_leads(r) ? r->sink->step(r->sink->context, &observation, err) : LAC_OK,
        err);
}
