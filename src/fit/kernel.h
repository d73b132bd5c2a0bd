/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/fail.h"

/// Cholesky's lower triangle in the place of a matrix; GSL's own ends the program where there is
/// none. What depends on the rows before it gets 0.
/// @param stride  from row to row
/// @return whether the matrix is positive definite, with twelve digits
bool lac_fit_factor(size_t d, size_t stride, double *a);

/// A density made of walkers: about each a Student t with four degrees of freedom, whose spread is
/// that of the walkers next to it. So it follows valleys that bend and widen, and reaches far. It
/// turns and stretches with the walkers: an affine map of them maps it.
typedef struct lac_kernels {
    size_t count, dimension, next;
    bool usable;       ///< the walkers do not lie in a plane
    double *place;     ///< [count][dimension] the walkers in coordinates of unit covariance
    double *mean;      ///< [dimension]
    double *root;      ///< [dimension][dimension] lower triangle L: x = mean + L place
    double *local;     ///< [count][dimension][dimension] lower triangles of the spreads
    double *log_scale; ///< [count] -ln of their determinants
    double *away;      ///< [2 count] scratch: squared distances
} lac_kernels;

lac_status lac_kernels_create(size_t count, size_t dimension, lac_kernels *out, lac_error *err);

void lac_kernels_clear(lac_kernels *k);

/// Makes the density of walkers.
/// @param x  [count][dimension]
/// @cost  O(count^2 (dimension + log count) + count dimension^3)
void lac_kernels_set(lac_kernels *k, const double *x);

/// A place drawn from the density.
/// @param which  of the walkers, each as likely
/// @param z      [dimension] standard normal numbers; overwritten
/// @param share  uniform in (0, 1), twice: of the t
void lac_kernels_draw(const lac_kernels *k, size_t which, double *z, const double share[2],
                      double *x);

/// ln of the density at a place, up to a constant.
/// @param scratch  [2 dimension]
/// @cost  O(count dimension^2)
double lac_kernels_log(const lac_kernels *k, const double *x, double *scratch);
