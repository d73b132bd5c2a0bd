// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the normal contact solver on the benchmark surface A08 at 10 % contact: grids, periodic
// and free; threads; a sequence of loads.
//   bench_contact [LARGEST [SMALLEST]]   grids from SMALLEST (256) to LARGEST (1024; 4096 takes
//                                        2 GB); from 4096 on one solution each
#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/fft.h"
#include "contact/contact.h"
#include "support/benchmark_surface.h"
#include "support/cost.h"

static double seconds_of_pair(lac_fft *fft)
{
    for (size_t i = 0; i < fft->nx * fft->ny; i++) {
        fft->real[i] = (double)(i % 7);
    }
    double start = cpu_seconds();
    lac_fft_forward(fft);
    lac_fft_inverse(fft);
    return cpu_seconds() - start;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double *x, size_t n)
{
    qsort(x, n, sizeof *x, ascending);
    return x[n / 2];
}

// Seconds of a forward and inverse transform; negative where there is no memory.
static double fft_pair(size_t n)
{
    enum { TRIALS = 11 };
    double seconds[TRIALS];
    lac_fft *fft = NULL;
    if (lac_fft_create(n, n, &fft, NULL) != LAC_OK) {
        return -1.0;
    }
    (void)seconds_of_pair(fft);
    for (size_t trial = 0; trial < TRIALS; trial++) {
        seconds[trial] = seconds_of_pair(fft);
    }
    lac_fft_free(fft);
    return median(seconds, TRIALS);
}

// A surface and its pressures
typedef struct joint {
    size_t n;
    double *h, *p;
    lac_contact_def def;
    lac_contact_stats report;
} joint;

static void joint_free(joint *b)
{
    free(b->h);
    free(b->p);
}

static int joint_create(size_t n, bool periodic, joint *b)
{
    *b = (joint){.n = n, .def = lac_contact_default()};
    b->h = malloc(n * n * sizeof *b->h);
    b->p = malloc(n * n * sizeof *b->p);
    if (b->h == NULL || b->p == NULL || benchmark_surface(n, b->h) != 0) {
        (void)fprintf(stderr, "bench_contact: out of memory\n");
        joint_free(b);
        return 1;
    }
    memset(b->p, 0, n * n * sizeof *b->p); // in memory from now on
    b->def.grid = (lac_grid){n, n, 1.0 / (double)n, 1.0 / (double)n, periodic};
    b->def.heights = b->h;
    b->def.e_star = 1.0;
    b->def.mean_pressure = 4.9e-3;
    return 0;
}

// CPU and wall seconds of one solution.
static int solve(joint *b, double *cpu, double *wall)
{
    lac_error err = {""};
    double start = cpu_seconds();
    double wall_start = omp_get_wtime();
    if (lac_contact_solve(&b->def, b->p, NULL, &b->report, &err) != LAC_OK) {
        (void)fprintf(stderr, "bench_contact: %s\n", err.message);
        return 1;
    }
    *wall = omp_get_wtime() - wall_start;
    *cpu = cpu_seconds() - start;
    return 0;
}

// Machines are noisy: each solution is set against pairs right before and after it, and the
// median of these ratios counts.
static int measure(size_t n, bool periodic, int trials)
{
    enum { MOST = 5 };
    double ratio[MOST];
    double seconds[MOST];
    double pairs[MOST];
    joint b;
    double wall;
    if (joint_create(n, periodic, &b) != 0) {
        return 1;
    }
    size_t m = periodic ? n : 2 * n; // the transform of an operator product
    reset_peak();
    double before = peak_bytes();
    int failed = solve(&b, &seconds[0], &wall);
    // and the heights and pressures, which were there before
    double arrays = (peak_bytes() - before) / (double)(n * n * sizeof *b.h) + 2.0;
    double peak = peak_bytes();
    double pair = fft_pair(m);
    for (int k = 0; k < trials && !failed; k++) {
        failed = solve(&b, &seconds[k], &wall);
        double after = fft_pair(m);
        pairs[k] = 0.5 * (pair + after);
        ratio[k] = seconds[k] / ((double)b.report.products * pairs[k]);
        pair = after;
    }
    if (!failed) {
        size_t k = (size_t)trials;
        printf("%5zu^2 %-8s %8.5f %6lld %9lld %10.4f %9.3f %7.2f %6.1f %7.1f %9.1f\n", n,
               periodic ? "periodic" : "free", (double)b.report.n_cells / (double)(n * n),
               (long long)b.report.iterations, (long long)b.report.products, median(seconds, k),
               1e3 * median(pairs, k), median(ratio, k),
               (double)b.report.products * median(ratio, k), arrays, 1e-6 * peak);
    }
    joint_free(&b);
    return failed;
}

// One against two threads, in wall time, in turn.
static int measure_threads(size_t n)
{
    enum { TRIALS = 3 };
    double one[TRIALS];
    double two[TRIALS];
    double cpu;
    joint b;
    if (joint_create(n, true, &b) != 0) {
        return 1;
    }
    int failed = 0;
    for (int k = 0; k < TRIALS && !failed; k++) {
        omp_set_num_threads(1);
        failed = solve(&b, &cpu, &one[k]);
        omp_set_num_threads(2);
        failed = failed || solve(&b, &cpu, &two[k]);
    }
    omp_set_num_threads(1);
    if (!failed) {
        double least = median(one, TRIALS);
        double other = median(two, TRIALS);
        printf("%5zu^2 wall [s]: 1 thread %.4f, 2 threads %.4f (x %.2f)\n", n, least, other,
               least / other);
    }
    joint_free(&b);
    return failed;
}

// 24 loads up and down in steps of 10 %, each from the solution before.
static int measure_sequence(size_t n)
{
    joint b;
    double cpu;
    double wall;
    double total = 0.0;
    int64_t iterations = 0;
    if (joint_create(n, true, &b) != 0) {
        return 1;
    }
    int failed = 0;
    for (int k = 0; k < 24 && !failed; k++) {
        b.def.mean_pressure = 2.5e-3 * pow(1.1, k < 12 ? k : 23 - k);
        failed = solve(&b, &cpu, &wall);
        b.def.start = b.p;
        total += cpu;
        iterations += b.report.iterations;
    }
    if (!failed) {
        printf("%5zu^2 24 loads from 2.5e-3 to 7.1e-3 E* and back, warm: %lld iterations, CPU %.2f "
               "s\n",
               n, (long long)iterations, total);
    }
    joint_free(&b);
    return failed;
}

int main(int argc, char **argv)
{
    size_t largest = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 1024;
    size_t smallest = argc > 2 ? (size_t)strtoul(argv[2], NULL, 10) : 256;
    bool failed = false;
    (void)setvbuf(stdout, NULL, _IOLBF, 0);
    omp_set_num_threads(1);
    printf("products: two an iteration (S p and t.St) and the first; the |q| of each iteration is "
           "not counted.\npairs: CPU over pair. pair: transforms of the grid; free: of twice its "
           "sides. arrays: of "
           "doubles, heights and pressures too.\n");
    printf(
        "   grid boundary  contact  iter.  products   CPU [s]  pair [ms]   ratio  pairs  arrays  "
        "peak [MB]\n");
    for (size_t n = smallest; n <= largest && !failed; n *= 2) {
        failed = measure(n, true, n > 2048 ? 1 : 5) != 0;
        failed = failed || measure(n, false, n > 1024 ? 1 : 3) != 0;
    }
    for (size_t n = smallest / 2; n <= 1024 && n <= largest && !failed; n *= 2) {
        failed = measure_threads(n) != 0;
    }
    failed = failed || (largest >= 1024 && smallest <= 1024 && measure_sequence(1024) != 0);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
