// SPDX-License-Identifier: GPL-3.0-or-later
// A sensor counts in steps of its own, which may be coarser than the last digit written.
#include <float.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

#include "base/fail.h"
#include "base/vsum.h"
#include "series/text.h"

enum {
    TELLING = 10, // readings that no smooth curve explains, and as many that are whole steps apart
    SKIPPED = 20, // of so many gaps one may be too long to tell anything
};
static const double bits = 4.0;  // errors of a value, in last bits
static const double clear = 8.0; // a step over the error of what is divided by it
static const double coarser = 1.5;

// The gaps between the distinct values, in their order, and how many values come again.
static size_t find_gaps(size_t n, const double *x, double error, double *gap, size_t *again)
{
    size_t count = 0;
    size_t gaps = 0;
    *again = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(x[i])) {
            gap[count++] = x[i];
        }
    }
    gsl_sort(gap, 1, count);
    for (size_t i = 1; i < count; i++) { // a gap is written where its values are no longer needed
        const double step = gap[i] - gap[i - 1];
        *again += step > error ? 0 : 1;
        if (step > error) {
            gap[gaps++] = step;
        }
    }
    gsl_sort(gap, 1, gaps);
    return gaps;
}

// What a gap divided by the step may be off; infinite where that says nothing.
static double may_be_off(double gap, double step, double error)
{
    const double off = (gap / step + 1.0) * error;
    return clear * off > step ? INFINITY : off;
}

// The greatest step of which all gaps are whole multiples: Euclid's algorithm with errors. By
// chance a gap is one with less than one in four.
static double divide(size_t n, const double *gap, double error, size_t again)
{
    double step = n > 0 ? gap[0] : 0.0;
    double way = 0.0;
    double steps = 0.0;
    size_t told = 0;
    for (size_t i = 0; i < n && step > 2.0 * clear * error; i++) {
        const double left = fabs(remainder(gap[i], step));
        const double off = may_be_off(gap[i], step, error);
        if (left > off) { // begins anew with a step at most half as long
            step = left;
            way = steps = 0.0;
            told = 0;
            i = (size_t)-1;
        } else if (isfinite(off)) {
            told++;
            way += gap[i];
            steps += rint(gap[i] / step);
        }
    }
    const bool believed = told + again > TELLING && n - told <= n / SKIPPED;
    return step > 2.0 * clear * error && believed && steps > 0.0 ? way / steps : 0.0;
}

// Readings off the parabola through two before and one after by more than half a step.
static size_t count_rough(size_t n, const double *t, const double *x, double step)
{
    size_t count = 0;
    for (size_t i = 2; i + 1 < n; i++) {
        const double *const s = t + i;
        const double before =
            x[i - 2] * (s[0] - s[-1]) * (s[0] - s[1]) / ((s[-2] - s[-1]) * (s[-2] - s[1]));
        const double last =
            x[i - 1] * (s[0] - s[-2]) * (s[0] - s[1]) / ((s[-1] - s[-2]) * (s[-1] - s[1]));
        const double after =
            x[i + 1] * (s[0] - s[-2]) * (s[0] - s[-1]) / ((s[1] - s[-2]) * (s[1] - s[-1]));
        count += fabs(x[i] - before - last - after) > 0.5 * step ? 1 : 0;
    }
    return count;
}

lac_status lac_series_resolve(size_t n, const double *time, const double *x, double *digit,
                              lac_error *err)
{
    static const double type[] = {DBL_EPSILON, FLT_EPSILON};
    const double most = lac_vmost(n, x);
    double *gap = malloc((n > 0 ? n : 1) * sizeof *gap);
    LAC_FAIL_MEMORY_IF(gap == NULL, err);
    for (size_t k = 0; k < sizeof type / sizeof *type; k++) {
        const double error = bits * type[k] * most;
        size_t again;
        const size_t gaps = find_gaps(n, x, error, gap, &again);
        const double step = divide(gaps, gap, error, again);
        if (step > coarser * *digit && count_rough(n, time, x, step) >= TELLING) {
            *digit = *digit > 0.0 ? *digit * rint(step / *digit) : step;
            break;
        }
    }
    free(gap);
    return LAC_OK;
}
