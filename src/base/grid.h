/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_GRID_H
#define LACUNA_BASE_GRID_H

#include <stdbool.h>
#include <stddef.h>

/// A regular grid of cells: cell (ix, iy) has index iy * nx + ix and its centre at
/// ((ix + 1/2) dx, (iy + 1/2) dy). Slip is along x. A line is a grid with ny = 1.
typedef struct lac_grid {
    size_t nx, ny; ///< cells along x and y; nx = ny = 1 is a single block
    double dx, dy; ///< side of a cell [m]
    bool periodic; ///< the interface repeats in x and y
} lac_grid;

/// Number of cells.
static inline size_t lac_grid_cells(const lac_grid *grid) { return grid->nx * grid->ny; }

/// Area of one cell [m2].
static inline double lac_grid_cell_area(const lac_grid *grid) { return grid->dx * grid->dy; }

/// Nominal area of the interface [m2].
static inline double lac_grid_area(const lac_grid *grid)
{
    return (double)grid->nx * grid->dx * (double)grid->ny * grid->dy;
}

/// The longer side of what occupies so many columns and rows [m]; of a line its length, for the
/// width is no extent.
static inline double lac_grid_extent(const lac_grid *grid, double columns, double rows)
{
    const double along = columns * grid->dx;
    const double across = grid->ny > 1 ? rows * grid->dy : 0.0;
    return along > across ? along : across;
}

#endif
