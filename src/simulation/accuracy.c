// SPDX-License-Identifier: GPL-3.0-or-later
// Settings that keep an error, picked by runs of the scene itself, the last of which is kept as the
// run. The numbers are of tools/studies/accuracy.py: docs/trade.md.
#include "simulation/internal.h"

enum {
    RUNGS = 11,
    FINE = 2,           // rung of the first run that may be kept, where nothing close is asked for
    APART = 2,          // decades that the run before it is coarser: two such agree by chance less
    ASYNC_FINER = 2,    // cells with steps of their own converge from there on
    EXPLICIT_RUNS = 4,  // of which one must do
    LOW_ORDER = 3,      // of the coarse one: half of the evaluations, and other errors
    EXPLICIT_STAGES = 6 // evaluations of a step
};

static const double rtols[RUNGS] = {1e-2, 1e-3, 1e-4,  1e-5,  1e-6, 1e-7,
                                    1e-8, 1e-9, 1e-10, 1e-11, 1e-12};

// Steps of an explicit method that stability may ask for before the other one is looked at.
static const double most_stiff = 70;

// Steps that a tighter run has more, at the least, where the tolerance bounds them.
static const double few = 1.15;

// Bytes of records and fields that a pilot run may keep.
static const size_t most_kept = (size_t)256 << 20;

// What an accuracy is held to.
static const char by_failure[] = "time of failure";
static const char by_limit[] = "time of the limit";
static const char by_slip[] = "mean slip";

// One pilot run; value NaN: it could not be computed.
typedef struct rung {
    double value, rtol, work, stiff_steps;
    int64_t steps;
    const char *of;
    lac_end end;
    double part; // of what changes to the next, by which that one is off; 0: as steps say
} rung;

typedef struct search {
    const lac_accuracy_def *def;
    lac_case *c;
    lac_take *take;
    lac_accuracy_pick *pick;
    rung last;
} search;

void lac_take_clear(lac_take *take)
{
    lac_analysis_free(take->analysis);
    lac_tape_clear(&take->tape);
    *take = (lac_take){0};
}

// Steps and Newton's solves in evaluations of the right-hand side, by instructions.
static double work_of(lac_method method, const lac_run_result *r)
{
    const double solve = 2.2, step = method == LAC_ERK ? 2.2 : 4.2;
    return (double)r->rhs_evaluations + solve * (double)r->linear_solves + step * (double)r->steps;
}

static rung read_result(const lac_run_def *def, const lac_run_result *r, lac_status status)
{
    rung out = {.rtol = def->rtol,
                .work = work_of(def->method, r),
                .stiff_steps = r->stiff_steps,
                .steps = r->steps,
                .end = r->end};
    out.of = r->failed ? by_failure : r->end == LAC_END_STOP ? by_limit : by_slip;
    out.value = status == LAC_ENUMERIC   ? (double)NAN
                : r->failed              ? r->failure_origin + r->failure_local
                : r->end == LAC_END_STOP ? r->time
                                         : r->mean_slip;
    return out;
}

// A run whose output and indicators are kept. Planned checkpoints are of use in a file only.
static lac_status run_and_keep(search *s, const lac_run_def *def, lac_error *err)
{
    lac_take *take = s->take;
    const lac_accuracy_def *how = s->def;
    const bool plans =
        def->checkpoint.steps > 0 || def->checkpoint.time > 0.0 || def->checkpoint.per_decade > 0.0;
    if (plans || how->options->live || how->scene->lump != NULL) {
        return lac_run(lac_scene_problem(how->scene), def, NULL, &take->run, err);
    }
    LAC_TRY_RETURN(lac_indicators_create(how->scene, how->critical, &take->analysis, err));
    take->tape = (lac_tape){.values = lac_analysis_values(take->analysis),
                            .points = how->points != NULL ? how->points->n : 0,
                            .cells = !how->options->cells_unread,
                            .steps = how->options->steps && def->fidelity == LAC_FIDELITY_ODE,
                            .most = most_kept};
    const lac_sink tape = lac_tape_sink(&take->tape);
    const lac_sink sink = take->analysis != NULL ? lac_analysis_sink(take->analysis, &tape) : tape;
    LAC_TRY_RETURN(lac_run(lac_scene_problem(how->scene), def, &sink, &take->run, err));
    if (take->analysis != NULL) {
        LAC_TRY_RETURN(lac_analysis_finish(take->analysis, &take->run, err));
    }
    take->whole = !take->tape.over;
    return LAC_OK;
}

// Runs the scene as it is now; one that cannot be computed has no value.
// @param stiff  as lac_run_def.most_stiff, of a run that is not kept; 0: it may be
static lac_status pilot(search *s, double rtol, double stiff, rung *out, lac_error *err)
{
    lac_run_def def = s->c->run;
    const bool low_order =
        stiff > 0.0 && def.method == LAC_ERK && def.max_order == 0 && rtol == rtols[0];
    def.max_order = low_order ? LOW_ORDER : def.max_order;
    def.rtol = rtol;
    def.most_stiff = stiff;
    def.points = s->def->points;
    def.interrupted = s->def->options->interrupted;
    def.progress = s->def->options->progress;
    def.context = s->def->options->context;
    lac_take_clear(s->take);
    lac_status status;
    if (stiff > 0.0) {
        def.snapshots = false;
        status = lac_run(lac_scene_problem(s->def->scene), &def, NULL, &s->take->run, err);
    } else {
        status = run_and_keep(s, &def, err);
    }
    *out = read_result(&def, &s->take->run, status);
    out->part = low_order ? 0.2 : 0.0;
    s->pick->pilots++;
    s->pick->evaluations += s->take->run.rhs_evaluations;
    s->pick->work += out->work;
    return status == LAC_ENUMERIC ? LAC_OK : status;
}

// Relative difference; INFINITY where they do not end alike.
static double apart(const rung *a, const rung *b)
{
    if (isnan(a->value) || isnan(b->value) || a->of != b->of || a->end != b->end) {
        return INFINITY;
    }
    const double scale = fabs(b->value);
    return scale > 0.0 ? fabs(a->value - b->value) / scale : fabs(a->value - b->value);
}

static double more_steps(const rung *coarse, const rung *fine)
{
    return (double)fine->steps / (double)(coarse->steps > 0 ? coarse->steps : 1);
}

// Error of the finer of two runs: beside one of another method or order a part, else as the inverse
// of the steps, were the order 1. Where the tolerance bounds the steps but little, as breaks or
// stability do, agreement says little too: there and where both agree by chance, what the tolerance
// was seen to leave at most.
static double error_of(lac_method method, const rung *coarse, const rung *fine)
{
    const double steps = more_steps(coarse, fine);
    const double change = apart(coarse, fine);
    if (coarse->part > 0.0) {
        return fmax(change * coarse->part, 5.0 * fine->rtol);
    }
    if (steps < few) {
        return fmax(3.0 * change, (method == LAC_ERK ? 5.0 : 10.0) * fine->rtol);
    }
    const double most = coarse->rtol > 50.0 * fine->rtol ? 1.0 / 3.0 : 1.0; // decades apart
    return fmax(change * fmin(1.0 / (steps - 1.0), most),
                (method == LAC_ERK ? 2.0 : 5.0) * fine->rtol);
}

// Rung of the first run that may be kept.
static size_t fine_rung(const lac_case *c)
{
    const double digits = ceil(-log10(c->accuracy) - 1e-9) - 1.0;
    const size_t finer = c->run.fidelity == LAC_FIDELITY_ASYNC ? ASYNC_FINER : 0;
    return (size_t)fmax(digits, FINE) + finer;
}

// A run that is not kept, which those that may be are compared with.
static lac_status begin(search *s, double stiff, lac_error *err)
{
    return pilot(s, rtols[fine_rung(s->c) - APART], stiff, &s->last, err);
}

// Ever tighter runs until one is close enough, by so many decades as it seems to need; by two where
// steps do not grow, as such a run costs no more.
// @param found  whether there is one
static lac_status climb(search *s, size_t most, bool *found, lac_error *err)
{
    const double asked = 0.8 * s->pick->asked;
    *found = false;
    for (size_t k = fine_rung(s->c), n = 0; k < RUNGS && n < most && !*found; n++) {
        const rung before = s->last;
        LAC_TRY_RETURN(pilot(s, rtols[k], 0.0, &s->last, err));
        const double error = error_of(s->c->run.method, &before, &s->last);
        const double decades = isfinite(error) ? ceil(log10(error / asked)) : 1.0;
        *found = error <= asked;
        s->pick->estimated = error;
        const double least = before.part > 0.0 || more_steps(&before, &s->last) >= few ? 1.0 : 2.0;
        k += (size_t)fmin(fmax(decades, least), 3.0);
    }
    return LAC_OK;
}

static lac_status turn(search *s, lac_method method, lac_formulation formulation, lac_error *err)
{
    s->c->run.method = method;
    s->c->formulation = (int)formulation;
    return lac_scene_renew(s->def->scene, NULL, false, err);
}

// erk, where the case leaves it open, by the measurements that speak for it in docs/choosing.md.
// @param begun  whether there is a coarse run, of the case's own method; else one of erk is made
// @param tried  whether it was gone through with; if it does not do, the case is as it was
static lac_status try_explicit(search *s, bool begun, bool *tried, bool *found, lac_error *err)
{
    const lac_friction_params *friction = s->c->friction.params;
    const lac_formulation formulation =
        lac_formulation_choose(LAC_FORMULATION_AUTO, LAC_ERK, (lac_friction_form)friction->form);
    const lac_method method = s->c->run.method;
    const lac_formulation before = (lac_formulation)s->c->formulation;
    LAC_TRY_RETURN(turn(s, LAC_ERK, formulation, err));
    LAC_TRY_RETURN(begun ? LAC_OK : begin(s, most_stiff, err));
    *tried = !isnan(s->last.value);
    if (*tried) {
        LAC_TRY_RETURN(climb(s, EXPLICIT_RUNS, found, err));
    }
    return *found ? LAC_OK : turn(s, method, before, err);
}

// The case's own method. A first run of it says what stability would ask of erk: where that is less
// than what it takes itself, erk is looked at after all.
static lac_status climb_own(search *s, bool open, bool *found, lac_error *err)
{
    const double worth = 2.5, step = 2.2;
    LAC_TRY_RETURN(begin(s, INFINITY, err));
    const rung first = s->last;
    const double explicit = (EXPLICIT_STAGES + step) * first.stiff_steps;
    if (open && !isnan(first.value) && explicit < worth * first.work) {
        bool tried;
        s->last.part = 1.0 / 3.0;
        LAC_TRY_RETURN(try_explicit(s, true, &tried, found, err));
    }
    s->last = *found ? s->last : first;
    return *found ? LAC_OK : climb(s, RUNGS, found, err);
}

static void describe(const lac_case *c, lac_accuracy_pick *pick)
{
    static const char *const methods[] = {
        [LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};
    pick->method = methods[c->run.method];
    pick->formulation = lac_formulation_name((lac_formulation)c->formulation);
    (void)snprintf(pick->text, sizeof pick->text,
                   "rtol %g, method %s, formulation %s: error of the %s %.1e, asked %g, by %" PRId64
                   " pilot runs",
                   pick->rtol, pick->method, pick->formulation, pick->of, pick->estimated,
                   pick->asked, pick->pilots);
}

static lac_status fail(const search *s, lac_error *err)
{
    if (isnan(s->last.value)) {
        return LAC_ENUMERIC; // as the run said
    }
    return lac_fail(err, LAC_ENUMERIC,
                    "no rtol down to %g keeps an accuracy of %g: the last is off in the %s by some "
                    "%.2g",
                    rtols[RUNGS - 1], s->pick->asked, s->last.of, s->pick->estimated);
}

lac_status lac_accuracy_choose(const lac_accuracy_def *def, lac_case *c, lac_accuracy_pick *out,
                               lac_take *take, lac_error *err)
{
    search s = {.def = def, .c = c, .pick = out, .take = take};
    *out = (lac_accuracy_pick){.asked = c->accuracy};
    const bool open = !c->method_given && !c->formulation_given &&
                      c->run.fidelity != LAC_FIDELITY_ASYNC && !(lac_inertia_mass(c) > 0.0) &&
                      c->geometry.angles == 0;
    bool tried = false, found = false;
    if (open) {
        LAC_TRY_RETURN(try_explicit(&s, false, &tried, &found, err));
    }
    if (!found) {
        LAC_TRY_RETURN(climb_own(&s, open && !tried, &found, err));
    }
    if (!found) {
        return fail(&s, err);
    }
    out->rtol = s.last.rtol;
    out->of = s.last.of;
    out->kept = take->whole;
    c->run.rtol = out->rtol;
    c->accuracy = NAN;
    describe(c, out);
    return LAC_OK;
}
