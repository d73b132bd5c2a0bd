// SPDX-License-Identifier: GPL-3.0-or-later
// Formulations and methods side by side: what a run costs and how far off the time of its failure,
// or of its events, is. Three scenes: a spring slider over five events (cases/peers), 1 261
// strongly coupled cells that creep to failure, and cases/vajont.yaml. Runs from the root of the
// sources.
//   bench_formulations [slider|tree|vajont] ...     all if none is named
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/simulation.h"

#include "scene/scene.h"
#include "support/cost.h"
#include "support/slider.h"
#include "support/tree.h"

static const char *const method_names[] = {"bdf", "adams", "erk"};
static const char *const names[] = {"auto", "rate", "traction", "slip"};

// One scene: how to make its problem, how to run it, what to compare.
typedef struct bench_scene {
    const char *name;
    lac_problem_def problem;
    lac_run_def how;
    int64_t most_steps;
    bool events; // compare the last of five events, else the end of the run
    double want; // [s]
} bench_scene;

static void must(bool good, const char *what)
{
    if (!good) {
        (void)fprintf(stderr, "bench_formulations: %s\n", what);
        exit(1);
    }
}

// One run. @return time compared [s]; NaN where the steps were not enough
static double run_once(const bench_scene *scene, lac_formulation formulation, lac_method method,
                       double rtol, lac_run_result *result)
{
    lac_error err = {""};
    lac_problem *problem;
    lac_problem_def def = scene->problem;
    lac_run_def how = scene->how;
    slider_events events = {0};
    lac_sink sink = slider_events_sink(&events);
    def.formulation = formulation;
    how.method = method;
    how.rtol = rtol;
    how.max_steps = scene->most_steps;
    must(lac_problem_create(&def, &problem, &err) == LAC_OK, err.message);
    lac_status status = lac_run(problem, &how, &sink, result, &err);
    lac_problem_free(problem);
    if (status != LAC_OK) {
        return NAN;
    }
    return scene->events ? (events.n == 5 ? events.time[4] : NAN) : result->time;
}

static void table(const bench_scene *scene)
{
    (void)printf("\n%s\nformulation method   rtol    steps       rhs      error   residual  "
                 "fastest m/s   CPU s\n",
                 scene->name);
    for (int f = LAC_FORMULATION_RATE; f <= LAC_FORMULATION_SLIP; f++) {
        for (int m = LAC_BDF; m <= LAC_ERK; m++) {
            for (int k = 3; k <= 10; k++) {
                lac_run_result result;
                double start = cpu_seconds();
                double rtol = pow(10.0, -k);
                double time = run_once(scene, (lac_formulation)f, (lac_method)m, rtol, &result);
                (void)printf("%-11s %-6s %6.0e %8lld %9lld %10.1e %10.1e %12.6g %7.2f%s\n",
                             names[f], method_names[m], rtol, (long long)result.steps,
                             (long long)result.rhs_evaluations, time / scene->want - 1.0,
                             result.balance_residual, result.max_slip_rate, cpu_seconds() - start,
                             isnan(time) ? "  too many steps, or wrong" : "");
                fflush(stdout);
                if (isnan(time) && result.steps >= scene->most_steps) {
                    break; // tighter ones take as many
                }
            }
        }
    }
}

static void bench_slider(void)
{
    slider s;
    slider_create(LAC_FORMULATION_RATE, &s);
    bench_scene scene = {.name = "spring slider (A1), fifth event",
                         .problem = s.problem_def,
                         .how = slider_run(),
                         .most_steps = 40000,
                         .events = true,
                         .want = slider_event_times[4]};
    table(&scene);
    slider_clear(&s);
}

// The reference is a tight run, checked by another formulation's.
static void find_reference(bench_scene *scene)
{
    lac_run_result result;
    scene->want = run_once(scene, LAC_FORMULATION_RATE, LAC_BDF, 1e-12, &result);
    double other = run_once(scene, LAC_FORMULATION_SLIP, LAC_BDF, 1e-11, &result);
    (void)printf("\nreference %.15g s (rate, bdf, rtol 1e-12); slip, bdf, 1e-11 is off by %.1e\n",
                 scene->want, other / scene->want - 1.0);
}

static void bench_tree(void)
{
    tree_def def = tree_default(6, 14);
    def.state *= 3.0; // above steady state everywhere: the whole runs away
    tree t;
    tree_create(&def, &t);
    size_t n = t.domain->n;
    double *start = malloc(2 * n * sizeof *start);
    must(start != NULL, "memory");
    lac_problem_initial(t.problem, start);
    bench_scene scene = {.name = "1 261 strongly coupled cells, creep to failure",
                         .problem = {.domain = t.domain,
                                     .friction = t.friction,
                                     .transfer = &t.transfer,
                                     .damping = def.damping,
                                     .log_rate = start,
                                     .log_state = start + n},
                         .how = lac_run_default(),
                         .most_steps = 40000};
    scene.how.end = 1e10;
    scene.how.failure_rate = 1e3;
    scene.how.stop_rate = 0.5;
    find_reference(&scene);
    table(&scene);
    free(start);
    tree_clear(&t);
}

static void bench_vajont(void)
{
    lac_error err = {""};
    lac_case *c;
    lac_case_issues report = {0};
    lac_scene *s;
    must(lac_case_read("cases/vajont.yaml", NULL, &c, &report, &err) == LAC_OK, err.message);
    c->formulation = LAC_FORMULATION_RATE;
    must(lac_scene_create(c, NULL, &s, &err) == LAC_OK, err.message);
    size_t n = s->contact.domain->n;
    double *start = malloc(2 * n * sizeof *start);
    must(start != NULL, "memory");
    lac_problem_initial(s->problem, start);
    bench_scene scene = {.name = "cases/vajont.yaml, failure",
                         .problem = {.domain = s->contact.domain,
                                     .friction = s->friction,
                                     .transfer = &s->transfer,
                                     .loads = s->loads,
                                     .damping = s->damping,
                                     .log_rate = start,
                                     .log_state = start + n},
                         .how = c->run,
                         .most_steps = 20000};
    scene.how.snapshots = false;
    (void)printf("\n%zu cells\n", n);
    find_reference(&scene);
    table(&scene);
    free(start);
    lac_scene_free(s);
    lac_case_issues_clear(&report);
    lac_case_free(c);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*run)(void);
    } scenes[] = {{"slider", bench_slider}, {"tree", bench_tree}, {"vajont", bench_vajont}};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        bool wanted = argc < 2;
        for (int k = 1; k < argc; k++) {
            wanted = wanted || strcmp(argv[k], scenes[i].name) == 0;
        }
        if (wanted) {
            scenes[i].run();
        }
    }
    return 0;
}
