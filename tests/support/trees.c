// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/trees.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"

static void stop_unless(bool ok, const char *why)
{
    if (!ok) {
        (void)fprintf(stderr, "fixture: %s\n", why);
        abort();
    }
}

double *new_doubles(size_t n)
{
    double *x = calloc(n + 1, sizeof *x);
    stop_unless(x != NULL, "out of memory");
    return x;
}

double draw_uniform(uint64_t seed, uint64_t number, double low, double high)
{
    return low + (high - low) * lac_random_uniform(seed, LAC_STREAM_TEST, number, 0);
}

double draw_log(uint64_t seed, uint64_t number, double low, double high)
{
    return exp(draw_uniform(seed, number, log(low), log(high)));
}

lac_domain *domain_of(size_t nx, size_t ny, const uint8_t *mask)
{
    lac_grid grid = {nx, ny, 1, 1, true};
    double *pressure = new_doubles(nx * ny);
    for (size_t i = 0; i < nx * ny; i++) {
        pressure[i] = mask == NULL || mask[i] != 0 ? 1 : 0;
    }
    lac_domain *domain = NULL;
    lac_error err = {""};
    stop_unless(lac_domain_create(&grid, pressure, &domain, &err) == LAC_OK, err.message);
    free(pressure);
    return domain;
}

lac_domain *random_domain(uint64_t seed, size_t max_cells)
{
    static const size_t sides[] = {1, 2, 3, 4, 5, 7, 8, 13, 16, 20, 32, 64, 257};
    const size_t n_sides = sizeof sides / sizeof *sides;
    uint64_t bits[4];
    lac_random(seed, LAC_STREAM_TEST, 0, 1, bits);
    size_t nx = sides[bits[0] % n_sides];
    size_t ny = bits[1] % 4 == 0 ? 1 : bits[1] % 4 == 1 ? sides[bits[2] % n_sides] : nx;
    uint8_t *mask = calloc(nx * ny, 1);
    stop_unless(mask != NULL, "out of memory");
    double fraction = bits[3] % 5 == 0 ? 1 : draw_log(seed, 2, 1e-3, 1);
    // Always the far corner; then cells at random, in clumps of 8 x 8 that are filled or left out.
    mask[nx * ny - 1] = 1;
    size_t n = 1;
    for (size_t i = 0; i < nx * ny && n < max_cells; i++) {
        size_t clump = i / nx / 8 * 1000 + i % nx / 8;
        bool open = fraction == 1 || draw_uniform(seed, 10000 + clump, 0, 1) < 0.6;
        if (mask[i] == 0 && open && draw_uniform(seed, 100000 + i, 0, 1) < fraction) {
            mask[i] = 1;
            n++;
        }
    }
    lac_domain *domain = domain_of(nx, ny, mask);
    free(mask);
    return domain;
}

lac_hierarchy *hierarchy_of(const lac_domain *domain)
{
    lac_hierarchy *h = NULL;
    lac_error err = {""};
    stop_unless(lac_hierarchy_create(domain, &h, &err) == LAC_OK, err.message);
    return h;
}

static bool share_block(const lac_domain *domain, size_t i, size_t j, size_t level)
{
    size_t nx = domain->grid.nx;
    size_t xi = domain->index[i] % nx, yi = domain->index[i] / nx;
    size_t xj = domain->index[j] % nx, yj = domain->index[j] / nx;
    return xi >> level == xj >> level && yi >> level == yj >> level;
}

// Adds `factor` times P_level: 1/(cells of the block) where two cells share it.
static void add_projection(const lac_domain *domain, size_t level, double factor,
                           long double *dense)
{
    for (size_t i = 0; i < domain->n; i++) {
        size_t cells = 0;
        for (size_t j = 0; j < domain->n; j++) {
            cells += share_block(domain, i, j, level);
        }
        for (size_t j = 0; j < domain->n; j++) {
            if (share_block(domain, i, j, level)) {
                dense[i * domain->n + j] += (long double)factor / (long double)cells;
            }
        }
    }
}

void dense_hierarchy(const lac_domain *domain, size_t levels, const double *k, long double *dense)
{
    memset(dense, 0, domain->n * domain->n * sizeof *dense);
    for (size_t level = 0; level < levels; level++) {
        add_projection(domain, level, k[level], dense);
        add_projection(domain, level + 1, -k[level], dense);
    }
}

static void swap_rows(size_t n, long double *a, long double *y, size_t i, size_t j)
{
    for (size_t c = 0; c < n; c++) {
        long double t = a[i * n + c];
        a[i * n + c] = a[j * n + c];
        a[j * n + c] = t;
    }
    long double t = y[i];
    y[i] = y[j];
    y[j] = t;
}

void dense_solve(size_t n, long double *a, long double *y)
{
    for (size_t p = 0; p < n; p++) {
        size_t best = p;
        for (size_t i = p + 1; i < n; i++) {
            best = fabsl(a[i * n + p]) > fabsl(a[best * n + p]) ? i : best;
        }
        swap_rows(n, a, y, p, best);
        for (size_t i = p + 1; i < n; i++) {
            long double factor = a[i * n + p] / a[p * n + p];
            for (size_t c = p; c < n && factor != 0; c++) {
                a[i * n + c] -= factor * a[p * n + c];
            }
            y[i] -= factor * y[p];
        }
    }
    for (size_t p = n; p-- > 0;) {
        for (size_t c = p + 1; c < n; c++) {
            y[p] -= a[p * n + c] * y[c];
        }
        y[p] /= a[p * n + p];
    }
}

bool dense_positive(size_t n, long double *a)
{
    for (size_t p = 0; p < n; p++) {
        if (!(a[p * n + p] > 0)) {
            return false;
        }
        for (size_t i = p + 1; i < n; i++) {
            long double factor = a[i * n + p] / a[p * n + p];
            for (size_t c = p + 1; c < n; c++) {
                a[i * n + c] -= factor * a[p * n + c];
            }
        }
    }
    return true;
}

double relative_error(size_t n, const double *x, const double *y)
{
    double difference = 0, norm = 0;
    for (size_t i = 0; i < n; i++) {
        difference += (x[i] - y[i]) * (x[i] - y[i]);
        norm += y[i] * y[i];
    }
    return norm > 0 ? sqrt(difference / norm) : sqrt(difference);
}
