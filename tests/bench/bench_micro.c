// SPDX-License-Identifier: GPL-3.0-or-later
// Fidelity `events` where cells slip one by one (k_0 = 0.15 k_crit): what a slip costs from 1e3 to
// 1e6 cells, and the same stretch of time with `ode`.
//
//   bench_micro [LEVELS [ODE_LEVELS [FIRST [SLIPS [PART]]]]]
//
// from 4^FIRST to 4^LEVELS cells, until one in PART has slipped; then both fidelities up to
// 4^ODE_LEVELS cells, until SLIPS have.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lacuna/simulation.h"

#include "support/cost.h"
#include "support/tree.h"

#define MOVES 1e-3 // a cell slips when it comes to this rate [m/s]

typedef struct slips {
    size_t n;
    unsigned char *moves;          // [n]
    double *since, slip;           // [n] slip when it began; sum of what they slipped [m]
    long long count, wanted, fast; // fast: steps of cells that slip
    double last;                   // time of the last one that was wanted [s]
} slips;

// Counts the cells that begin to slip.
static lac_status on_step(void *context, const lac_step *step, lac_error *err)
{
    (void)err;
    slips *s = context;
    size_t count = step->changed != NULL ? step->changes : step->n;
    for (size_t k = 0; k < count; k++) {
        size_t i = step->changed != NULL ? step->changed[k] : k;
        double v = fabs(step->slip_rate[i]);
        if (!s->moves[i] && v >= MOVES) {
            s->since[i] = step->slip[i];
            s->last = s->count++ < s->wanted ? step->time_origin + step->time_local : s->last;
        }
        s->fast += v >= 0.5 * MOVES;
        s->slip += s->moves[i] && v < 0.5 * MOVES ? step->slip[i] - s->since[i] : 0.0;
        s->moves[i] = s->moves[i] ? v >= 0.5 * MOVES : v >= MOVES;
    }
    return LAC_OK;
}

static bool enough(void *context)
{
    const slips *s = context;
    return s->count >= s->wanted;
}

typedef struct outcome {
    lac_run_result result;
    double cpu, last, slip;
    long long slips, fast;
} outcome;

static outcome measure(const tree *t, lac_fidelity fidelity, double rtol, double end,
                       long long wanted)
{
    slips s = {.n = t->domain->n, .wanted = wanted};
    s.moves = calloc(s.n, 1);
    s.since = calloc(s.n, sizeof *s.since);
    lac_sink sink = {.context = &s, .step = on_step};
    lac_run_def how = lac_run_default();
    how.fidelity = fidelity;
    how.rtol = rtol;
    how.end = end;
    how.failure_rate = 1e3;
    how.max_steps = INT64_MAX;
    how.record = (lac_cadence){.time = NAN, .steps = 0, .per_decade = NAN};
    how.interrupted = enough;
    how.context = &s;
    outcome out = {0};
    lac_error err = {""};
    double start = cpu_seconds();
    lac_status status = lac_run(t->problem, &how, &sink, &out.result, &err);
    if (status != LAC_OK && status != LAC_EINTERRUPT) {
        fprintf(stderr, "bench_micro: %s\n", err.message);
        exit(1);
    }
    out.cpu = cpu_seconds() - start;
    out.slips = s.count;
    out.slip = s.slip;
    out.fast = s.fast;
    out.last = s.last;
    free(s.moves);
    free(s.since);
    return out;
}

static void print(const char *fidelity, double rtol, size_t n, const outcome *o)
{
    double many = (double)(o->slips > 0 ? o->slips : 1);
    double steps = (double)o->result.steps;
    printf("%-6s %6.0e %8zu %7lld %11lld", fidelity, rtol, n, o->slips, (long long)o->result.steps);
    printf(" %9.1f %11.1f %11.1f %9.2f %9.3f %11.4f %9.2f %12.6g\n", o->slip / many / 1e-5,
           steps / many, (double)o->fast / many, steps / (o->slip / 1e-5), 1e6 * o->cpu / steps,
           1e3 * o->cpu / many, o->cpu, o->last);
    fflush(stdout);
}

static void make(int levels, tree *t)
{
    tree_def def = tree_default(levels, 1);
    def.keep = 1.0;
    def.k0 = 0.15 * def.pressure * (def.b - def.a) / def.dc;
    def.ratio = 0.5;
    tree_create(&def, t);
}

// Until a part as many slips as there are cells.
static void grow(int levels, long long part)
{
    tree t;
    make(levels, &t);
    outcome events = measure(&t, LAC_FIDELITY_ASYNC, 1e-6, 1e12, (long long)t.domain->n / part);
    print("events", 1e-6, t.domain->n, &events);
    tree_clear(&t);
}

// The first slips, which both come to.
static void compare(int levels, long long wanted)
{
    tree t;
    make(levels, &t);
    outcome found = measure(&t, LAC_FIDELITY_ASYNC, 1e-6, 1e12, wanted);
    outcome events = measure(&t, LAC_FIDELITY_ASYNC, 1e-6, found.last, INT64_MAX);
    print("events", 1e-6, t.domain->n, &events);
    outcome ode = measure(&t, LAC_FIDELITY_ODE, 1e-6, found.last, INT64_MAX);
    print("ode", 1e-6, t.domain->n, &ode);
    printf("       %.1f times faster\n", ode.cpu / events.cpu);
    tree_clear(&t);
}

int main(int count, char **given)
{
    int most = count > 1 ? atoi(given[1]) : 10;
    int most_ode = count > 2 ? atoi(given[2]) : 7;
    int first = count > 3 ? atoi(given[3]) : 5;
    long long wanted = count > 4 ? atoll(given[4]) : 300;
    long long part = count > 5 ? atoll(given[5]) : 32;
    printf("          rtol    cells   slips       steps   dc/slip  steps/slip    fast/slip   "
           "steps/dc   us/step     ms/slip     CPU s"
           "  last slip s\n");
    for (int levels = first; levels <= most; levels++) {
        grow(levels, part);
    }
    for (int levels = first; levels <= most_ode; levels++) {
        compare(levels, wanted);
    }
    return 0;
}
