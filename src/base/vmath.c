// SPDX-License-Identifier: GPL-3.0-or-later
// exp, ln and asinh of whole arrays, with the same bits on every instruction set.
#include "base/vmath.h"

#include "base/vmath_kernels.h"

LAC_CLONES void lac_vexp(size_t n, const double *x, double *y)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        y[i] = lac_exp_one(x[i]);
    }
}

LAC_CLONES void lac_vexp_minus(size_t n, const double *x, double *y)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        y[i] = lac_exp_one(-x[i]);
    }
}

LAC_CLONES void lac_vlog(size_t n, const double *x, double *y)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        y[i] = lac_log_one(x[i]);
    }
}

LAC_CLONES void lac_vasinh(size_t n, const double *x, double *y)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        y[i] = lac_asinh_one(x[i]);
    }
}
