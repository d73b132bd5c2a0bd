// SPDX-License-Identifier: GPL-3.0-or-later
// exp, ln and asinh of whole arrays, with the same bits on every instruction set.
#include "base/vmath.h"

#include "base/vmath_kernels.h"

#define EACH(name, result)                                     \
    LAC_CLONES void name(size_t n, const double *x, double *y) \
    {                                                          \
        LAC_INDEPENDENT                                        \
        for (size_t i = 0; i < n; i++) {                       \
            y[i] = (result);                                   \
        }                                                      \
    }

EACH(lac_vexp, lac_exp_one(x[i]))
EACH(lac_vexp_minus, lac_exp_one(-x[i]))
EACH(lac_vlog, lac_log_one(x[i]))
EACH(lac_vasinh, lac_asinh_one(x[i]))
