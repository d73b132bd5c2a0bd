// SPDX-License-Identifier: GPL-3.0-or-later
// Steps and time of a creep run to failure on random lacunar trees, strongly coupled
// (k_0 = 400 p (b-a)/dc): three methods on about 1 200 cells, then BDF up to 250 000.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lacuna/simulation.h"

#include "support/cost.h"
#include "support/tree.h"

typedef struct outcome {
    size_t cells;
    lac_run_result result;
    double cpu;
} outcome;

static outcome measure(int levels, uint64_t seed, lac_method method, double rtol)
{
    tree_def def = tree_default(levels, seed);
    def.state *= 3.0; // above steady state everywhere: the whole runs away
    tree t;
    tree_create(&def, &t);
    lac_run_def how = lac_run_default();
    how.method = method;
    how.rtol = rtol;
    how.end = 1e10;
    how.failure_rate = 1e3;
    how.stop_rate = 0.5;
    how.record = (lac_cadence){.time = NAN, .steps = 0, .per_decade = NAN};
    outcome out = {.cells = t.domain->n};
    lac_error err = {""};
    double start = cpu_seconds();
    if (lac_run(t.problem, &how, NULL, &out.result, &err) != LAC_OK ||
        out.result.end != LAC_END_STOP) {
        fprintf(stderr, "bench_run: no failure %s\n", err.message);
        exit(1);
    }
    out.cpu = cpu_seconds() - start;
    tree_clear(&t);
    return out;
}

static void print(const char *method, double rtol, const outcome *o, const outcome *reference)
{
    const lac_run_result *r = &o->result;
    double cell_steps = (double)o->cells * (double)r->steps;
    printf("%-6s %6.0e %8zu %8lld %9lld %9lld %8.2f %10.3f %12.9g", method, rtol, o->cells,
           (long long)r->steps, (long long)r->rhs_evaluations, (long long)r->linear_solves, o->cpu,
           1e6 * o->cpu / cell_steps, r->time);
    if (reference != NULL) {
        printf("  %.2f times the steps of the first row",
               (double)r->steps / (double)reference->result.steps);
    }
    printf("\n");
}

int main(void)
{
    printf("method   rtol    cells    steps       rhs    solves    CPU s  s/Mcellstep    time s\n");
    // Seeds chosen for their number of cells.
    outcome small = measure(6, 14, LAC_BDF, 1e-5);
    outcome adams = measure(6, 14, LAC_ADAMS, 1e-5);
    outcome erk = measure(6, 14, LAC_ERK, 1e-5);
    print("bdf", 1e-5, &small, NULL);
    print("adams", 1e-5, &adams, &small);
    print("erk", 1e-5, &erk, &small);
    outcome middle = measure(9, 9, LAC_BDF, 1e-5);
    print("bdf", 1e-5, &middle, &small);
    outcome large = measure(10, 82, LAC_BDF, 1e-5);
    print("bdf", 1e-5, &large, &small);
    return 0;
}
