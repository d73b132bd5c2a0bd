// SPDX-License-Identifier: GPL-3.0-or-later
// The contact cells that touch each cell by a side or a corner, also across periodic edges.
#include "analysis/neighbours.h"

#include <stdlib.h>
#include <string.h>

const int32_t lac_neighbour_x[LAC_NEIGHBOURS] = {1, -1, 0, 1, -1, 1, 0, -1};
const int32_t lac_neighbour_y[LAC_NEIGHBOURS] = {0, 1, 1, 1, 0, -1, -1, -1};

// Where a step along one axis leads; n where it leaves the grid.
static size_t moved(size_t i, int32_t by, size_t n, bool periodic)
{
    if (by < 0 && i == 0) {
        return periodic ? n - 1 : n;
    }
    size_t there = i + (size_t)(ptrdiff_t)by;
    return there == n && periodic ? 0 : there;
}

static void find(const lac_domain *domain, const uint32_t *at, uint32_t *neighbour)
{
    const lac_grid *grid = &domain->grid;
    for (size_t i = 0; i < domain->n; i++) {
        size_t ix = domain->index[i] % grid->nx;
        size_t iy = domain->index[i] / grid->nx;
        for (size_t k = 0; k < LAC_NEIGHBOURS; k++) {
            size_t x = moved(ix, lac_neighbour_x[k], grid->nx, grid->periodic);
            size_t y = moved(iy, lac_neighbour_y[k], grid->ny, grid->periodic);
            bool inside = x < grid->nx && y < grid->ny;
            neighbour[LAC_NEIGHBOURS * i + k] = inside ? at[y * grid->nx + x] : UINT32_MAX;
        }
    }
}

uint32_t *lac_neighbours_find(const lac_domain *domain)
{
    const size_t cells = lac_grid_cells(&domain->grid);
    uint32_t *at = malloc(cells * sizeof *at);
    uint32_t *neighbour = malloc(LAC_NEIGHBOURS * domain->n * sizeof *neighbour);
    if (at == NULL || neighbour == NULL) {
        free(at);
        free(neighbour);
        return NULL;
    }
    memset(at, 0xff, cells * sizeof *at);
    for (size_t i = 0; i < domain->n; i++) {
        at[domain->index[i]] = (uint32_t)i;
    }
    find(domain, at, neighbour);
    free(at);
    return neighbour;
}
