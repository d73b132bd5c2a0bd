// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the normal contact solver on the benchmark surface A08 at 10 % contact.
//   bench_contact [LARGEST]      grids from 256 to LARGEST (1024)
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/fft.h"
#include "lacuna/contact.h"
#include "support/benchmark_surface.h"

static double cpu_seconds(void) { return (double)clock() / (double)CLOCKS_PER_SEC; }

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
    double best = 1e300;
    for (int trial = 0; trial < 3; trial++) {
        double start = cpu_seconds();
        if (lac_contact_solve(&def, p, NULL, &report, &err) != LAC_OK) {
            (void)fprintf(stderr, "bench_contact: %s\n", err.message);
            goto out;
        }
        double seconds = cpu_seconds() - start;
        best = seconds < best ? seconds : best;
    }
    double pair = fft_pair(n);
    printf("%5zu^2 %8.5f %6lld %9lld %10.4f %9.3f %7.2f\n", n,
           (double)report.n_cells / (double)(n * n), (long long)report.iterations,
           (long long)report.products, best, 1e3 * pair, best / ((double)report.products * pair));
    failed = 0;
out:
    free(h);
    free(p);
    return failed;
}

int main(int argc, char **argv)
{
    size_t largest = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 1024;
    printf("   grid  contact  iter.  products   CPU [s]  pair [ms]   ratio\n");
    for (size_t n = 256; n <= largest; n *= 2) {
        if (measure(n) != 0) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
