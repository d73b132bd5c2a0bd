// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/sets.h"

#include <math.h>
#include <stdlib.h>

#include "base/rng.h"

void set_carpet(size_t depth, uint8_t *occupied)
{
    size_t n = 1;
    for (size_t k = 0; k < depth; k++) {
        n *= 3;
    }
    for (size_t i = 0; i < n * n; i++) {
        size_t x = i % n;
        size_t y = i / n;
        occupied[i] = 1;
        for (size_t k = 0; k < depth; k++, x /= 3, y /= 3) {
            if (x % 3 == 1 && y % 3 == 1) {
                occupied[i] = 0;
            }
        }
    }
}

void set_cascade(size_t depth, double dimension, uint64_t seed, uint8_t *occupied)
{
    size_t n = (size_t)1 << depth;
    double keep = exp2(dimension - 2.0);
    for (size_t i = 0; i < n * n; i++) {
        occupied[i] = 1;
        for (size_t level = 0; level < depth && occupied[i]; level++) {
            size_t block = (i / n >> level) * n + (i % n >> level);
            if (lac_random_uniform(seed, LAC_STREAM_TEST, block, level) > keep) {
                occupied[i] = 0;
            }
        }
    }
}

lac_domain *set_domain(const lac_grid *grid, const uint8_t *occupied)
{
    size_t cells = lac_grid_cells(grid);
    lac_domain *domain = calloc(1, sizeof *domain);
    if (domain == NULL) {
        return NULL;
    }
    domain->grid = *grid;
    domain->index = malloc(cells * sizeof *domain->index);
    domain->pressure = malloc(cells * sizeof *domain->pressure);
    if (domain->index == NULL || domain->pressure == NULL) {
        set_domain_free(domain);
        return NULL;
    }
    for (size_t i = 0; i < cells; i++) {
        if (occupied[i]) {
            domain->index[domain->n] = (uint32_t)i;
            domain->pressure[domain->n++] = 1.0;
        }
    }
    return domain;
}

void set_domain_free(lac_domain *domain)
{
    if (domain != NULL) {
        free(domain->index);
        free(domain->pressure);
    }
    free(domain);
}
