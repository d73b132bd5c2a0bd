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

// Numbers that are not negative stand in the order of their bits, which compilers compare many at a
// time; what is not a number does not count.
LAC_CLONES double lac_vmost(size_t n, const double *x)
{
    const int64_t infinite = INT64_C(0x7ff0000000000000);
    int64_t most = 0;
    for (size_t i = 0; i < n; i++) {
        int64_t size;
        double one = fabs(x[i]);
        memcpy(&size, &one, sizeof size);
        size = size <= infinite ? size : 0;
        most = size > most ? size : most;
    }
    double found;
    memcpy(&found, &most, sizeof found);
    return found;
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
