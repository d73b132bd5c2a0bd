/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Sum of x, of x_i/n and of x_i y_i, in order.
double lac_sum(size_t n, const double *x);
double lac_mean(size_t n, const double *x);
double lac_dot(size_t n, const double *x, const double *y);

/// x -= part y
void lac_take_off(size_t n, double part, const double *y, double *x);

/// Median of n values, which are put in order; NaN where n = 0.
double lac_median(size_t n, double *values);

/// The value that `share` of n sorted ones are below, between two of them, but none between a
/// finite one and INFINITY, which counts as never.
/// @pre   n > 0, 0 <= share <= 1
double lac_quantile(size_t n, const double *sorted, double share);

/// What of an rms of residuals their noise does not explain: sqrt(rms^2 - noise^2), but 0 where
/// noise comes to so much once in a hundred fits or more: where rms^2 is up to noise^2 times the 99
/// % quantile of chi-square over its degrees of freedom.
/// @param noise  not > 0: not known, and explains nothing
/// @param free   degrees of freedom of the residuals, at least 1 is taken
double lac_unexplained(double rms, double noise, double free);

/// Correlation of x with the values one later, about 0, held between two ends; 0 where all are 0.
/// @param floor  that the sum of squares has besides
double lac_alike(size_t n, const double *x, double floor, double least, double most);

/// For qsort: elements that begin with a double, smallest first.
int lac_by_first(const void *left, const void *right);

/// Points and their least-squares line; where all x are the same it is level.
typedef struct lac_line {
    double n, x0, y0;  ///< what means count from
    double x, y;       ///< means
    double xx, xy, yy; ///< sums of squares and products about them
    double rest;       ///< squares of the residuals, none of them a difference of large sums
} lac_line;

/// The line of n points, means first.
lac_line lac_line_fit(size_t n, const double *x, const double *y);
/// One point more, for points that are not held together; {0} has none. Counts from the first one:
/// squares of seconds since 1970 have no digits left.
void lac_line_add(lac_line *line, double x, double y);
/// NaN where all x are the same.
double lac_line_slope(const lac_line *line);
/// y of the line at x.
double lac_line_at(const lac_line *line, double x);
/// Standard error of the slope, from the sums; NaN of less than three points.
double lac_line_error(const lac_line *line);
/// rms departure from the line's slope of the slopes over all runs of at least half of its points
/// (and two).
double lac_line_range_spread(const lac_line *line, const double *x, const double *y);

enum { LAC_LEAST_SQUARES_MAX = 8 };

/// Linear least squares of few columns, by Householder reflections: y = sum of c_j column_j + r.
/// A column that depends on those before it to 1e-12 gets the coefficient 0.
/// @param columns  [k][n]; overwritten
/// @param y        [n]; becomes the residuals r
/// @param c        [k] coefficients; overwritten
/// @pre   k <= LAC_LEAST_SQUARES_MAX, k <= n
/// @return the sum of squares of r; cannot fail
double lac_least_squares(size_t n, size_t k, double *columns, double *y, double *c);
