// SPDX-License-Identifier: GPL-3.0-or-later
// What all integrators share, and the turn to explicit steps where breaks are near each other.
#include "run/engine.h"

#include "base/need.h"
#include "base/statistics.h"

static lac_status create(const lac_engine_kind *kind, const lac_problem *problem,
                         const lac_run_def *def, lac_engine **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_engine *engine = *out = calloc(1, sizeof *engine);
    LAC_FAIL_MEMORY_IF(engine == NULL, err);
    engine->kind = kind;
    engine->problem = problem;
    engine->def = def;
    engine->rtol = def->rtol;
    engine->limit = INFINITY;
    engine->range = lac_problem_range(problem);
    engine->n = lac_problem_cells(problem);
    engine->unknowns = lac_problem_unknowns(problem);
    engine->work = calloc(lac_problem_work(problem), sizeof *engine->work);
    LAC_TRY(engine->work != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_need_sundials(err));
    if (LAC_SUN_CONTEXT_CREATE(&engine->sun) != 0) {
        status = lac_fail_memory(err);
        goto out;
    }
    LAC_SUN_SILENCE_CONTEXT(engine->sun);
    LAC_TRY(engine->kind->create(engine, err));
out:
    LAC_MADE(status, out, lac_engine_free);
}

lac_status lac_engine_create(const lac_problem *problem, const lac_run_def *def, lac_engine **out,
                             lac_error *err)
{
    const lac_engine_kind *kind = def->fidelity == LAC_FIDELITY_ASYNC ? &lac_engine_events
                                  : def->method == LAC_ERK            ? &lac_engine_erk
                                                                      : &lac_engine_cvode;
    return create(kind, problem, def, out, err);
}

void lac_engine_free(lac_engine *engine)
{
    if (engine == NULL) {
        return;
    }
    lac_engine_free(engine->brief);
    engine->kind->free(engine);
    if (engine->sun != NULL) { // else SUNDIALS may not have been opened
        SUNContext_Free(&engine->sun);
    }
    free(engine->work);
    free(engine);
}

double lac_engine_longest_step(const lac_engine *engine)
{
    return lac_problem_longest_step(engine->problem, lac_engine_time(engine));
}

double lac_engine_rtol(double rtol, int64_t beginnings)
{
    const double free = 2.0;    // so many may be off by rtol each
    const double least = 1e-13; // nearer to rounding no step is held
    double share = fmin(1.0, free / (double)(beginnings + 1));
    return fmax(rtol * share, fmin(rtol, least));
}

// Steps of a one-step method that a stretch is worth: about as many cost what a method of many
// steps takes for it from a new beginning. The closer that one is held, the more steps it needs, at
// order five as tolerance^(-1/6).
static double worth_in_steps(const lac_engine *engine)
{
    const double unsharpened = 10.0;
    double rtol = engine->def->rtol;
    return unsharpened * pow(rtol / lac_engine_rtol(rtol, engine->beginnings), 1.0 / 6.0);
}

// Whether the stretch up to the next break is one of few steps for an explicit method. What its
// steps are bounded by: 3.3 times the time in which the stiffest motion decays.
// @param h  becomes a first step that suits it
static bool is_brief(const lac_engine *engine, double *h)
{
    const double stable = 3.3;
    bool ends_at_break = engine->limit < engine->def->end;
    if (engine->kind != &lac_engine_cvode || !ends_at_break) {
        return false;
    }
    double rest = engine->limit - lac_engine_time(engine);
    double fastest = lac_problem_fastest(engine->problem, lac_engine_clock(engine, engine->t),
                                         engine->y, engine->work);
    *h = fmax(*h, fmin(2.0 * rest, 1.0 / fastest)); // beyond it: no sliver is left
    return rest * fastest <= stable * engine->worth;
}

// Hands the state over to the other method.
static lac_status begin_brief(lac_engine *engine, double h, lac_error *err)
{
    if (engine->brief == NULL) {
        LAC_TRY_RETURN(create(&lac_engine_erk, engine->problem, engine->def, &engine->brief, err));
    }
    lac_engine *brief = engine->brief;
    memcpy(brief->y, engine->y, engine->unknowns * sizeof *brief->y);
    memcpy(brief->slip, engine->slip, engine->n * sizeof *brief->slip);
    brief->origin = engine->origin;
    brief->base = engine->base;
    brief->t = engine->t;
    brief->limit = engine->limit;
    brief->before = brief->counts = engine->counts;
    lac_problem_forget(brief->problem, brief->work);
    return brief->kind->restart(brief, h, err);
}

lac_status lac_engine_restart(lac_engine *engine, double h, lac_error *err)
{
    lac_engine_count(engine);
    engine->before = engine->counts;
    lac_problem_forget(engine->problem, engine->work);
    double brief = h;
    engine->worth = worth_in_steps(engine);
    engine->turn = is_brief(engine, &brief) ? LAC_TURN_BRIEF : LAC_TURN_OWN;
    if (engine->turn == LAC_TURN_BRIEF) {
        return begin_brief(engine, brief, err);
    }
    if (engine->kind == &lac_engine_cvode) {
        engine->rtol = lac_engine_rtol(engine->def->rtol, engine->beginnings);
    }
    return engine->kind->restart(engine, h, err);
}

// The stretch takes more steps than it was worth: the engine's own method goes on from here.
static lac_status give_up_brief(lac_engine *engine, lac_error *err)
{
    lac_engine_count(engine);
    engine->before = engine->counts;
    engine->base += engine->t;
    engine->t = 0.0;
    engine->turn = LAC_TURN_OWN;
    engine->counts.restarts++;
    engine->rtol = lac_engine_rtol(engine->def->rtol, engine->beginnings);
    return engine->kind->restart(engine, 0.1 * engine->step, err);
}
static lac_status advance_brief(lac_engine *engine, double stop, lac_error *err)
{
    lac_engine *brief = engine->brief;
    lac_status status = brief->kind->advance(brief, stop, err);
    memcpy(engine->y, brief->y, engine->unknowns * sizeof *brief->y);
    memcpy(engine->slip, brief->slip, engine->n * sizeof *brief->slip);
    engine->base = brief->base;
    engine->t = brief->t;
    engine->step = brief->step;
    return status;
}

lac_status lac_engine_advance(lac_engine *engine, double stop, lac_error *err)
{
    if (engine->turn != LAC_TURN_BRIEF) {
        return engine->kind->advance(engine, stop, err);
    }
    lac_engine_count(engine);
    if ((double)(engine->counts.steps - engine->before.steps) < engine->worth) {
        return advance_brief(engine, stop, err);
    }
    stop -= engine->t;
    LAC_TRY_RETURN(give_up_brief(engine, err));
    return engine->kind->advance(engine, stop, err);
}

bool lac_engine_at(lac_engine *engine, double t, double *observation)
{
    lac_engine *turn = engine->turn == LAC_TURN_BRIEF ? engine->brief : engine;
    return turn->kind->at(turn, t, observation);
}

void lac_engine_count(lac_engine *engine)
{
    if (engine->turn != LAC_TURN_BRIEF) {
        engine->kind->count(engine);
        return;
    }
    engine->brief->kind->count(engine->brief);
    engine->counts = engine->brief->counts;
    engine->order = engine->brief->order;
}

lac_status lac_engine_cannot_restart(const lac_engine *engine, lac_error *err)
{
    return lac_fail(err, LAC_ENUMERIC, "the integrator cannot restart at t = %.17g s",
                    lac_engine_time(engine));
}

lac_status lac_engine_lifted(lac_engine *engine, lac_error *err)
{
    const double near = 1e-6; // of the total: what is left holds nothing
    return lac_problem_lifted(engine->problem, lac_engine_clock(engine, engine->t), engine->y, near,
                              engine->work, err);
}

lac_status lac_engine_gave_up(lac_engine *engine, char *name, double step, int64_t order,
                              lac_error *err)
{
    lac_status status = lac_engine_lifted(engine, err);
    if (status != LAC_OK) {
        free(name);
        return status;
    }
    status = lac_fail(err, LAC_ENUMERIC,
                      "the integrator gave up (%s) at t = %.17g s, step %.3g s, order %lld",
                      name != NULL ? name : "?", lac_engine_time(engine), step, (long long)order);
    free(name);
    const char *lost = lac_problem_lost_transfer(engine->problem, engine->slip, engine->work);
    const bool weakens = lac_problem_weakening(engine->problem) != NULL;
    if (lost != NULL && err != NULL) {
        lac_append(err->message, sizeof err->message,
                   "; the transfer %s finds no stress for the slip", lost);
    } else if (weakens && lac_engine_time(engine) <= 0.0 && err != NULL) {
        lac_append(err->message, sizeof err->message,
                   "; what weakens the joint may do so faster than steps can follow: lacuna check "
                   "says how fast");
    }
    return status;
}

double lac_engine_mean_slip(const lac_engine *engine, const double *slip)
{
    return lac_problem_mean_slip(engine->problem, slip);
}
