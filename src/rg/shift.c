// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>

#include "lacuna/rg.h"

static size_t moved(size_t i, size_t by, size_t n) { return i + by < n ? i + by : i + by - n; }

lac_status lac_rg_shift(const lac_domain *domain, size_t dx, size_t dy, lac_domain **out,
                        uint32_t *cell, lac_error *err)
{
    const lac_grid *from = &domain->grid;
    lac_grid grid = *from;
    double *pressure = NULL;
    uint32_t *origin = NULL;
    lac_status status = LAC_OK;
    *out = NULL;
    if (dx >= from->nx || dy >= from->ny) {
        return lac_fail(err, LAC_EINPUT,
                        "blocks can be moved by less than the %zu x %zu cells of the grid, not by "
                        "%zu x %zu",
                        from->nx, from->ny, dx, dy);
    }
    if (!from->periodic) {
        grid.nx *= from->nx > 1 ? 2 : 1;
        grid.ny *= from->ny > 1 ? 2 : 1;
    }
    pressure = calloc(lac_grid_cells(&grid), sizeof *pressure);
    origin = malloc(lac_grid_cells(&grid) * sizeof *origin);
    status = pressure != NULL && origin != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
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
