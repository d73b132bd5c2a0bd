/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_STATISTICS_H
#define LACUNA_BASE_STATISTICS_H

#include <stddef.h>

/// Median of n values, which are put in order; NaN where n = 0.
double lac_median(size_t n, double *values);

/// The value that `share` of n sorted ones are below; none lies between a finite one and INFINITY.
/// @pre   n > 0, 0 <= share <= 1
double lac_quantile(size_t n, const double *sorted, double share);

/// For qsort: elements that begin with a double, smallest first.
int lac_by_first(const void *left, const void *right);

#endif
