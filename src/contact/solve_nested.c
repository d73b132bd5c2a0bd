// SPDX-License-Identifier: GPL-3.0-or-later
// A first guess of contact pressures: the same problem, solved roughly on ever coarser grids.
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
static lac_status average(const lac_extent *fine, lac_heights h, const lac_extent *coarse,
                          double *mean, double *row, lac_error *err)
{
    const size_t n = fine->ny, m = coarse->ny;
    const lac_strip *to = &coarse->rows;
    const size_t first = to->first * n / m, end = ((to->first + to->n) * n + m - 1) / m;
    void *made;
    h.z = lac_strip_bring(&fine->rows, first, end - first, fine->nx * sizeof *mean, h.z, &made);
    LAC_FAIL_MEMORY_IF(h.z == NULL, err);
    memset(mean, 0, lac_extent_cells(coarse) * sizeof *mean);
    for (size_t j = first; j < end; j++) {
        const size_t from = j * m, edge = (from / n + 1) * n;
        const size_t within = from + m < edge ? m : edge - from;
        const size_t into = from / n - to->first; // of one row before, SIZE_MAX
        for (size_t i = 0; i < fine->nx; i++) {
            row[i] = lac_heights_at(h, (j - first) * fine->nx + i);
        }
        if (into < to->n) {
            average_row(fine->nx, coarse->nx, row, (double)within / (double)n,
                        &mean[into * coarse->nx]);
        }
        if (within < m && into + 1 < to->n) {
            double rest = (double)(m - within) / (double)n;
            average_row(fine->nx, coarse->nx, row, rest, &mean[(into + 1) * coarse->nx]);
        }
    }
    free(made);
    return LAC_OK;
}

// The coarse row that the middle of a fine one lies in.
static size_t row_under(const lac_extent *fine, const lac_extent *coarse, size_t j)
{
    return (2 * j + 1) * coarse->ny / (2 * fine->ny);
}

// Each fine cell gets the pressure of the coarse cell that its middle lies in.
static lac_status inject(const lac_extent *coarse, const double *from, const lac_extent *fine,
                         double *to, lac_error *err)
{
    const lac_strip *rows = &fine->rows;
    const size_t first = rows->n > 0 ? row_under(fine, coarse, rows->first) : 0;
    const size_t end = rows->n > 0 ? row_under(fine, coarse, rows->first + rows->n - 1) + 1 : 0;
    void *made;
    const double *p =
        lac_strip_bring(&coarse->rows, first, end - first, coarse->nx * sizeof *from, from, &made);
    LAC_FAIL_MEMORY_IF(p == NULL, err);
    for (size_t j = 0; j < rows->n; j++) {
        const size_t under = row_under(fine, coarse, rows->first + j) - first;
        const double *row = p + under * coarse->nx;
        for (size_t i = 0; i < fine->nx; i++) {
            to[j * fine->nx + i] = row[(2 * i + 1) * coarse->nx / (2 * fine->nx)];
        }
    }
    free(made);
    return LAC_OK;
}

// Brings pressures to the load where that is given.
static void rescale(const lac_descent *d, const lac_extent *at, double *pressure)
{
    const size_t n = lac_extent_cells(at);
    const double all = (double)(at->nx * at->ny);
    double scale = d->control == LAC_CONTROL_LOAD
                       ? d->mean_pressure * all / lac_strip_sum(&at->rows, n, pressure, 1.0)
                       : 1.0;
    for (size_t i = 0; i < n; i++) {
        pressure[i] *= scale;
    }
}

lac_status lac_coarse_guess(const lac_extent *at, lac_heights h, const lac_descent *fine,
                            double *pressure, lac_error *err)
{
    lac_extent c = *at;
    c.nx = coarser(at->nx);
    c.ny = coarser(at->ny);
    c.rows = lac_strip_rows(at->rows.team, c.ny);
    if (c.nx == at->nx && c.ny == at->ny) {
        for (size_t i = 0; i < lac_extent_cells(at); i++) {
            pressure[i] = fine->mean_pressure;
        }
        return LAC_OK;
    }
    lac_status status;
    lac_half_space *s = NULL;
    const size_t n = lac_extent_cells(&c);
    double *mean = lac_team_alloc(at->rows.team, (n + at->nx) * sizeof *mean);
    double *guess = lac_team_alloc(at->rows.team, n * sizeof *guess);
    lac_descent d = *fine;
    d.heights = (lac_heights){mean, 0.0, 1.0};
    d.tolerance = coarse_tolerance;
    d.max_iterations = coarse_iterations;
    LAC_TRY(mean != NULL && guess != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(average(at, h, &c, mean, mean + n, err));
    LAC_TRY(lac_coarse_guess(&c, d.heights, fine, guess, err));
    LAC_TRY(lac_half_space_create(&c, &s, err));
    LAC_TRY(lac_descend(s, &d, guess, NULL, err));
    LAC_TRY(inject(&c, guess, at, pressure, err));
    rescale(fine, at, pressure);
out:
    lac_half_space_free(s);
    free(mean);
    free(guess);
    return status;
}
