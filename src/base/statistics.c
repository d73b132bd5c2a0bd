// SPDX-License-Identifier: GPL-3.0-or-later
// What numbers have in common: order, middle, straight lines.
#include "base/statistics.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>

double lac_median(size_t n, double *values)
{
    gsl_sort(values, 1, n);
    return n > 0 ? gsl_stats_median_from_sorted_data(values, 1, n) : (double)NAN;
}

double lac_quantile(size_t n, const double *sorted, double share)
{
    const double at = share * (double)(n - 1);
    const size_t low = (size_t)at;
    const size_t high = low + 1 < n ? low + 1 : low;
    const double part = at - (double)low;
    return isinf(sorted[high]) ? sorted[part > 0.5 ? high : low]
                               : sorted[low] + part * (sorted[high] - sorted[low]);
}

int lac_by_first(const void *left, const void *right)
{
    const double a = *(const double *)left;
    const double b = *(const double *)right;
    return (a > b) - (a < b);
}
