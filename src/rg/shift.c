// SPDX-License-Identifier: GPL-3.0-or-later
// A tree whose grid of blocks is moved over the joint, to see how much its place decides.
#include <stdlib.h>

#include "rg/tree.h"

static size_t moved(size_t i, size_t by, size_t n) { return i + by < n ? i + by : i + by - n; }

// The moved domain, and for each of its cells the one of the domain.
static lac_status shift(const lac_domain *domain, size_t dx, size_t dy, lac_domain **out,
                        uint32_t *cell, lac_error *err)
{
    const lac_grid *from = &domain->grid;
    lac_grid grid = *from;
    lac_status status;
    if (!from->periodic) {
        grid.nx *= from->nx > 1 ? 2 : 1;
        grid.ny *= from->ny > 1 ? 2 : 1;
    }
    double *pressure = calloc(lac_grid_cells(&grid), sizeof *pressure);
    uint32_t *origin = malloc(lac_grid_cells(&grid) * sizeof *origin);
    LAC_TRY(pressure != NULL && origin != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t i = 0; i < domain->n; i++) {
        size_t x = moved(domain->index[i] % from->nx, dx, grid.nx);
        size_t y = moved(domain->index[i] / from->nx, dy, grid.ny);
        pressure[y * grid.nx + x] = domain->pressure[i];
        origin[y * grid.nx + x] = (uint32_t)i;
    }
    LAC_TRY(lac_domain_create(&grid, pressure, out, err));
    for (size_t i = 0; i < domain->n; i++) {
        cell[i] = origin[(*out)->index[i]];
    }
out:
    free(origin);
    free(pressure);
    return status;
}

lac_status lac_rg_tree_create_at(const lac_domain *domain, size_t dx, size_t dy,
                                 const double *strength, const double *drop, lac_rg_tree **out,
                                 lac_error *err)
{
    const size_t n = domain->n;
    lac_domain *there = NULL;
    lac_hierarchy *h = NULL;
    uint32_t *cell = NULL;
    double *moved_values = NULL;
    lac_status status;
    *out = NULL;
    LAC_FAIL_IF(
        dx >= domain->grid.nx || dy >= domain->grid.ny, err, LAC_EINPUT,
        "blocks can be moved by less than the %zu x %zu cells of the grid, not by %zu x %zu",
        domain->grid.nx, domain->grid.ny, dx, dy);
    cell = malloc(n * sizeof *cell);
    moved_values = malloc(2 * n * sizeof *moved_values);
    LAC_TRY(cell != NULL && moved_values != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(shift(domain, dx, dy, &there, cell, err));
    LAC_TRY(lac_hierarchy_create(there, &h, err));
    for (size_t i = 0; i < n; i++) {
        moved_values[i] = strength[cell[i]];
        moved_values[n + i] = drop[cell[i]];
    }
    LAC_TRY(lac_rg_tree_create(h, moved_values, moved_values + n, out, err));
    (*out)->cell = cell;
    cell = NULL;
out:
    free(moved_values);
    free(cell);
    lac_hierarchy_free(h);
    lac_domain_free(there);
    return status;
}
