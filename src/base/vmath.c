// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/vmath.h"

#include <math.h>

void lac_vexp(size_t n, const double *x, double *y)
{
    for (size_t i = 0; i < n; i++) {
        y[i] = exp(x[i]);
    }
}

void lac_vlog(size_t n, const double *x, double *y)
{
    for (size_t i = 0; i < n; i++) {
        y[i] = log(x[i]);
    }
}

void lac_vasinh(size_t n, const double *x, double *y)
{
    for (size_t i = 0; i < n; i++) {
        y[i] = asinh(x[i]);
    }
}
