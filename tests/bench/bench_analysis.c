// SPDX-License-Identifier: GPL-3.0-or-later
// Share of a run's CPU time that the indicators take, every step recorded: cells that fail
// together, and cells that fail one by one and heal; `rg` by strength and by rate, `events`. The
// sink counts the time within the run itself, so that other load cancels.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/simulation.h"

#include "analysis/analysis.h"
#include "analysis/slipping.h"
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

static lac_status on_step(void *context, const lac_step *step, lac_error *err)
{
    counter *c = context;
    double start = cpu_seconds();
    lac_status status = c->inner.step(c->inner.context, step, err);
    c->spent += cpu_seconds() - start;
    return status;
}

// The kind of indicator of this name, and its parameters.
static lac_model slot_of(const char *name, const void *params)
{
    size_t i = 0;
    while (strcmp(lac_indicator_kind_get(i)->info.name, name) != 0) {
        i++;
    }
    return (lac_model){.info = &lac_indicator_kind_get(i)->info, .params = (void *)params};
}

static void measure_slot(const char *what, int levels, uint64_t seed, double k0, double end,
                         lac_model model)
{
    tree_def def = tree_default(levels, seed);
    def.state *= 3.0;
    def.k0 *= k0;
    tree t;
    tree_create(&def, &t);
    lac_analysis_scene scene = {.domain = t.domain,
                                .hierarchy = t.hierarchy,
                                .friction = t.friction,
                                .critical = {.value = 0.5, .beta = 0.7},
                                .shear_modulus = 3e10};
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
    how.max_steps = levels > 6 ? 1000 : 20000;
    if (lac_analysis_create(&scene, 1, &model, &analysis, &err) != LAC_OK) {
        (void)fprintf(stderr, "bench_analysis: %s\n", err.message);
        exit(1);
    }
    c.inner = lac_analysis_sink(analysis, &nothing);
    const lac_sink sink = {
        .context = &c, .record = on_record, .step = c.inner.step != NULL ? on_step : NULL};
    double start = cpu_seconds();
    (void)lac_run(t.problem, &how, &sink, &result, &err); // may end for its steps
    double total = cpu_seconds() - start;
    (void)lac_analysis_finish(analysis, &result, &err);
    const lac_analysis_result *said = lac_analysis_get(analysis, 0)->result;
    printf("%-28s %8zu %8lld %8.2f %8.3f %9.2f %% %10.3f %8.3f\n", what, t.domain->n,
           (long long)result.steps, total, c.spent, 100.0 * c.spent / total,
           1e9 * c.spent / ((double)t.domain->n * (double)result.steps), said[0].value);
    lac_analysis_free(analysis);
    tree_clear(&t);
}

static void measure(const char *what, int levels, uint64_t seed, double k0, double end,
                    const lac_analysis_rg *params)
{
    measure_slot(what, levels, seed, k0, end, slot_of("rg", params));
}

static void measure_events(const char *what, int levels, uint64_t seed, double k0, double end,
                           double rate)
{
    const lac_analysis_events params = {.slip_rate = rate, .hold = 0.5};
    measure_slot(what, levels, seed, k0, end, slot_of("events", &params));
}

// The clusters' worst: all cells slip, and at every record one sticks and another begins.
static void measure_worst(int levels, uint64_t seed)
{
    enum { ROUNDS = 100 };
    tree_def def = tree_default(levels, seed);
    tree t;
    tree_create(&def, &t);
    const size_t n = t.domain->n;
    lac_slip_clusters clusters;
    uint8_t *slips = malloc(n);
    uint32_t *changed = malloc(n * sizeof *changed);
    if (slips == NULL || changed == NULL ||
        lac_slip_clusters_create(t.domain, &clusters, NULL) != LAC_OK) {
        exit(1);
    }
    for (size_t i = 0; i < n; i++) {
        slips[i] = 1;
        changed[i] = (uint32_t)i;
    }
    lac_slip_clusters_update(&clusters, slips, n, changed, n);
    double start = cpu_seconds();
    for (size_t k = 0; k < ROUNDS; k++) {
        slips[k] = 1;
        slips[k + 1] = 0; // so that it is seen to cease
        changed[0] = (uint32_t)k;
        changed[1] = (uint32_t)k + 1;
        clusters.credit = 2 * n; // more often than a run would
        lac_slip_clusters_update(&clusters, slips, n - 1, changed, 2);
    }
    printf("clusters built anew at every record, all %zu cells slipping: %.1f ns a cell\n", n,
           1e9 * (cpu_seconds() - start) / ((double)n * ROUNDS));
    lac_slip_clusters_clear(&clusters);
    free(changed);
    free(slips);
    tree_clear(&t);
}

int main(void)
{
    const lac_analysis_rg strength = {.slipping_strength = 0.85, .slipping_rate = NAN};
    const lac_analysis_rg early = {.slipping_strength = 0.99, .slipping_rate = NAN};
    const lac_analysis_rg rate = {.slipping_strength = NAN, .slipping_rate = 1.2e-7};
    const lac_analysis_rg half = {.slipping_strength = NAN, .slipping_rate = 1e-9};
    printf("%-28s %8s %8s %8s %8s %11s %10s %8s\n", "run", "cells", "steps", "CPU s", "its s",
           "share", "ns/cell", "result");
    measure("together, strength 0.85", 6, 14, 1.0, NAN, &strength);
    measure("together, strength 0.99", 6, 14, 1.0, NAN, &early);
    measure("together, 100 times", 6, 14, 1.0, NAN, &rate);
    measure("one by one, strength 0.85", 6, 14, 1e-3, 1e-3, &strength);
    measure("one by one, 100 times", 6, 14, 1e-3, 1e-3, &rate);
    measure("together, strength 0.85", 9, 9, 1.0, NAN, &strength);
    measure("together, strength 0.99", 9, 9, 1.0, NAN, &early);
    measure("together, 100 times", 9, 9, 1.0, NAN, &rate);
    // Half of the cells slip, and some cease at every step: the clusters are built anew each time.
    measure("half, to and fro", 6, 14, 1e-3, 1e-3, &half);
    measure("half, to and fro", 9, 9, 1e-3, 1e-5, &half);
    measure_events("events, together", 6, 14, 1.0, NAN, 1e-3);
    measure_events("events, one by one", 6, 14, 1e-3, 1e-3, 1e-3);
    measure_events("events, most move, to and fro", 6, 14, 1e-3, 1e-3, 1e-8);
    measure_events("events, together", 9, 9, 1.0, NAN, 1e-3);
    measure_events("events, most move, to and fro", 9, 9, 1e-3, 1e-5, 1e-8);
    measure_worst(6, 14);
    measure_worst(9, 9);
    return 0;
}
