// SPDX-License-Identifier: GPL-3.0-or-later
// A first guess of contact pressures: the same problem, solved roughly on ever coarser grids.
#include "base/statistics.h"
#include "contact/solve.h"

// First guesses from coarser grids. A coarse grid has about half the cells a side, as many as a
// transform likes; its cells need not be whole numbers of fine ones.

enum { COARSEST = 32 };
static const double coarse_tolerance = 1e-3;
static const int64_t coarse_iterations = 200;

// Whether n = 2^a 3^b 5^c
static bool smooth(size_t n)
{
    const size_t primes[] = {2, 3, 5};
    for (size_t k = 0; k < 3; k++) {
        while (n % primes[k] == 0) {
            n /= primes[k];
        }
    }
    return n == 1;
}

// Cells along a side of the next coarser grid: half of them or a few more; n where that is short.
static size_t coarser(size_t n)
{
    size_t m = (n + 1) / 2;
    while (m >= COARSEST && !smooth(m)) {
        m++;
    }
    return m >= COARSEST && m < n ? m : n;
}

// Adds weight x fine to the means of n/m fine cells each; a fine cell may lie across two.
static void average_row(size_t n, size_t m, const double *fine, double weight, double *coarse)
{
    for (size_t i = 0; i < n; i++) {
        // in units of 1/n of a coarse cell
        size_t from = i * m, to = from + m;
        size_t edge = (from / n + 1) * n;
        size_t within = to < edge ? m : edge - from;
        double value = weight * fine[i] / (double)n;
        coarse[from / n] += value * (double)within;
        if (to > edge) {
            coarse[from / n + 1] += value * (double)(to - edge);
        }
    }
}

// Means over the cells of the coarse grid. @param row  [fine nx] scratch
static void average(const lac_extent *fine, lac_heights h, const lac_extent *coarse, double *mean,
                    double *row)
{
    size_t n = fine->ny, m = coarse->ny;
    memset(mean, 0, coarse->nx * m * sizeof *mean);
    for (size_t j = 0; j < n; j++) {
        size_t from = j * m;
        size_t edge = (from / n + 1) * n;
        size_t within = from + m < edge ? m : edge - from;
        for (size_t i = 0; i < fine->nx; i++) {
            row[i] = lac_heights_at(h, j * fine->nx + i);
        }
        double *to = &mean[from / n * coarse->nx];
        average_row(fine->nx, coarse->nx, row, (double)within / (double)n, to);
        if (within < m) {
            double rest = (double)(m - within) / (double)n;
            average_row(fine->nx, coarse->nx, row, rest, to + coarse->nx);
        }
    }
}

// Each fine cell gets the pressure of the coarse cell that its middle lies in.
static void inject(const lac_extent *coarse, const double *from, const lac_extent *fine, double *to)
{
    for (size_t j = 0; j < fine->ny; j++) {
        const double *row = &from[(2 * j + 1) * coarse->ny / (2 * fine->ny) * coarse->nx];
        for (size_t i = 0; i < fine->nx; i++) {
            to[j * fine->nx + i] = row[(2 * i + 1) * coarse->nx / (2 * fine->nx)];
        }
    }
}

// Brings pressures to the load where that is given.
static void rescale(const lac_descent *d, size_t n, double *pressure)
{
    double scale =
        d->control == LAC_CONTROL_LOAD ? d->mean_pressure * (double)n / lac_sum(n, pressure) : 1.0;
    for (size_t i = 0; i < n; i++) {
        pressure[i] *= scale;
    }
}

lac_status lac_coarse_guess(const lac_extent *at, lac_heights h, const lac_descent *fine,
                            double *pressure, lac_error *err)
{
    size_t n = at->nx * at->ny;
    lac_extent c = *at;
    c.nx = coarser(at->nx);
    c.ny = coarser(at->ny);
    if (c.nx == at->nx && c.ny == at->ny) {
        for (size_t i = 0; i < n; i++) {
            pressure[i] = fine->mean_pressure;
        }
        return LAC_OK;
    }
    lac_status status;
    lac_half_space *s = NULL;
    double *mean = malloc((c.nx * c.ny + at->nx) * sizeof *mean);
    double *guess = malloc(c.nx * c.ny * sizeof *guess);
    lac_descent d = *fine;
    d.heights = (lac_heights){mean, 0.0, 1.0};
    d.tolerance = coarse_tolerance;
    d.max_iterations = coarse_iterations;
    LAC_TRY(mean != NULL && guess != NULL ? LAC_OK : lac_fail_memory(err));
    average(at, h, &c, mean, mean + c.nx * c.ny);
    LAC_TRY(lac_coarse_guess(&c, d.heights, fine, guess, err));
    LAC_TRY(lac_half_space_create(&c, &s, err));
    LAC_TRY(lac_descend(s, &d, guess, NULL, err));
    inject(&c, guess, at, pressure);
    rescale(fine, n, pressure);
out:
    lac_half_space_free(s);
    free(mean);
    free(guess);
    return status;
}
