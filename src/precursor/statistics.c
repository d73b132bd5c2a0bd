// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "lacuna/precursor.h"

static const double log10_e = 0.43429448190325182765, ln_10 = 2.30258509299404568402;

// b = log10(e)/(mean - from), of sums of n values above `from`.
static double from_sums(size_t n, double sum, double squares, double from, double *error)
{
    *error = NAN;
    if (n < 2) {
        return NAN;
    }
    const double mean = sum / (double)n;
    const double b = log10_e / (mean - from);
    const double spread = fmax(0.0, squares - (double)n * mean * mean);
    *error = ln_10 * b * b * sqrt(spread / ((double)n * ((double)n - 1.0)));
    return b;
}

double lac_b_value(size_t n, const double *magnitude, double mc, double dm, double *error,
                   size_t *used)
{
    double sum = 0.0;
    double squares = 0.0;
    const double tolerance = 1e-9;
    *used = 0;
    for (size_t i = 0; i < n; i++) {
        if (magnitude[i] >= mc - 0.5 * dm - tolerance) { // magnitudes count from mc
            const double above = magnitude[i] - mc;
            sum += above;
            squares += above * above;
            (*used)++;
        }
    }
    return from_sums(*used, sum, squares, -0.5 * dm, error);
}

double lac_b_positive(size_t n, const double *magnitude, double least, double *error, size_t *used)
{
    double sum = 0.0;
    double squares = 0.0;
    *used = 0;
    for (size_t i = 1; i < n; i++) {
        const double step = magnitude[i] - magnitude[i - 1];
        if (step >= least && step > 0.0) {
            sum += step;
            squares += step * step;
            (*used)++;
        }
    }
    return from_sums(*used, sum, squares, least, error);
}

double lac_kendall(size_t n, const double *values)
{
    double score = 0.0;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = i + 1; j < n; j++) {
            score += (double)((values[j] > values[i]) - (values[j] < values[i]));
        }
    }
    return n > 1 ? score / (0.5 * (double)n * (double)(n - 1)) : NAN;
}
