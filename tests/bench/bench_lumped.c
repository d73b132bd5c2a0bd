// SPDX-License-Identifier: GPL-3.0-or-later
// Lumped runs beside those of all cells, each pair in one process: vajont.yaml, and the scene of
// bench_creep. Errors are against all cells at rtol 1e-9; CPU is of the integration, over that of
// all cells at rtol 1e-6; with what the estimate of the error takes; and of the whole run.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "simulation/lumped.h"
#include "support/cost.h"
#include "support/tree.h"

typedef struct outcome {
    double value, cpu;
    long long steps;
} outcome;

static void stop(const char *what, const lac_error *err)
{
    fprintf(stderr, "bench_lumped: %s: %s\n", what, err->message);
    exit(1);
}

static outcome integrate(const lac_problem *problem, const lac_run_def *like, double rtol)
{
    lac_run_def def = *like;
    lac_run_result result;
    lac_error err = {""};
    outcome out = {.cpu = 0.0};
    def.rtol = rtol;
    def.fidelity = LAC_FIDELITY_ODE;
    const double start = cpu_seconds();
    if (lac_run(problem, &def, NULL, &result, &err) != LAC_OK) {
        stop("run", &err);
    }
    out.cpu = cpu_seconds() - start;
    out.value = result.failed ? result.failure_origin + result.failure_local : result.time;
    out.steps = (long long)result.steps;
    return out;
}

// CPU that the estimate of the error takes within the making of a lump [s].
static double judge(const lac_lump_source *source, const lac_lump *lump)
{
    lac_lump_way way = {0};
    lac_error err = {""};
    double least = INFINITY, value;
    for (int k = 0; k < 3; k++) {
        const double start = cpu_seconds();
        if (lac_lump_walk(source->problem, source->ends, true, &way, &value, &err) != LAC_OK ||
            lac_lump_walk(lump->problem, source->ends, false, &way, &value, &err) != LAC_OK) {
            stop("estimate", &err);
        }
        least = fmin(least, cpu_seconds() - start);
    }
    free(way.stage);
    return least;
}

// @param build  CPU that it takes to build the scene, but for the lump [s]
static void compare(const char *name, const lac_lump_source *source, const lac_run_def *def,
                    double build)
{
    static const struct {
        double error, rtol;
    } tries[] = {{0.01, 1e-6}, {0.001, 1e-6}, {0.01, 1e-5}};
    const outcome exact = integrate(source->problem, def, 1e-9);
    const outcome all = integrate(source->problem, def, 1e-6);
    const size_t n = source->whole.domain->n;
    printf("%-8s %-7s %9s %8zu %7lld %10.1e %10s %9.4f\n", name, "ode", "-", n, all.steps,
           fabs(all.value / exact.value - 1), "-", all.cpu);
    for (size_t i = 0; i < sizeof tries / sizeof *tries; i++) {
        const lac_lump_def how = {.level = -1, .nodes = -1, .error = tries[i].error};
        lac_lump *lump = NULL;
        lac_error err = {""};
        const double start = cpu_seconds();
        if (lac_lump_create(source, &how, &lump, &err) != LAC_OK) {
            stop("lump", &err);
        }
        const double made = cpu_seconds() - start;
        outcome few = integrate(lump->problem, def, tries[i].rtol);
        for (int k = 0; k < 4; k++) { // a machine has other things to do: the least counts
            const outcome again = integrate(lump->problem, def, tries[i].rtol);
            few.cpu = fmin(few.cpu, again.cpu);
        }
        const double judged = judge(source, lump);
        printf("%-8s %-7s %9g %8zu %7lld %10.1e %10.1e %9.4f  1/%.0f of ode, 1/%.0f with the "
               "estimate (%.4f of %.4f to make it); whole run 1/%.1f\n",
               name, "lumped", tries[i].error, lump->domain->n, few.steps,
               fabs(few.value / exact.value - 1), lump->error, few.cpu, all.cpu / few.cpu,
               all.cpu / (few.cpu + judged), judged, made,
               (build + all.cpu) / (build + made + few.cpu));
        lac_lump_free(lump);
    }
}

static void run_vajont(void)
{
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_scene *scene = NULL;
    lac_error err = {""};
    const double start = cpu_seconds();
    if (lac_case_read(LACUNA_SOURCE_DIR "/cases/vajont.yaml", NULL, &c, &report, &err) != LAC_OK ||
        lac_scene_create(c, NULL, &scene, &err) != LAC_OK) {
        stop("vajont.yaml", &err);
    }
    const double build = cpu_seconds() - start;
    lac_run_def def = lac_run_default();
    def.end = c->run.end;
    def.failure_rate = c->run.failure_rate;
    lac_lump_source source = lac_scene_lump_source(scene);
    source.ends = &def;
    compare("vajont", &source, &def, build);
    lac_scene_free(scene);
    lac_case_issues_clear(&report);
    lac_case_free(c);
}

static void run_creep(void)
{
    tree_def of = tree_default(10, 82);
    tree t;
    const double start = cpu_seconds();
    tree_create(&of, &t);
    const double build = cpu_seconds() - start;
    const size_t n = t.domain->n;
    double *y = malloc(lac_problem_unknowns(t.problem) * sizeof *y);
    if (y == NULL) {
        exit(1);
    }
    lac_problem_initial(t.problem, y);
    lac_run_def def = lac_run_default();
    const lac_lump_source source = {.whole = {.domain = t.domain,
                                              .friction = t.friction,
                                              .transfer = &t.transfer,
                                              .loads = of.loads,
                                              .damping = of.damping,
                                              .log_rate = y,
                                              .log_state = y + n},
                                    .problem = t.problem,
                                    .blocks = t.hierarchy,
                                    .ends = &def};
    def.end = 1e12;
    def.failure_rate = 1e3;
    def.stop_rate = 0.5;
    compare("creep", &source, &def, build);
    free(y);
    tree_clear(&t);
}

int main(void)
{
    printf("scene    run         error    cells   steps  off by   estimated   CPU [s]\n");
    run_vajont();
    run_creep();
    return 0;
}
