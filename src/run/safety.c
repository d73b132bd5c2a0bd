// SPDX-License-Identifier: GPL-3.0-or-later
// The factor of safety over the records of a run, summed up, and the limits that a jump of the
// loads can come to.
#include "run/run_state.h"

void lac_run_state_keep_safety(lac_run_state *r, double t, double now)
{
    lac_safety_summary *s = &r->result->safety;
    const double before = s->end;
    const double rounding = 1e-6; // and damping, at the reference rate itself
    if (isnan(now)) {
        return;
    }
    if (isnan(s->below_time) && now < 1.0 - rounding) {
        const bool slides_there = !isnan(before) && !r->broken;
        const double gone = slides_there ? fmax(before - 1.0, 0.0) / (before - now) : 1.0;
        s->below_time = t - (1.0 - gone) * (t - r->safety_time);
    }
    if (!(s->least <= now)) {
        s->least = now;
        s->least_time = t;
    }
    s->start = isnan(s->start) ? now : s->start;
    s->end = now;
    r->safety_time = t;
}

bool lac_run_state_stops(const lac_run_state *r, double t)
{
    const lac_run_def *def = r->def;
    const lac_engine *engine = r->engine;
    const bool unsafe = !isnan(def->stop_safety) &&
                        lac_problem_safety(r->problem, t, engine->y, engine->slip, engine->work) <=
                            def->stop_safety;
    return unsafe || r->max_rate >= def->stop_rate;
}
