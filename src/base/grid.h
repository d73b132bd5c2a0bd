/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

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

/// Centre of a cell [m].
static inline double lac_grid_x(const lac_grid *grid, size_t cell)
{
    return ((double)(cell % grid->nx) + 0.5) * grid->dx;
}
static inline double lac_grid_y(const lac_grid *grid, size_t cell)
{
    return ((double)(cell / grid->nx) + 0.5) * grid->dy;
}

/// Nominal area of the interface [m2].
static inline double lac_grid_area(const lac_grid *grid)
{
    return (double)grid->nx * grid->dx * (double)grid->ny * grid->dy;
}

/// m: blocks of 2^m cells a side are the first of which one covers the grid.
static inline size_t lac_grid_levels(const lac_grid *grid)
{
    size_t m = 0;
    while ((size_t)1 << m < grid->nx || (size_t)1 << m < grid->ny) {
        m++;
    }
    return m;
}

/// The cell at most one step away along x and y, through the edges where periodic; SIZE_MAX: none.
static inline size_t lac_grid_beside(const lac_grid *grid, size_t cell, int dx, int dy)
{
    size_t x = cell % grid->nx + (size_t)(ptrdiff_t)dx;
    size_t y = cell / grid->nx + (size_t)(ptrdiff_t)dy;
    if (grid->periodic) {
        x = x == grid->nx ? 0 : x == SIZE_MAX ? grid->nx - 1 : x;
        y = y == grid->ny ? 0 : y == SIZE_MAX ? grid->ny - 1 : y;
    }
    return x < grid->nx && y < grid->ny ? y * grid->nx + x : SIZE_MAX;
}

/// The longer side of what occupies so many columns and rows [m]; of a line its length, for the
/// width is no extent.
static inline double lac_grid_extent(const lac_grid *grid, double columns, double rows)
{
    const double along = columns * grid->dx;
    const double across = grid->ny > 1 ? rows * grid->dy : 0.0;
    return along > across ? along : across;
}
