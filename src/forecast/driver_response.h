/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// A driver as a slope would feel it, at any rotation in time.

#include "base/base.h"
#include "forecast/driver.h"

enum { LAC_DRIVER_GRID = 4096, LAC_DRIVER_SCALES = 8 };

/// A driver on even cells: what it is off its own straight line, which is kept apart, so that it
/// may be rotated without a step where its ends meet. Cells that are not known have none.
typedef struct lac_driver_grid {
    double left, step;     ///< [s]
    double at_left, trend; ///< the line [unit], [unit/s]
    double low, high;      ///< of known cells
    double end;            ///< until when it is known [s]
    double between;        ///< median step of the driver's own clock [s]
    size_t scales;
    double scale[LAC_DRIVER_SCALES];   ///< memories and lags [s]
    double off[LAC_DRIVER_GRID];       ///< off the line [unit]
    double known[LAC_DRIVER_GRID + 1]; ///< running sum of the part of cells that is known
    double sum[LAC_DRIVER_GRID + 1];   ///< of off
    double held[LAC_DRIVER_SCALES][LAC_DRIVER_GRID]; ///< reservoirs at the cells' ends, for ever
                                                     ///< fed by off again and again [unit]
    double held_sum[LAC_DRIVER_SCALES][LAC_DRIVER_GRID + 1];
} lac_driver_grid;

/// One way of answering.
typedef struct lac_answer {
    lac_response response;
    size_t scale; ///< of the grid's; SIZE_MAX: none, a lag of 0
} lac_answer;

/// Means of a driver between edges, over what is known.
/// @param now    values that are not complete by then are not looked at
/// @param step   median step of its clock [s]
/// @param edge   [n + 1] [s]
/// @param mean   [n] [unit], of amounts [unit/s]; NaN where nothing is known
/// @param known  [n] the part that is
/// @return until when it is known; -INFINITY: it is not
double lac_driver_mean(const lac_driver *driver, double now, double step, size_t n,
                       const double *edge, double *mean, double *known);

/// Lays a driver on a grid that ends at `last` and begins at `first`, or as much earlier as it is
/// known, at most as long again.
/// @param now    values that are not complete by then are not looked at
/// @param least  the shortest memory or lag [s]; the longest is a third of last - first
lac_status lac_driver_grid_create(const lac_driver *driver, double first, double last, double now,
                                  double least, lac_driver_grid **out, lac_error *err);

/// The index-th way of answering to a driver.
/// @return false: there is none
bool lac_answer_get(const lac_driver_grid *grid, const lac_driver *driver, size_t index,
                    lac_answer *out);

/// Lays the scales closer, from the one below an answer's to the one above, for a second search.
void lac_driver_grid_refine(lac_driver_grid *grid, size_t scale);

/// Its mean over intervals, with the driver rotated to later times by `rotation` cells, without the
/// driver's line.
/// @param from, to  [n] ends of the intervals [s]
void lac_answer_mean(const lac_driver_grid *grid, lac_answer answer, size_t rotation, size_t n,
                     const double *from, const double *to, double *mean);

/// What the driver's line adds to it.
void lac_answer_add_trend(const lac_driver_grid *grid, lac_answer answer, size_t n,
                          const double *from, const double *to, double *mean);

/// The part of an interval that is known.
double lac_driver_known(const lac_driver_grid *grid, double from, double to);
