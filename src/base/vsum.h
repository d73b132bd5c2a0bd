/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

// What is made of a whole array at once: vectorised, in an order that depends on n alone, so that
// every instruction set gives the same bits.

/// Sum of x.
double lac_vsum(size_t n, const double *x);
/// Sum of x_i y_i.
double lac_vdot(size_t n, const double *x, const double *y);
/// Largest |x|, numbers that are none left out; 0 of nothing.
double lac_vmost(size_t n, const double *x);
/// y_i = |x_i|
void lac_vabs(size_t n, const double *x, double *y);
/// Whether all x are finite.
bool lac_vfinite(size_t n, const double *x);
