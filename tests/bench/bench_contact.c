// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the normal contact solver on the benchmark surface A08 at 10 % contact.
//   bench_contact [LARGEST]      grids from 256 to LARGEST (1024)
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/fft.h"
#include "lacuna/contact.h"
#include "support/benchmark_surface.h"

static double cpu_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Most bytes in memory since the last reset, as Linux counts them; 0 elsewhere
static double peak_bytes(void)
{
    char line[256];
    double kib = 0.0;
    FILE *file = fopen("/proc/self/status", "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        (void)sscanf(line, "VmHWM: %lf", &kib);
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return 1024.0 * kib;
}

static void reset_peak(void)
{
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (file != NULL) {
        (void)fputs("5", file);
        (void)fclose(file);
    }
}

// Seconds of a forward and inverse transform, the best of some.
static double fft_pair(size_t n)
{
    lac_fft *fft = NULL;
    if (lac_fft_create(n, n, &fft, NULL) != LAC_OK) {
        return -1.0;
    }
    double best = 1e300;
    for (size_t trial = 0; trial < 40; trial++) {
        for (size_t i = 0; i < n * n; i++) {
            fft->real[i] = (double)(i % 7);
        }
        double start = cpu_seconds();
        lac_fft_forward(fft);
        lac_fft_inverse(fft);
        double seconds = cpu_seconds() - start;
        best = seconds < best ? seconds : best;
    }
    lac_fft_free(fft);
    return best;
}

static int measure(size_t n)
{
    double *h = malloc(n * n * sizeof *h);
    double *p = malloc(n * n * sizeof *p);
    int failed = 1;
    if (h == NULL || p == NULL || benchmark_surface(n, h) != 0) {
        (void)fprintf(stderr, "bench_contact: out of memory\n");
        goto out;
    }
    lac_contact_def def = lac_contact_default();
    def.grid = (lac_grid){n, n, 1.0 / (double)n, 1.0 / (double)n, true};
    def.heights = h;
    def.e_star = 1.0;
    def.mean_pressure = 4.9e-3;
    lac_contact_report report;
    lac_error err = {""};
    double pair = fft_pair(n);
    double best = 1e300;
    memset(p, 0, n * n * sizeof *p); // in memory from now on
    reset_peak();
    double before = peak_bytes();
    for (int trial = 0; trial < 3; trial++) {
        double start = cpu_seconds();
        if (lac_contact_solve(&def, p, NULL, &report, &err) != LAC_OK) {
            (void)fprintf(stderr, "bench_contact: %s\n", err.message);
            goto out;
        }
        double seconds = cpu_seconds() - start;
        best = seconds < best ? seconds : best;
    }
    // and the heights and pressures, which were there before
    double arrays = (peak_bytes() - before) / (double)(n * n * sizeof *h) + 2.0;
    double again = fft_pair(n);
    pair = again < pair ? again : pair;
    printf("%5zu^2 %8.5f %6lld %9lld %10.4f %9.3f %7.2f %7.1f\n", n,
           (double)report.n_cells / (double)(n * n), (long long)report.iterations,
           (long long)report.products, best, 1e3 * pair, best / ((double)report.products * pair),
           arrays);
    failed = 0;
out:
    free(h);
    free(p);
    return failed;
}

int main(int argc, char **argv)
{
    size_t largest = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 1024;
    omp_set_num_threads(1);
    printf("   grid  contact  iter.  products   CPU [s]  pair [ms]   ratio  arrays\n");
    for (size_t n = 256; n <= largest; n *= 2) {
        if (measure(n) != 0) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
