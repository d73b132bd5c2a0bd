// SPDX-License-Identifier: GPL-3.0-or-later
// Limits crossed within a step: the first is found, and time and state are taken back to it. Those
// that a jump of the loads comes to; and how near its own the factor of safety comes.
#include "run/run_state.h"

// How far a state is past a limit: < 0 before it. Rates on a logarithmic scale, where they are
// smooth.
static double past(const lac_engine *engine, const lac_run_def *def, lac_crossing_kind kind,
                   double t, const double *y, const double *slip)
{
    double mean, max;
    if (kind == LAC_CROSSING_SLIP) {
        return lac_engine_mean_slip(engine, slip) - def->stop_slip;
    }
    if (kind == LAC_CROSSING_GONE) {
        return fabs(lac_engine_mean_slip(engine, slip)) - engine->failure.slip;
    }
    double clock = lac_engine_clock(engine, t);
    if (kind == LAC_CROSSING_SAFETY) {
        return def->stop_safety - lac_problem_safety(engine->problem, clock, y, slip, engine->work);
    }
    if (kind == LAC_CROSSING_FAILURE) {
        return lac_problem_past_failure(engine->problem, &engine->failure, clock, y, engine->work);
    }
    lac_problem_speed(engine->problem, clock, y, false, &mean, &max, engine->work);
    return log(max / def->stop_rate);
}

// A place to look within the step.
typedef struct probe {
    lac_engine *engine;
    const lac_run_def *def;
    lac_crossing_kind kind;
    double *observation; // [unknowns + n] state and slip
} probe;

static bool look(probe *p, double t, double *value)
{
    if (!lac_engine_at(p->engine, t, p->observation)) {
        return false;
    }
    *value = past(p->engine, p->def, p->kind, t, p->observation,
                  lac_engine_slip_in(p->engine, p->observation));
    return true;
}

// Illinois' false position on the step's interpolant, until no number lies between the ends;
// `high` ends at the crossing or the number after it.
static bool locate(probe *p, double low, double *high)
{
    double at_low, at_high;
    if (!look(p, low, &at_low) || !look(p, *high, &at_high)) {
        return false;
    }
    if (at_low >= 0.0) {
        *high = low; // the step began there
    }
    int side = 0;
    for (int i = 0; i < 200 && at_low < 0.0 && at_high > 0.0; i++) {
        double middle = *high - at_high * (*high - low) / (at_high - at_low);
        middle = middle > low ? middle : nextafter(low, *high);
        if (!(middle < *high)) {
            break;
        }
        double at_middle;
        if (!look(p, middle, &at_middle)) {
            return false;
        }
        if (at_middle >= 0.0) {
            *high = middle;
            at_high = at_middle;
            at_low *= side == 1 ? 0.5 : 1.0;
            side = 1;
        } else {
            low = middle;
            at_low = at_middle;
            at_high *= side == -1 ? 0.5 : 1.0;
            side = -1;
        }
    }
    double ignored;
    return look(p, *high, &ignored);
}

// @param speed  as lac_crossing_find has it: what the rates tell is not looked at twice
static bool crossed(const lac_engine *engine, const lac_run_def *def, const double speed[2],
                    lac_crossing_kind kind)
{
    switch (kind) {
    case LAC_CROSSING_FAILURE:
        return log(speed[0] / engine->failure.rate) >= 0.0 &&
               past(engine, def, kind, engine->t, engine->y, NULL) >= 0.0;
    case LAC_CROSSING_RATE:
        return log(speed[1] / def->stop_rate) >= 0.0; // NaN: none is asked for
    case LAC_CROSSING_SLIP:
        return !isnan(def->stop_slip) &&
               past(engine, def, kind, engine->t, NULL, engine->slip) >= 0.0;
    case LAC_CROSSING_SAFETY:
        return !isnan(def->stop_safety) &&
               past(engine, def, kind, engine->t, engine->y, engine->slip) >= 0.0;
    case LAC_CROSSING_GONE:
        return past(engine, def, kind, engine->t, NULL, engine->slip) >= 0.0;
    case LAC_CROSSING_REST:
    case LAC_CROSSING_NONE:
        break;
    }
    return false;
}

static lac_status take_back(lac_engine *engine, const lac_run_def *def, lac_crossing_kind kind,
                            lac_error *err)
{
    size_t n = engine->n, unknowns = engine->unknowns;
    double *found = malloc((unknowns + n) * sizeof *found);
    LAC_FAIL_MEMORY_IF(found == NULL, err);
    double t = engine->t;
    probe p = {engine, def, kind, found};
    bool good = locate(&p, engine->t - (engine->kind->sweeps ? 0.0 : engine->step), &t);
    if (good) {
        engine->step -= engine->t - t;
        engine->t = t;
        memcpy(engine->y, found, unknowns * sizeof *found);
        memcpy(engine->slip, found + unknowns, n * sizeof *found);
    }
    free(found);
    return good ? LAC_OK
                : lac_fail(err, LAC_ENUMERIC,
                           "the end of the run within the step to t = %.17g s cannot be located",
                           lac_engine_time(engine));
}

lac_status lac_crossing_find(lac_engine *engine, const lac_run_def *def, const double speed[2],
                             lac_crossing_kind *found, lac_error *err)
{
    double now[2] = {speed[0], speed[1]};
    *found = LAC_CROSSING_NONE;
    // Several limits in one step: each is located in what the last one left of the step.
    for (lac_crossing_kind kind = LAC_CROSSING_FAILURE; kind <= LAC_CROSSING_GONE; kind++) {
        if (crossed(engine, def, now, kind)) {
            *found = kind;
            LAC_TRY_RETURN(take_back(engine, def, kind, err));
            lac_problem_speed(engine->problem, lac_engine_clock(engine, engine->t), engine->y,
                              false, &now[0], &now[1], engine->work);
        }
    }
    if (*found == LAC_CROSSING_NONE && lac_problem_bends(engine->problem) &&
        lac_problem_settles(engine->problem, lac_engine_clock(engine, engine->t), engine->y,
                            engine->work)) {
        *found = LAC_CROSSING_REST;
    }
    return LAC_OK;
}

lac_end lac_crossing_end(lac_crossing_kind kind)
{
    return kind == LAC_CROSSING_FAILURE ? LAC_END_FAILURE
           : kind == LAC_CROSSING_GONE  ? LAC_END_SLIP
           : kind == LAC_CROSSING_REST  ? LAC_END_REST
                                        : LAC_END_STOP;
}

void lac_run_state_keep_safety(lac_run_state *r, double t, double now)
{
    lac_safety_summary *s = &r->result->safety;
    const double before = s->end;
    if (isnan(now)) {
        return;
    }
    // And damping, at the reference rate itself: what begins at 1, to the digits that are told.
    const double start = isnan(s->start) ? now : s->start, rounding = start < 1.0 ? 5e-5 : 1e-6;
    const double line = before < 1.0 ? 1.0 - rounding : 1.0;
    if (isnan(s->below_time) && now < 1.0 - rounding) {
        const bool slides_there = !isnan(before) && !r->broken;
        const double gone = slides_there ? fmax(before - line, 0.0) / (before - now) : 1.0;
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

void lac_run_state_keep_peak(lac_run_state *r)
{
    lac_arrest *a = &r->result->arrest;
    if (!lac_problem_bends(r->problem)) {
        return;
    }
    if (!(a->largest >= r->mean_rate)) {
        a->largest = r->mean_rate;
        a->largest_time = lac_engine_time(r->engine);
    }
    a->end = r->mean_rate;
    a->arrested = !r->result->failed && a->end < 0.1 * a->largest;
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
