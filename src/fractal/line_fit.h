/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FRACTAL_LINE_FIT_H
#define LACUNA_FRACTAL_LINE_FIT_H

#include <stddef.h>

/// A straight line through points by least squares.
typedef struct lac_line {
    double slope, intercept;
    double error; ///< standard error of the slope; 0 for two points
} lac_line;

/// @param x,y  [n] points, n >= 2, not all x the same
lac_line lac_line_fit(const double *x, const double *y, size_t n);

/// rms departure from `slope` of the slopes over all runs of at least half of the points (and two).
double lac_line_range_spread(const double *x, const double *y, size_t n, double slope);

#endif
