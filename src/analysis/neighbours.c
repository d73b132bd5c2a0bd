// SPDX-License-Identifier: GPL-3.0-or-later
// The contact cells that touch each cell by a side or a corner, also across periodic edges.
#include "analysis/neighbours.h"

#include <stdlib.h>
#include <string.h>

const int32_t lac_neighbour_x[LAC_NEIGHBOURS] = {1, -1, 0, 1, -1, 1, 0, -1};
const int32_t lac_neighbour_y[LAC_NEIGHBOURS] = {0, 1, 1, 1, 0, -1, -1, -1};

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
    for (size_t i = 0; i < LAC_NEIGHBOURS * domain->n; i++) {
        size_t k = i % LAC_NEIGHBOURS;
        size_t there = lac_grid_beside(&domain->grid, domain->index[i / LAC_NEIGHBOURS],
                                       lac_neighbour_x[k], lac_neighbour_y[k]);
        neighbour[i] = there != SIZE_MAX ? at[there] : UINT32_MAX;
    }
    free(at);
    return neighbour;
}
