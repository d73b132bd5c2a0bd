// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics of the indicators: b-values, trends, and how likely chance alone gives as much.
#include "base/rng.h"
#include "precursor/kinds.h"

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

double lac_b_value(size_t n, const double *magnitude, double mc, double *error, size_t *used)
{
    double sum = 0.0, squares = 0.0;
    const double tolerance = 1e-9;
    *used = 0;
    for (size_t i = 0; i < n; i++) {
        if (magnitude[i] >= mc - tolerance) { // magnitudes count from mc
            const double above = magnitude[i] - mc;
            sum += above;
            squares += above * above;
            (*used)++;
        }
    }
    return from_sums(*used, sum, squares, 0.0, error);
}

double lac_b_positive(size_t n, const double *magnitude, double least, double *error, size_t *used)
{
    double sum = 0.0, squares = 0.0;
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

// The largest value in each of equal parts of the time, values holding until the next.
static void largest_of_parts(size_t n, const double *time, const double *values, double *largest)
{
    const double length = time[n - 1] - time[0];
    double before = -INFINITY;
    size_t i = 0;
    for (size_t part = 0; part < LAC_RISE_PARTS; part++) {
        const double end = (double)(part + 1) / LAC_RISE_PARTS;
        largest[part] = before;
        for (; i < n && (part + 1 == LAC_RISE_PARTS || (time[i] - time[0]) / length <= end); i++) {
            if (isfinite(values[i])) {
                before = values[i];
                largest[part] = fmax(largest[part], before);
            }
        }
    }
}

double lac_rise_p(size_t n, const double *time, const double *values)
{
    double largest[LAC_RISE_PARTS];
    size_t as_large = 0;
    if (n == 0 || !(time[n - 1] > time[0])) {
        return NAN;
    }
    largest_of_parts(n, time, values, largest);
    for (size_t part = 0; part < LAC_RISE_PARTS; part++) { // the last is as large as itself
        as_large += largest[part] >= largest[LAC_RISE_PARTS - 1] ? 1 : 0;
    }
    return (double)as_large / LAC_RISE_PARTS;
}

double lac_half_p(size_t n, size_t late)
{
    const double ln_2 = 0.69314718055994530942;
    double ln_ways = 0.0; // of choosing k of n
    double p = 0.0;
    for (size_t k = n + 1; k-- > late;) {
        p += exp(ln_ways - (double)n * ln_2);
        ln_ways += k > 0 ? log((double)k / (double)(n - k + 1)) : 0.0;
    }
    return fmin(1.0, p);
}

void lac_surrogate_red(size_t n, double phi, uint64_t seed, size_t index, double *x)
{
    double before = 0.0;
    double pair[2];
    for (size_t i = 0; i < n; i++) {
        if (i % 2 == 0) {
            lac_random_normal(seed, LAC_STREAM_SURROGATE, index, i / 2, pair);
        }
        before = i == 0 ? pair[0] / sqrt(1.0 - phi * phi) : phi * before + pair[i % 2];
        x[i] = before;
    }
}
