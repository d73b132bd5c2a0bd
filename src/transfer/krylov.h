/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/// A symmetric positive definite system and what is near its inverse, for conjugate gradients.
typedef struct lac_krylov {
    size_t n;
    void *self; ///< of the two functions
    void (*multiply)(void *self, const double *x, double *y);
    /// z = M r. Gives back how large the error is that r stands for, squared: r . z, or another
    /// measure of it; NaN where there is no M.
    double (*precondition)(void *self, const double *r, double *z);
} lac_krylov;

enum { LAC_KRYLOV_WORK = 3 }; ///< vectors of scratch

/// Adds to x, to which r belongs, what makes the residual small, by preconditioned conjugate
/// gradients.
/// @param size  of the error that counts as 1, as precondition measures it; NaN: that of r
/// @return iterations; -1 where the system is not positive definite, or they do not suffice
int lac_krylov_solve(const lac_krylov *a, double *x, double *r, double size, double tolerance,
                     int most, double *work);
