/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

// Elementwise exp, log and asinh over arrays: vectorised, at most 1.5 ulp, the same bits on every
// instruction set. IEEE special values behave as in libm. x and y may be the same array.

/// y_i = exp(x_i)
void lac_vexp(size_t n, const double *x, double *y);
/// y_i = exp(-x_i)
void lac_vexp_minus(size_t n, const double *x, double *y);
/// y_i = ln(x_i)
void lac_vlog(size_t n, const double *x, double *y);
/// y_i = asinh(x_i)
void lac_vasinh(size_t n, const double *x, double *y);
