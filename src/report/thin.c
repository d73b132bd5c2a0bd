// SPDX-License-Identifier: GPL-3.0-or-later
// The records that a page draws: extremes in equal spans of time, and of its log before the end.
#include <math.h>
#include <string.h>

#include "report/run.h"

enum { FEW = 1500, MOST_COLUMNS = 8 };

// Where each column is least and greatest among the records of a bucket.
typedef struct extremes {
    size_t columns;
    const double *const *column;
    size_t least[MOST_COLUMNS], greatest[MOST_COLUMNS];
} extremes;

static void begin(extremes *e)
{
    for (size_t c = 0; c < e->columns; c++) {
        e->least[c] = e->greatest[c] = SIZE_MAX;
    }
}

static void look(extremes *e, size_t i)
{
    for (size_t c = 0; c < e->columns; c++) {
        const double *v = e->column[c];
        if (v == NULL || isnan(v[i])) {
            continue;
        }
        e->least[c] = e->least[c] == SIZE_MAX || v[i] < v[e->least[c]] ? i : e->least[c];
        e->greatest[c] =
            e->greatest[c] == SIZE_MAX || v[i] > v[e->greatest[c]] ? i : e->greatest[c];
    }
}

static void mark(const extremes *e, uint8_t *keep)
{
    for (size_t c = 0; c < e->columns; c++) {
        if (e->least[c] != SIZE_MAX) {
            keep[e->least[c]] = keep[e->greatest[c]] = 1;
        }
    }
}

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

static void mark_axis(size_t n, const axis *a, extremes *e, uint8_t *keep)
{
    double bucket = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        double now = bucket_of(a, i);
        if (now > bucket) {
            if (i > 0) {
                mark(e, keep);
                keep[i - 1] = 1;
            }
            keep[i] = 1;
            begin(e);
            bucket = now;
        }
        look(e, i);
    }
    mark(e, keep);
    keep[n - 1] = 1;
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
        extremes e = {.columns = columns < MOST_COLUMNS ? columns : MOST_COLUMNS, .column = column};
        const axis times = even_times(n, time, buckets);
        const axis decades = even_decades(n, before, buckets);
        mark_axis(n, &times, &e, keep);
        mark_axis(n, &decades, &e, keep);
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
