// SPDX-License-Identifier: GPL-3.0-or-later
// Creep to failure of some 240 000 strongly coupled cells (k_0 = 400 p (b - a)/dc), from 1e-9 m/s
// to the first cell at 0.5 m/s by bdf at rtol 1e-5: beside what the hardware allows and beside the
// same physics on SUNDIALS as installed; what a right-hand side and a Newton solve cost a cell;
// what a second thread brings at a million cells; memory. docs/speed.md says how it is counted.
//   bench_creep [FILE.csv COMMIT MACHINE [MOST_SECONDS]]   the stock run ends after so many seconds
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "lacuna/simulation.h"

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
        (void)fprintf(csv, "\"%s\",%.6g,%s,%s\n", what, value, unit, bar);
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
    double slip = 1 + 1 + 2 + 8 + 2;       // v, its difference to the prediction; weights, its norm
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

// CPU time of each thread so far.
static void thread_seconds(double at[2])
{
    at[0] = at[1] = 0;
#pragma omp parallel
    {
        struct timespec now;
        int k = omp_get_thread_num();
        (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
        if (k < 2) {
            at[k] = (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
        }
    }
}

// What a call took, at its best [ns a cell].
typedef struct cost {
    double wall, busiest; // busiest: CPU time of the thread that had most to do
} cost;

// One evaluation, or one Newton solve, the shortest of some.
static cost measure_call(const tree *t, bool newton, int threads)
{
    enum { TIMES = 25 };
    size_t n = t->domain->n;
    double *y = array(2 * n), *out = array(2 * n), *work = calloc(lac_problem_work(t->problem), 8);
    cost best = {INFINITY, INFINITY};
    omp_set_num_threads(threads);
    lac_problem_initial(t->problem, y);
    for (int k = 0; k < TIMES; k++) {
        for (size_t i = 0; newton && i < 2 * n; i++) {
            out[i] = 1e-3;
        }
        double before[2], after[2], wall = wall_seconds();
        thread_seconds(before);
        bool good = newton ? lac_problem_newton(t->problem, 0, y, 1.0, out, work)
                           : lac_problem_derivative(t->problem, 0, y, out, work);
        thread_seconds(after);
        if (!good) {
            (void)fprintf(stderr, "bench_creep: a call failed\n");
            exit(1);
        }
        best.wall = fmin(best.wall, 1e9 * (wall_seconds() - wall) / (double)n);
        double most = fmax(after[0] - before[0], after[1] - before[1]);
        best.busiest = fmin(best.busiest, 1e9 * most / (double)n);
    }
    omp_set_num_threads(1);
    free(y), free(out), free(work);
    return best;
}

typedef struct outcome {
    lac_run_result result;
    double cpu, wall;
} outcome;

static outcome run_ours(const tree *t)
{
    outcome out;
    double cpu = cpu_seconds(), wall = wall_seconds();
    must_run(t, &out.result);
    out.cpu = cpu_seconds() - cpu;
    out.wall = wall_seconds() - wall;
    return out;
}

static void report_ours(const outcome *ours, size_t n, const hardware *h, FILE *csv)
{
    const lac_run_result *r = &ours->result;
    double rhs = (double)r->rhs_evaluations / (double)r->steps;
    double solves = (double)r->linear_solves / (double)r->steps;
    double step = ours->cpu / (double)r->steps;
    put(csv, "steps", (double)r->steps, "1", "");
    put(csv, "evaluations a step", rhs, "1", "");
    put(csv, "Newton solves a step", solves, "1", "");
    put(csv, "time of failure", r->time, "s", "");
    put(csv, "CPU", ours->cpu, "s", "");
    put(csv, "wall", ours->wall, "s", "");
    put(csv, "CPU a cell and step", 1e9 * step / (double)n, "ns", "");
    double bytes = 8 * (double)n * doubles_a_step(4, rhs, solves);
    // an evaluation: v and 1/theta; a solve the same; slip, and the look at the rates: v
    double exps = (double)n * (2 * rhs + 2 * solves + 2);
    double floor = bytes / h->bandwidth + exps / h->exp_rate;
    put(csv, "bytes a step over bandwidth", 1e3 * bytes / h->bandwidth, "ms", "");
    put(csv, "exponentials a step over their rate", 1e3 * exps / h->exp_rate, "ms", "");
    put(csv, "CPU a step", 1e3 * step, "ms", "");
    put(csv, "CPU a step over the floor", step / floor, "1", "<= 1.5");
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
    static const char *const what[2][2] = {
        {"evaluation, two threads over one: wall", "Newton solve, two threads over one: wall"},
        {"evaluation, two threads over one: busiest thread",
         "Newton solve, two threads over one: busiest thread"}};
    for (int newton = 0; newton < 2; newton++) {
        cost one = measure_call(&t, newton != 0, 1), two = measure_call(&t, newton != 0, 2);
        put(csv, what[0][newton], one.wall / two.wall, "1", ">= 1.6");
        put(csv, what[1][newton], one.busiest / two.busiest, "1", "");
    }
    tree_clear(&t);
}

int main(int argc, char **argv)
{
    FILE *csv = argc > 1 ? fopen(argv[1], "w") : NULL;
    double most = argc > 4 ? atof(argv[4]) : 1e4;
    tree_def def = tree_default(10, 82);
    tree t;
    if (csv != NULL) {
        (void)fprintf(csv, "what,value,unit,bar\ncommit,%s,,\nmachine,\"%s\",,\n",
                      argc > 2 ? argv[2] : "unknown", argc > 3 ? argv[3] : "unknown");
    }
    omp_set_num_threads(1);
    reset_peak();
    double before = peak_bytes();
    tree_create(&def, &t);
    size_t n = t.domain->n;
    outcome ours = run_ours(&t);
    put(csv, "cells", (double)n, "1", "");
    put(csv, "memory in all a cell", (peak_bytes() - before) / (double)n, "bytes", "<= 400");
    hardware h = measure_hardware(n);
    put(csv, "triad", 1e-9 * h.bandwidth, "GB/s", "");
    put(csv, "exponentials", 1e-9 * h.exp_rate, "1/ns", "");
    // a Newton solve: y, parameters, right-hand side, D, v, K v, the tree, as passes over arrays
    double same_bytes = 1e9 * 8 * 34 / h.bandwidth;
    double solve = measure_call(&t, true, 1).busiest;
    put(csv, "evaluation", measure_call(&t, false, 1).busiest, "ns a cell", "<= 12");
    put(csv, "Newton solve", solve, "ns a cell", "<= 20");
    put(csv, "Newton solve over a triad of as many bytes", solve / same_bytes, "1", "");
    report_ours(&ours, n, &h, csv);
    run_threads(csv);
    run_stock(&t, &def, ours.cpu, most, csv);
    tree_clear(&t);
    if (csv != NULL) {
        (void)fclose(csv);
    }
    return 0;
}
