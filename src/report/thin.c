// SPDX-License-Identifier: GPL-3.0-or-later
// The records that a page draws: extremes in equal spans of time, and of its log before the end.
#include <math.h>
#include <string.h>

#include "report/run.h"

enum { FEW = 1500 };

// An axis: times, or the logarithm of the times before the end, turned round.
typedef struct axis {
    const double *value;
    bool logarithm;
    double least, most; // of what has a logarithm
    double width;       // of a bucket; 0: there is one
} axis;

static double bucket_of(const axis *a, size_t i)
{
    double v = a->value[i];
    double place =
        !a->logarithm ? v - a->value[0] : log(a->most) - log(v > a->least ? v : a->least);
    return a->width > 0.0 ? floor(place / a->width) : 0.0;
}

// Where a column is least and greatest from one record up to another.
static void mark_extremes(const double *v, size_t from, size_t to, uint8_t *keep)
{
    size_t least = SIZE_MAX, greatest = SIZE_MAX;
    for (size_t i = from; i < to; i++) {
        if (!isnan(v[i])) {
            least = least == SIZE_MAX || v[i] < v[least] ? i : least;
            greatest = greatest == SIZE_MAX || v[i] > v[greatest] ? i : greatest;
        }
    }
    if (least != SIZE_MAX) {
        keep[least] = keep[greatest] = 1;
    }
}

static void mark_axis(size_t n, const axis *a, size_t columns, const double *const *column,
                      uint8_t *keep)
{
    for (size_t from = 0, to; from < n; from = to) {
        const double bucket = bucket_of(a, from);
        for (to = from + 1; to < n && !(bucket_of(a, to) > bucket);) {
            to++;
        }
        keep[from] = keep[to - 1] = 1;
        for (size_t c = 0; c < columns; c++) {
            if (column[c] != NULL) {
                mark_extremes(column[c], from, to, keep);
            }
        }
    }
}

static axis even_times(size_t n, const double *time, size_t buckets)
{
    return (axis){.value = time, .width = (time[n - 1] - time[0]) / (double)buckets};
}

static axis even_decades(size_t n, const double *before, size_t buckets)
{
    double least = 1.0;
    for (size_t i = n; i-- > 0;) {
        if (before[i] > 0.0) {
            least = before[i];
            break;
        }
    }
    const double most = before[0] > least ? before[0] : least;
    return (axis){.value = before,
                  .logarithm = true,
                  .least = least,
                  .most = most,
                  .width = log(most / least) / (double)buckets};
}

size_t lac_page_thin(size_t n, const double *time, const double *before, size_t buckets,
                     size_t columns, const double *const *column, uint8_t *keep)
{
    const size_t few = buckets * 3 < FEW ? buckets * 3 : FEW;
    size_t kept = 0;
    memset(keep, n <= few, n);
    if (n > few) {
        const axis times = even_times(n, time, buckets);
        const axis decades = even_decades(n, before, buckets);
        mark_axis(n, &times, columns, column, keep);
        mark_axis(n, &decades, columns, column, keep);
    }
    for (size_t i = 0; i < n; i++) {
        kept += keep[i];
    }
    return kept;
}

void lac_page_thin_to(size_t n, const double *time, const double *before, size_t most, size_t goal,
                      uint8_t *keep)
{
    size_t buckets = most / 2;
    while (lac_page_thin(n, time, before, buckets, 0, NULL, keep) > goal && buckets > 1) {
        buckets--;
    }
}
