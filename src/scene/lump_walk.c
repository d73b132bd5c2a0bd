// SPDX-License-Identifier: GPL-3.0-or-later
// A way to the end of a run in few long steps, the same for all cells and for those that are to
// stand for them: what a step leaves out is alike in both, so that their ends differ by what taking
// cells together changes. docs/theory/lumped.md.
#include "scene/lump_walk.h"

#include "lacuna/simulation.h"
#include "run/run.h"

enum { MOST_STAGES = 1000 }; // more are of cells that slip one by one

// Share of a step at whose end its rates are taken: above a half, so that what is fast dies away.
static const double late = 0.6;

// e-folds of rate and state that a step may be long.
static const double longest = 0.15;

typedef struct walk {
    const lac_problem *problem;
    const lac_run_def *ends;
    lac_failure failure;
    lac_lump_way *way;
    size_t stage;
    bool leads;
    size_t unknowns, n;
    double *y, *f, *step; // [unknowns] the state, its rates of change, what a step adds
    double *weight;       // [unknowns]
    double *v, *work;     // [n] slip rates; lac_problem_work
    double most_slip;     // that ends it [m]
    double growth;        // of the mean slip rate [1/s]
    double t, h, slip, rate, fastest, past; // reached; h the last step
    double next;                            // break of the loads, or the end
    double length;                          // that the next step is to have; 0: it begins anew
} walk;

static lac_status start(walk *w, lac_error *err)
{
    w->unknowns = lac_problem_unknowns(w->problem);
    w->n = lac_problem_cells(w->problem);
    w->y = malloc((4 * w->unknowns + w->n + lac_problem_work(w->problem)) * sizeof *w->y);
    LAC_FAIL_MEMORY_IF(w->y == NULL, err);
    w->f = w->y + w->unknowns;
    w->step = w->f + w->unknowns;
    w->weight = w->step + w->unknowns;
    w->v = w->weight + w->unknowns;
    w->work = w->v + w->n;
    w->failure = lac_problem_failure(w->problem, w->ends->failure_rate, w->ends->failure_slip);
    w->most_slip = fmin(w->failure.slip, w->ends->stop_slip); // the former where no other is asked
    lac_problem_forget(w->problem, w->work);
    lac_problem_initial(w->problem, w->y);
    return LAC_OK;
}

// Where the next break of the loads is, after one that was reached.
static void look_ahead(walk *w)
{
    w->next = fmin(lac_problem_next_break(w->problem, w->t), w->ends->end);
}

// The rates where it stands, and the slip on the way there.
static bool arrive(walk *w)
{
    double mean;
    if (!lac_problem_derivative(w->problem, w->t, w->y, w->f, w->work)) {
        return false;
    }
    memcpy(w->v, w->work, w->n * sizeof *w->v);
    lac_problem_speed(w->problem, w->t, w->y, true, &mean, &w->fastest, w->work);
    const double folds = log(mean / w->rate);
    w->slip += w->h * (fabs(folds) > 1e-6 ? (mean - w->rate) / folds : mean);
    w->rate = mean;
    return mean > 0.0 && isfinite(mean);
}

// A part of the time in which cells that start at rates of their own come to one, and of the run.
static double first_step(const walk *w)
{
    const double of_run = 1e-3, of_scale = 0.03;
    const double fastest = lac_problem_fastest(w->problem, w->t, w->y, w->work);
    return fmin(of_run * w->ends->end,
                fmin(of_scale / fastest, lac_problem_first_step(w->problem, w->t, w->y, w->work)));
}

// A step of length h from the rates f: false where it is too long for the solve.
static bool solve(walk *w, double h)
{
    for (size_t i = 0; i < w->unknowns; i++) {
        w->step[i] = h * w->f[i];
    }
    return lac_problem_newton(w->problem, w->t, w->y, late * h, w->step, w->work);
}

// How far a step goes: e-folds, squares averaged over all unknowns or, if that is more, over those
// of the cells by how fast they slip.
static double size_of(const walk *w)
{
    double all = 0.0, fast = 0.0, rates = 0.0;
    for (size_t i = 0; i < w->unknowns; i++) {
        const double folds = w->step[i] * w->weight[i];
        all += folds * folds;
        if (i < w->n) {
            fast += w->v[i] * folds * folds;
            rates += w->v[i];
        }
    }
    return sqrt(fmax(all / (double)w->unknowns, fast / rates));
}

// Chooses a step by how far it goes, and keeps its length.
static bool lead(walk *w)
{
    lac_lump_way *way = w->way;
    const double grow = 1.7;
    const double past = w->growth * w->t; // over what is left
    const double most = longest * (past > 1000.0 ? 9.0 : past > 10.0 ? 3.0 : 1.0);
    lac_problem_weights(w->problem, w->y, 1.0, w->weight);
    for (int tries = 0; tries < 60; tries++) {
        const bool short_of = w->length < w->next - w->t;
        const double now = short_of ? w->length : w->next - w->t;
        const double size = solve(w, now) ? size_of(w) : INFINITY;
        if (size <= 1.5 * most) {
            if (way->count == MOST_STAGES) {
                return false;
            }
            way->stage[way->count++] =
                (lac_lump_stage){now, now * w->rate, w->t, w->slip, !short_of};
            w->h = now;
            w->length = fmin(now * fmin(grow, most / fmax(size, 1e-9)),
                             lac_problem_longest_step(w->problem, w->t));
            return true;
        }
        w->length = now * fmax(0.1, 0.8 * fmin(1.0, most / size));
    }
    return false;
}

// The step that the leader took here, as long by slip, or where its end is one of time by time.
static bool follow(walk *w)
{
    lac_lump_way *way = w->way;
    const lac_lump_stage *s = &way->stage[w->stage++];
    const bool by_time = way->arrival == LAC_LUMP_AT_TIME;
    const double by = by_time ? s->time : s->slip / w->rate;
    w->h = s->whole ? w->next - w->t : fmin(by, w->next - w->t);
    const double led = by_time ? s->slipped : s->start, came = by_time ? w->slip : w->t;
    way->apart = led > 0.5 * way->value ? fmax(way->apart, fabs(came - led) / way->value) : 0.0;
    return solve(w, w->h);
}

// How the way ends where it stands, if it does.
static lac_lump_arrival arrival_of(const walk *w)
{
    return w->slip >= w->most_slip ? LAC_LUMP_AT_LIMIT
           : w->past >= 0.0        ? LAC_LUMP_AT_FAILURE
           : w->t >= w->ends->end  ? LAC_LUMP_AT_TIME
                                   : LAC_LUMP_ON_ITS_WAY;
}

// What it comes to. @param was  how far it was past failure a step before
static double result_of(const walk *w, lac_lump_arrival arrival, double was)
{
    return arrival == LAC_LUMP_AT_LIMIT  ? w->t - (w->slip - w->most_slip) / w->rate
           : arrival == LAC_LUMP_AT_TIME ? w->slip
           : was < 0.0                   ? w->t - w->h * w->past / (w->past - was)
                                         : w->t;
}

// Whether the end is reached, and what it comes to.
// @param before  mean slip rate at the step's start
static bool ends_here(walk *w, double before, double *value)
{
    lac_lump_way *way = w->way;
    const double was = w->past;
    w->growth = w->h > 0.0 ? log(w->rate / before) / w->h : 0.0;
    w->past = log(w->rate / w->failure.rate); // no less than it is
    if (w->past >= 0.0) {
        w->past = lac_problem_past_failure(w->problem, &w->failure, w->t, w->y, w->work);
    }
    w->past = fmax(w->past, log(w->fastest / w->ends->stop_rate)); // NaN where none is asked
    if (w->leads) {
        way->arrival = arrival_of(w);
    }
    *value = result_of(w, way->arrival, was);
    return w->leads ? way->arrival != LAC_LUMP_ON_ITS_WAY : w->stage == way->count;
}

// Across a jump or bend of the loads.
static bool jump(walk *w)
{
    const bool balanced = lac_problem_jump(w->problem, w->t, w->y, w->work);
    look_ahead(w);
    w->h = w->length = 0.0;
    return balanced && arrive(w);
}

// @return false: it comes to no end
static bool go(walk *w, double *value)
{
    look_ahead(w);
    w->rate = 1.0; // until it has arrived at the start
    for (bool first = true;; first = false) {
        const double before = w->rate;
        if (!arrive(w)) {
            return false;
        }
        if (ends_here(w, before, value)) {
            return true;
        }
        if (!first && w->t >= w->next && !jump(w)) {
            return false;
        }
        w->length = w->length > 0.0 ? w->length : first_step(w);
        if (!(w->leads ? lead(w) : follow(w))) {
            return false;
        }
        for (size_t i = 0; i < w->unknowns; i++) {
            w->y[i] += w->step[i];
        }
        w->t = w->h < w->next - w->t ? w->t + w->h : w->next;
    }
}

lac_status lac_lump_walk(const lac_problem *problem, const lac_run_def *ends, bool leads,
                         lac_lump_way *way, double *value, lac_error *err)
{
    lac_status status;
    walk w = {.problem = problem, .ends = ends, .leads = leads, .way = way, .past = NAN};
    way->apart = 0.0;
    if (leads) {
        way->stage = way->stage != NULL ? way->stage : malloc(MOST_STAGES * sizeof *way->stage);
        LAC_FAIL_MEMORY_IF(way->stage == NULL, err);
        way->count = 0;
    }
    LAC_TRY(start(&w, err));
    *value = go(&w, value) ? *value : (double)NAN;
    way->value = leads ? *value : way->value;
out:
    free(w.y);
    return status;
}
