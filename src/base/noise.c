// SPDX-License-Identifier: GPL-3.0-or-later
// What readings scatter by themselves: their differences, so high that the signal is gone from
// them.
#include "base/noise.h"

#include "base/statistics.h"

enum { LINE = 3, PARABOLA = 4, FEWEST = 11, AROUND = 9 };
static const double normal = 1.4826; // standard deviation over the median distance
static const double local = 2.0;     // a median of few is vague

// Distance of reading 1 of a few from the polynomial through the others, over its own error.
static double off_others(size_t points, const double *t, const double *y)
{
    double off = y[1];
    double squares = 1.0;
    for (size_t j = 0; j < points; j++) {
        double weight = 1.0;
        for (size_t k = 0; k < points; k++) {
            weight *= k != j && k != 1 ? (t[1] - t[k]) / (t[j] - t[k]) : 1.0;
        }
        off -= j != 1 ? weight * y[j] : 0.0;
        squares += j != 1 ? weight * weight : 0.0;
    }
    return fabs(off) / sqrt(squares);
}

static double scatter(size_t n, const double *time, const double *value, size_t points,
                      double *work)
{
    size_t count = 0;
    for (; count + points <= n; count++) {
        work[count] = off_others(points, time + count, value + count);
    }
    return normal * lac_median(count, work);
}

double lac_noise_of(size_t n, const double *time, const double *value, double *work)
{
    const double line = scatter(n, time, value, LINE, work);
    return n < FEWEST ? line : fmin(line, scatter(n, time, value, PARABOLA, work));
}

void lac_noise_at(size_t n, const double *time, const double *value, double all, double *out)
{
    const size_t count = n < AROUND ? n : AROUND;
    double work[AROUND];
    for (size_t i = 0; i < n; i++) {
        if (i % AROUND > 0) {
            out[i] = out[i - 1];
            continue;
        }
        const size_t first = i + AROUND <= n ? i : n - count;
        const double here =
            local * fmin(scatter(count, time + first, value + first, LINE, work),
                         scatter(count, time + first, value + first, PARABOLA, work));
        out[i] = here < all ? here : all;
    }
}
