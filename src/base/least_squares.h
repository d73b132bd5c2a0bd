/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

enum { LAC_LEAST_SQUARES_MAX = 8 };

/// Linear least squares of few columns, by Householder reflections: y = sum of c_j column_j + r.
/// A column that depends on those before it to 1e-12 gets the coefficient 0.
/// @param columns  [k][n]; overwritten
/// @param y        [n]; becomes the residuals r
/// @param c        [k] coefficients; overwritten
/// @pre   k <= LAC_LEAST_SQUARES_MAX, k <= n
/// @return the sum of squares of r; cannot fail
double lac_least_squares(size_t n, size_t k, double *columns, double *y, double *c);
