// SPDX-License-Identifier: GPL-3.0-or-later
// Settings that keep an error, picked by runs of the scene itself.
#include "simulation/internal.h"

enum { RUNGS = 10, EXPLICIT_RUNGS = 3 };

static const double rtols[RUNGS] = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};

// What an accuracy is held to.
static const char by_failure[] = "time of failure";
static const char by_limit[] = "time of the limit";
static const char by_slip[] = "mean slip";

// One pilot run; value NaN: it could not be computed.
typedef struct rung {
    double value, work;
    const char *of;
} rung;

typedef struct search {
    lac_scene *scene;
    lac_case *c;
    const lac_simulation_options *options;
    rung at[RUNGS];
    size_t count;
    lac_accuracy_pick *pick;
} search;

// A Newton solve in evaluations of the right-hand side: docs/speed.md; with elastic rock it
// iterates.
static double solve_cost(const lac_case *c)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    return kind != NULL && kind->transforms ? 10.0 : 2.4;
}

static void read_result(const lac_case *c, const lac_run_result *r, rung *out)
{
    out->of = r->failed ? by_failure : r->end == LAC_END_STOP ? by_limit : by_slip;
    out->value = r->failed                ? r->failure_origin + r->failure_local
                 : r->end == LAC_END_STOP ? r->time
                                          : r->mean_slip;
    out->work = (double)r->rhs_evaluations + solve_cost(c) * (double)r->linear_solves;
}

// Runs the scene as it is now; one that cannot be computed has no value.
static lac_status pilot(search *s, double rtol, int64_t most_steps, rung *out, lac_error *err)
{
    lac_run_def def = s->c->run;
    lac_run_result result = {0};
    def.rtol = rtol;
    def.snapshots = false;
    def.checkpoint = (lac_cadence){.time = NAN, .per_decade = NAN};
    def.max_steps = most_steps < def.max_steps ? most_steps : def.max_steps;
    def.interrupted = s->options->interrupted;
    def.progress = s->options->progress;
    def.context = s->options->context;
    lac_status status = lac_run(lac_scene_problem(s->scene), &def, NULL, &result, err);
    read_result(s->c, &result, out);
    s->pick->pilots++;
    s->pick->evaluations += result.rhs_evaluations;
    if (status == LAC_ENUMERIC) {
        out->value = NAN;
        return LAC_OK;
    }
    return status;
}

// Relative difference; INFINITY where they do not end alike.
static double apart(const rung *a, const rung *b)
{
    if (isnan(a->value) || isnan(b->value) || a->of != b->of) {
        return INFINITY;
    }
    const double scale = fabs(b->value);
    return scale > 0.0 ? fabs(a->value - b->value) / scale : fabs(a->value - b->value);
}

// Error of the last rung: what it changed, and no less than a tenth of what the one before did. Two
// rungs may agree by chance: they count for a fifth.
static double last_error(const search *s)
{
    const size_t k = s->count - 1;
    const double last = k > 0 ? apart(&s->at[k - 1], &s->at[k]) : INFINITY;
    return k < 2 ? 5.0 * last : fmax(last, 0.1 * apart(&s->at[k - 2], &s->at[k - 1]));
}

static lac_status climb(search *s, lac_error *err)
{
    const double asked = s->pick->asked;
    lac_status status = LAC_OK;
    while (s->count < RUNGS && status == LAC_OK) {
        status = pilot(s, rtols[s->count], INT64_MAX, &s->at[s->count], err);
        s->count += status == LAC_OK ? 1 : 0;
        if (status == LAC_OK && last_error(s) <= 0.5 * asked) {
            return LAC_OK;
        }
    }
    if (status != LAC_OK) {
        return status;
    }
    if (isnan(s->at[RUNGS - 1].value)) {
        return LAC_ENUMERIC; // as the run said
    }
    return lac_fail(
        err, LAC_ENUMERIC,
        "no rtol down to %g keeps an accuracy of %g: the last decade changed the %s by %.2g",
        rtols[RUNGS - 1], asked, s->at[RUNGS - 1].of, last_error(s));
}

// Whether a run keeps the error, measured against the tightest.
static bool keeps(search *s, const rung *of)
{
    const double error = apart(of, &s->at[s->count - 1]) + last_error(s);
    if (!(error <= 0.8 * s->pick->asked)) {
        return false;
    }
    s->pick->estimated = error;
    s->pick->of = of->of;
    return true;
}

static lac_status turn(search *s, lac_method method, lac_formulation formulation, lac_error *err)
{
    s->c->run.method = method;
    s->c->formulation = (int)formulation;
    return lac_scene_renew(s->scene, NULL, false, err);
}

// An explicit method, where the case leaves it open: it may not take more work than `least`.
static lac_status try_explicit(search *s, double least, lac_error *err)
{
    const int evaluations = 6; // of a step
    const lac_friction_params *friction = s->c->friction.params;
    const lac_formulation formulation =
        lac_formulation_choose(LAC_FORMULATION_AUTO, LAC_ERK, (lac_friction_form)friction->form);
    const lac_method method = s->c->run.method;
    const lac_formulation before = (lac_formulation)s->c->formulation;
    lac_status status = turn(s, LAC_ERK, formulation, err);
    for (size_t k = 0; k < EXPLICIT_RUNGS && status == LAC_OK; k++) {
        rung found;
        status = pilot(s, rtols[k], (int64_t)(least / evaluations) + 1, &found, err);
        if (status == LAC_OK && isnan(found.value)) {
            break; // too many steps, and a tighter one takes more
        }
        if (status == LAC_OK && found.work < least && keeps(s, &found)) {
            s->pick->rtol = rtols[k];
            return LAC_OK;
        }
    }
    return status == LAC_OK ? turn(s, method, before, err) : status;
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

lac_status lac_accuracy_choose(lac_scene *scene, lac_case *c, const lac_simulation_options *options,
                               lac_accuracy_pick *out, lac_error *err)
{
    search s = {.scene = scene, .c = c, .options = options, .pick = out};
    *out = (lac_accuracy_pick){.asked = c->accuracy};
    lac_status status = climb(&s, err);
    if (status != LAC_OK) {
        return status;
    }
    size_t k = 0;
    while (!keeps(&s, &s.at[k])) {
        k++; // the last one does: its error is at most half of what is asked
    }
    out->rtol = rtols[k];
    const bool open = !c->method_given && !c->formulation_given &&
                      c->run.fidelity != LAC_FIDELITY_ASYNC && !(lac_inertia_mass(c) > 0.0) &&
                      c->geometry.angles == 0;
    if (open) {
        status = try_explicit(&s, s.at[k].work, err);
    }
    c->run.rtol = out->rtol;
    c->accuracy = NAN;
    describe(c, out);
    return status;
}
