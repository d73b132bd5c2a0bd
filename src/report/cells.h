/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "report/run.h"

/// The contact cells as the page draws them: squares of `block` x `block` cells each.
typedef struct lac_page_raster {
    size_t cells;
    size_t nx, ny;    ///< squares of the whole interface
    size_t block;     ///< cells along the side of a square
    double dx, dy;    ///< sides of a square [m]
    size_t squares;   ///< that hold a contact cell
    uint32_t *square; ///< [cells] number of the square that a cell lies in
    double *place;    ///< [squares] row * nx + column
    uint32_t *count;  ///< [squares] contact cells in it
} lac_page_raster;

/// What a square shows of its cells.
typedef enum lac_page_summary {
    LAC_PAGE_MEAN,
    LAC_PAGE_MOST,
    LAC_PAGE_SHARE_ABOVE
} lac_page_summary;

/// @param value  [cells] NaN: missing
/// @param limit  of LAC_PAGE_SHARE_ABOVE
/// @param out    [squares]
void lac_page_raster_summarise(const lac_page_raster *raster, lac_page_summary how,
                               const double *value, double limit, double *out);
