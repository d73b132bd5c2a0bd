// SPDX-License-Identifier: GPL-3.0-or-later
// Creep to failure of some 240 000 strongly coupled cells (k_0 = 400 p (b - a)/dc), from 1e-9 m/s
// to the first cell at 0.5 m/s by bdf at rtol 1e-5: beside what the hardware allows and beside the
// same physics on SUNDIALS as installed; what a right-hand side and a Newton solve cost a cell;
// what a second thread brings at a million cells; memory. docs/speed.md says how it is counted.
//   bench_creep [FILE.csv [COMMIT [MOST_SECONDS]]]   the stock run ends after so many seconds
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vmath.h"
#include "stock_creep.h"
#include "support/cost.h"

static const double rtol = 1e-5, stop_rate = 0.5;

typedef struct hardware {
    double bandwidth; // of a triad over more than the caches hold [B/s]
    double exp_rate;  // [1/s], in the cache
} hardware;

static void *array(size_t n)
{
    double *x = malloc(n * sizeof *x);
    if (x == NULL) {
        (void)fprintf(stderr, "bench_creep: memory\n");
        exit(1);
    }
    for (size_t i = 0; i < n; i++) {
        x[i] = 1e-3 * (double)(i % 1000);
    }
    return x;
}

static hardware measure_hardware(size_t cells)
{
    enum { TIMES = 10, EXPS = 1024 };
    const size_t n = 10 * cells; // as much as the integrator's vectors
    double *x = array(n), *y = array(n), *z = array(n);
    hardware h = {0};
    for (int k = 0; k < TIMES; k++) {
        double begin = cpu_seconds();
        for (size_t i = 0; i < n; i++) {
            z[i] = x[i] + 0.5 * y[i];
        }
        h.bandwidth = fmax(h.bandwidth, 24.0 * (double)n / (cpu_seconds() - begin));
        x[k] = z[n - 1 - (size_t)k];
    }
    for (int k = 0; k < TIMES; k++) {
        double begin = cpu_seconds();
        for (int again = 0; again < 200; again++) {
            lac_vexp(EXPS, x, y);
        }
        h.exp_rate = fmax(h.exp_rate, 200.0 * EXPS / (cpu_seconds() - begin));
    }
    free(x), free(y), free(z);
    return h;
}

// One line of the table and of the file.
static void put(FILE *csv, const char *what, double value, const char *unit, const char *bar)
{
    (void)printf("%-52s %12.4g %-10s %s\n", what, value, unit, bar);
    (void)fflush(stdout);
    if (csv != NULL) {
        (void)fprintf(csv, "%s,%.6g,%s,%s\n", what, value, unit, bar);
    }
}

// Doubles a cell that a step of BDF reads or writes, each pass over an array once, blocks of the
// tree not counted: what is left if every operation that CVODE asks for is one pass and nothing
// stays in a cache between two. q: order; the two unknowns count 2, slip beside them 1.
static double doubles_a_step(double q, double rhs, double solves)
{
    double predict = 3 * (2 * q + 1);      // reads z_0 ... z_q, writes z_0 ... z_q-1
    double complete = 3 * (2 * q + 2 + 1); // reads and writes z_0 ... z_q, reads the correction
    double weights = 2 + 2;                // reads y, writes
    double norms = 2 * (2 + 2) + 2;        // correction and error by weights, saved correction
    double evaluation = 2 + 5 + 1 + 2 + 2; // y, parameters, v, K v written and read, ydot
    double correct = 2 + 2 + 2 + 2 + 2;    // residual of the iteration: z_1, ydot, sum, y
    double solve = 2 + 5 + 4 + 3 + 4 + 2;  // y, parameters, right-hand side, D, v, K v; tree; back
    double slip = 1 + 1 + 2;               // v, its difference to the prediction
    return predict + complete + weights + norms + rhs * (evaluation + correct) + solves * solve +
           slip;
}

static void must_run(const tree *t, lac_run_result *result)
{
    lac_error err = {""};
    lac_run_def how = lac_run_default();
    how.rtol = rtol;
    how.end = 1e10;
    how.failure_rate = 1e3;
    how.stop_rate = stop_rate;
    how.record = (lac_cadence){.time = NAN, .steps = 0, .per_decade = NAN};
    if (lac_run(t->problem, &how, NULL, result, &err) != LAC_OK || result->end != LAC_END_STOP) {
        (void)fprintf(stderr, "bench_creep: no failure %s\n", err.message);
        exit(1);
    }
}

// Shortest time of one evaluation, or of one Newton solve, over some [ns a cell].
static double fastest_call(const tree *t, bool newton, double (*clock)(void))
{
    enum { TIMES = 15 };
    size_t n = t->domain->n;
    double *y = array(2 * n), *out = array(2 * n), *work = calloc(lac_problem_work(t->problem), 8);
    double best = INFINITY;
    lac_problem_initial(t->problem, y);
    for (int k = 0; k < TIMES; k++) {
        for (size_t i = 0; newton && i < 2 * n; i++) {
            out[i] = 1e-3;
        }
        double begin = clock();
        bool good = newton ? lac_problem_newton(t->problem, 0, y, 1.0, out, work)
                           : lac_problem_derivative(t->problem, 0, y, out, work);
        double taken = clock() - begin;
        if (!good) {
            (void)fprintf(stderr, "bench_creep: a call failed\n");
            exit(1);
        }
        best = fmin(best, taken);
    }
    free(y), free(out), free(work);
    return 1e9 * best / (double)n;
}

static double run_ours(const tree *t, const hardware *h, FILE *csv)
{
    lac_run_result r;
    size_t n = t->domain->n;
    reset_peak();
    double before = peak_bytes(), cpu = cpu_seconds(), wall = wall_seconds();
    must_run(t, &r);
    cpu = cpu_seconds() - cpu;
    wall = wall_seconds() - wall;
    double rhs = (double)r.rhs_evaluations / (double)r.steps;
    double solves = (double)r.linear_solves / (double)r.steps;
    put(csv, "steps", (double)r.steps, "1", "");
    put(csv, "evaluations a step", rhs, "1", "");
    put(csv, "Newton solves a step", solves, "1", "");
    put(csv, "time of failure", r.time, "s", "");
    put(csv, "CPU", cpu, "s", "");
    put(csv, "wall", wall, "s", "");
    put(csv, "CPU a cell and step", 1e9 * cpu / (double)n / (double)r.steps, "ns", "");
    double bytes = 8 * (double)n * doubles_a_step(4, rhs, solves);
    // an evaluation: v and 1/theta; a solve the same; slip, and the look at the rates: v
    double exps = (double)n * (2 * rhs + 2 * solves + 2);
    double floor = bytes / h->bandwidth + exps / h->exp_rate;
    put(csv, "bytes a step over bandwidth", 1e3 * bytes / h->bandwidth, "ms", "");
    put(csv, "exponentials a step over their rate", 1e3 * exps / h->exp_rate, "ms", "");
    put(csv, "CPU a step", 1e3 * cpu / (double)r.steps, "ms", "");
    put(csv, "CPU a step over the floor", cpu / (double)r.steps / floor, "1", "<= 3");
    put(csv, "memory of the run a cell", (peak_bytes() - before) / (double)n, "bytes", "");
    return cpu;
}

static void run_stock(const tree *t, const tree_def *def, double ours, double most, FILE *csv)
{
    stock_outcome s = stock_creep(t, def, rtol, stop_rate, most);
    put(csv, "stock: CPU", s.cpu, "s", s.done ? "to failure" : "stopped before failure");
    put(csv, "stock: steps", (double)s.steps, "1", "");
    put(csv, "stock: evaluations", (double)s.rhs, "1", "");
    put(csv, "stock: iterations of GMRES", (double)s.linear_iterations, "1", "");
    put(csv, "stock: time reached", s.time, "s", "");
    put(csv, s.done ? "stock CPU over ours" : "stock CPU over ours, at least", s.cpu / ours, "1",
        ">= 8");
}

static void run_threads(FILE *csv)
{
    tree_def def = tree_default(11, 3);
    def.keep = 0.88; // a million
    tree t;
    tree_create(&def, &t);
    put(csv, "cells of the threads' scene", (double)t.domain->n, "1", "");
    for (int newton = 0; newton < 2; newton++) {
        omp_set_num_threads(1);
        double one = fastest_call(&t, newton != 0, wall_seconds);
        omp_set_num_threads(2);
        double two = fastest_call(&t, newton != 0, wall_seconds);
        put(csv,
            newton != 0 ? "Newton solve, two threads over one" : "evaluation, two threads over one",
            one / two, "1", ">= 1.6");
    }
    omp_set_num_threads(1);
    tree_clear(&t);
}

int main(int argc, char **argv)
{
    FILE *csv = argc > 1 ? fopen(argv[1], "w") : NULL;
    double most = argc > 3 ? atof(argv[3]) : 1e4;
    tree_def def = tree_default(10, 82);
    tree t;
    if (csv != NULL) {
        (void)fprintf(csv, "what,value,unit,bar\ncommit,%s,,\n", argc > 2 ? argv[2] : "unknown");
    }
    reset_peak();
    double before = peak_bytes();
    tree_create(&def, &t);
    size_t n = t.domain->n;
    hardware h = measure_hardware(n);
    put(csv, "cells", (double)n, "1", "");
    put(csv, "triad", 1e-9 * h.bandwidth, "GB/s", "");
    put(csv, "exponentials", 1e-9 * h.exp_rate, "1/ns", "");
    put(csv, "evaluation", fastest_call(&t, false, cpu_seconds), "ns a cell", "<= 12");
    put(csv, "Newton solve", fastest_call(&t, true, cpu_seconds), "ns a cell", "<= 20");
    double ours = run_ours(&t, &h, csv);
    put(csv, "memory in all a cell", (peak_bytes() - before) / (double)n, "bytes", "<= 400");
    run_threads(csv);
    run_stock(&t, &def, ours, most, csv);
    tree_clear(&t);
    if (csv != NULL) {
        (void)fclose(csv);
    }
    return 0;
}
