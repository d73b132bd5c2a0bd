// SPDX-License-Identifier: GPL-3.0-or-later
// Sums, largest values and checks of whole arrays, in an order that no instruction set changes.
#include "base/vsum.h"

#include "base/clones.h"

enum { LANES = 16 };

LAC_CLONES double lac_vsum(size_t n, const double *x)
{
    double s[LANES] = {0};
    size_t whole = n - n % LANES;
    for (size_t i = 0; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            s[k] += x[i + k];
        }
    }
    for (size_t i = whole; i < n; i++) {
        s[i - whole] += x[i];
    }
    for (size_t half = LANES / 2; half > 0; half /= 2) {
        for (size_t k = 0; k < half; k++) {
            s[k] += s[k + half];
        }
    }
    return s[0];
}

LAC_CLONES double lac_vmost(size_t n, const double *x)
{
    double s[LANES] = {0};
    size_t whole = n - n % LANES;
    for (size_t i = 0; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            double size = fabs(x[i + k]);
            s[k] = size > s[k] ? size : s[k];
        }
    }
    for (size_t i = whole; i < n; i++) {
        s[i - whole] = fabs(x[i]) > s[i - whole] ? fabs(x[i]) : s[i - whole];
    }
    for (size_t k = 1; k < LANES; k++) {
        s[0] = s[k] > s[0] ? s[k] : s[0];
    }
    return s[0];
}

LAC_CLONES bool lac_vfinite(size_t n, const double *x)
{
    long long count = 0;
    for (size_t i = 0; i < n; i++) {
        count += fabs(x[i]) <= DBL_MAX ? 0 : 1;
    }
    return count == 0;
}

LAC_CLONES void lac_vabs(size_t n, const double *x, double *y)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        y[i] = fabs(x[i]);
    }
}

double lac_vdot(size_t n, const double *x, const double *y)
{
    double sum = 0;
#pragma omp simd safelen(2) reduction(+ : sum)
    for (size_t i = 0; i < n; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}
