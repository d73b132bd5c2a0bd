// SPDX-License-Identifier: GPL-3.0-or-later
// Share of a run's CPU time that the indicator `rg` takes, every step recorded: cells that fail
// together, and cells that fail one by one and heal; by strength and by rate. The sink counts the
// time within the run itself, so that other load cancels.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lacuna/analysis.h"
#include "support/cost.h"
#include "support/tree.h"

typedef struct counter {
    lac_sink inner;
    double spent;
} counter;

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    counter *c = context;
    double start = cpu_seconds();
    lac_status status = c->inner.record(c->inner.context, record, err);
    c->spent += cpu_seconds() - start;
    return status;
}

static void measure(const char *what, int levels, uint64_t seed, double k0, double end,
                    const lac_analysis_rg *params)
{
    tree_def def = tree_default(levels, seed);
    def.state *= 3.0;
    def.k0 *= k0;
    tree t;
    tree_create(&def, &t);
    lac_slot slot = {.about = &lac_indicator_kind_at(0)->about, .params = (void *)params};
    lac_analysis_scene scene = {.domain = t.domain,
                                .hierarchy = t.hierarchy,
                                .friction = t.friction,
                                .critical = {.value = 0.5, .beta = 0.7}};
    lac_analysis *analysis = NULL;
    lac_error err = {""};
    const lac_sink nothing = {0};
    counter c = {.spent = 0.0};
    lac_run_result result;
    lac_run_def how = lac_run_default();
    how.rtol = 1e-5;
    how.end = 1e10;
    how.failure_rate = 1e3;
    how.stop_rate = k0 < 1.0 ? NAN : 0.5;
    how.stop_slip = k0 < 1.0 ? end : NAN;
    how.max_steps = 20000;
    if (lac_analysis_create(&scene, 1, &slot, &analysis, &err) != LAC_OK) {
        (void)fprintf(stderr, "bench_analysis: %s\n", err.message);
        exit(1);
    }
    c.inner = lac_analysis_sink(analysis, &nothing);
    const lac_sink sink = {.context = &c, .record = on_record};
    double start = cpu_seconds();
    (void)lac_run(t.problem, &how, &sink, &result, &err); // may end for its steps
    double total = cpu_seconds() - start;
    (void)lac_analysis_finish(analysis, &result, &err);
    const lac_analysis_result *said = lac_analysis_at(analysis, 0)->result;
    printf("%-28s %8zu %8lld %8.2f %8.3f %9.2f %% %10.3f %8.3f\n", what, t.domain->n,
           (long long)result.steps, total, c.spent, 100.0 * c.spent / total,
           1e9 * c.spent / ((double)t.domain->n * (double)result.steps), said[0].value);
    lac_analysis_free(analysis);
    tree_clear(&t);
}

int main(void)
{
    const lac_analysis_rg strength = {
        .slipping_strength = 0.85, .slipping_rate = NAN, .slipping_rate_ratio = NAN};
    const lac_analysis_rg early = {
        .slipping_strength = 0.99, .slipping_rate = NAN, .slipping_rate_ratio = NAN};
    const lac_analysis_rg rate = {
        .slipping_strength = NAN, .slipping_rate = NAN, .slipping_rate_ratio = 100.0};
    printf("%-28s %8s %8s %8s %8s %11s %10s %8s\n", "run", "cells", "steps", "CPU s", "rg s",
           "share", "ns/cell", "slips");
    measure("together, strength 0.85", 6, 14, 1.0, NAN, &strength);
    measure("together, strength 0.99", 6, 14, 1.0, NAN, &early);
    measure("together, 100 times", 6, 14, 1.0, NAN, &rate);
    measure("one by one, strength 0.85", 6, 14, 1e-3, 1e-3, &strength);
    measure("one by one, 100 times", 6, 14, 1e-3, 1e-3, &rate);
    measure("together, strength 0.85", 9, 9, 1.0, NAN, &strength);
    measure("together, strength 0.99", 9, 9, 1.0, NAN, &early);
    measure("together, 100 times", 9, 9, 1.0, NAN, &rate);
    return 0;
}
