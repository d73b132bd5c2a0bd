// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the tangential contact on the benchmark surface A08 at 10 % contact, f 0.5.
//   bench_tangential [LARGEST]      grids from 256 to LARGEST (1024)
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/fft.h"
#include "contact/tangential.h"
#include "support/benchmark_surface.h"
#include "support/cost.h"

static const double load = 4.9e-3;
static const double friction = 0.5;

// Seconds of a forward and inverse transform, the best of some.
static double fft_pair(size_t n)
{
    lac_fft *fft = NULL;
    if (lac_fft_create(n, n, &fft, NULL) != LAC_OK) {
        return -1.0;
    }
    double best = 1e300;
    for (size_t trial = 0; trial < 20; trial++) {
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

// A history: loading, on to near sliding, around a corner, back
static int steps(const lac_tangential_def *def, const double *p, double pair)
{
    const double path[][2] = {{0.5, 0.0}, {0.9, 0.0}, {0.5, 0.5}, {-0.5, 0.0}};
    lac_error err = {""};
    lac_tangential *t = NULL;
    reset_peak();
    double before = peak_bytes();
    lac_status status = lac_tangential_create(def, &t, &err);
    for (int k = 0; k < 4 && status == LAC_OK; k++) {
        lac_tangential_stats r;
        lac_tangential_target target = {
            {LAC_SHEAR_LOAD, LAC_SHEAR_LOAD},
            {path[k][0] * friction * load, path[k][1] * friction * load}};
        double start = cpu_seconds();
        status = lac_tangential_step(t, p, &target, &r, &err);
        double seconds = cpu_seconds() - start;
        if (status == LAC_OK) {
            double cells = (double)lac_grid_cells(&def->grid);
            printf("%5zu^2 %s %4.1f  (%4.1f, %3.1f) %6zu %6zu %6lld %9lld %9.3f %7.2f %7.1f\n",
                   def->grid.nx, def->grid.periodic ? "periodic" : "    free", def->poisson,
                   path[k][0], path[k][1], r.stick_cells, r.slip_cells, (long long)r.iterations,
                   (long long)r.products, seconds, seconds / (2.0 * (double)r.products * pair),
                   (peak_bytes() - before) / (cells * sizeof(double)));
        }
    }
    if (status != LAC_OK) {
        (void)fprintf(stderr, "bench_tangential: %s\n", err.message);
    }
    lac_tangential_free(t);
    return status != LAC_OK;
}

static int measure(size_t n, bool periodic)
{
    const double ratios[] = {0.0, 0.2};
    double *h = malloc(n * n * sizeof *h);
    double *p = malloc(n * n * sizeof *p);
    lac_error err = {""};
    int failed = 1;
    if (h == NULL || p == NULL || benchmark_surface(n, h) != 0) {
        (void)fprintf(stderr, "bench_tangential: out of memory\n");
        goto out;
    }
    lac_contact_def normal = lac_contact_default();
    normal.grid = (lac_grid){n, n, 1.0 / (double)n, 1.0 / (double)n, periodic};
    normal.heights = h;
    normal.e_star = 1.0;
    normal.mean_pressure = load;
    if (lac_contact_solve(&normal, p, NULL, NULL, &err) != LAC_OK) {
        (void)fprintf(stderr, "bench_tangential: %s\n", err.message);
        goto out;
    }
    double pair = fft_pair(periodic ? n : 2 * n);
    failed = 0;
    for (int k = 0; k < 2 && failed == 0; k++) {
        lac_tangential_def def = lac_tangential_default();
        def.grid = normal.grid;
        def.e_star = 1.0;
        def.poisson = ratios[k];
        def.friction = friction;
        failed = steps(&def, p, pair);
    }
out:
    free(h);
    free(p);
    return failed;
}

int main(int argc, char **argv)
{
    size_t largest = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 1024;
    omp_set_num_threads(1);
    printf("   grid            nu  (Q/fP)        stick   slip  iter.  products   CPU [s]   ratio  "
           "arrays\n"
           "ratio: CPU over products x two transform pairs; arrays: peak memory in arrays of the "
           "grid\n");
    for (size_t n = 256; n <= largest; n *= 2) {
        if (measure(n, true) != 0 || measure(n, false) != 0) {
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}
