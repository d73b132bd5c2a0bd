// SPDX-License-Identifier: GPL-3.0-or-later
// The cells in contact, listed in Morton order, in which the cells of any block stand side by side.
#include "contact/contact.h"

#include <math.h>
#include <stdlib.h>

// Moves bit i of a 32-bit number to bit 2i.
static uint64_t spread_bits(uint32_t bits)
{
    uint64_t x = bits;
    x = (x | x << 16) & UINT64_C(0x0000ffff0000ffff);
    x = (x | x << 8) & UINT64_C(0x00ff00ff00ff00ff);
    x = (x | x << 4) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    x = (x | x << 2) & UINT64_C(0x3333333333333333);
    x = (x | x << 1) & UINT64_C(0x5555555555555555);
    return x;
}

uint64_t lac_morton(uint32_t ix, uint32_t iy) { return spread_bits(ix) | spread_bits(iy) << 1; }

static lac_status check_grid(const lac_grid *grid, lac_error *err)
{
    // Cells are counted in 32 bits throughout, with one number to spare for "one past the end".
    LAC_FAIL_IF(
        grid->nx == 0 || grid->ny == 0 || grid->nx >= UINT32_MAX / grid->ny, err, LAC_EINPUT,
        "an interface of %zu x %zu cells is not possible: at least one and fewer than 2^32 cells",
        grid->nx, grid->ny);
    LAC_FAIL_IF(!(isfinite(grid->dx) && grid->dx > 0 && isfinite(grid->dy) && grid->dy > 0), err,
                LAC_EINPUT, "a cell of %g m x %g m is not possible: both must be > 0", grid->dx,
                grid->dy);
    return LAC_OK;
}

static lac_status count_contact(const lac_grid *grid, const double *pressure, size_t *n,
                                lac_error *err)
{
    *n = 0;
    for (size_t i = 0; i < lac_grid_cells(grid); i++) {
        LAC_FAIL_IF(!(isfinite(pressure[i]) && pressure[i] >= 0), err, LAC_EINPUT,
                    "the pressure of cell (%zu, %zu) is %g Pa: must be finite and >= 0",
                    i % grid->nx, i / grid->nx, pressure[i]);
        *n += pressure[i] > 0;
    }
    LAC_FAIL_IF(*n == 0, err, LAC_EINPUT, "no cell is in contact: every pressure is 0");
    return LAC_OK;
}

// Collects the contact cells of the block of `side` cells at (x, y), its four quarters in turn.
static void collect(lac_domain *domain, const double *pressure, size_t x, size_t y, size_t side)
{
    const lac_grid *grid = &domain->grid;
    if (x >= grid->nx || y >= grid->ny) {
        return;
    }
    if (side == 1) {
        size_t i = y * grid->nx + x;
        if (pressure[i] > 0) {
            domain->index[domain->n] = (uint32_t)i;
            domain->pressure[domain->n++] = pressure[i];
        }
        return;
    }
    size_t half = side / 2;
    collect(domain, pressure, x, y, half);
    collect(domain, pressure, x + half, y, half);
    collect(domain, pressure, x, y + half, half);
    collect(domain, pressure, x + half, y + half, half);
}

lac_status lac_domain_create(const lac_grid *grid, const double *pressure, lac_domain **out,
                             lac_error *err)
{
    *out = NULL;
    size_t n = 0;
    lac_domain *domain = NULL;
    lac_status status = LAC_OK;
    LAC_TRY(check_grid(grid, err));
    LAC_TRY(count_contact(grid, pressure, &n, err));
    domain = calloc(1, sizeof *domain);
    LAC_FAIL_MEMORY_IF(domain == NULL, err);
    domain->grid = *grid;
    domain->index = malloc(n * sizeof *domain->index);
    domain->pressure = malloc(n * sizeof *domain->pressure);
    LAC_TRY(domain->index != NULL && domain->pressure != NULL ? LAC_OK : lac_fail_memory(err));
    collect(domain, pressure, 0, 0, (size_t)1 << lac_grid_levels(grid));
    *out = domain;
    domain = NULL;
out:
    lac_domain_free(domain);
    return status;
}

void lac_domain_free(lac_domain *domain)
{
    if (domain != NULL) {
        free(domain->index);
        free(domain->pressure);
        free(domain);
    }
}
