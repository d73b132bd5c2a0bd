/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "transfer/compliance.h"
#include "transfer/transfer.h"

/// How the operator of the half-spaces is had: docs/theory/transfer.md, "The elastic transfer".
typedef struct lac_elastic {
    size_t n;
    lac_compliance *rock;
    const lac_hierarchy *h;
    double *k;               ///< [levels] calibrated, of the preconditioner [Pa/m]; NULL: none
    double anchor;           ///< stiffness of the mean slip there [Pa/m]
    bool direct;             ///< K is a filter; else the inverse of C
    bool floating;           ///< the mean slip is free: K 1 = 0
    double tolerance;        ///< of apply
    double newton_tolerance; ///< of solve
    double *last;            ///< [2n] the last slip and its stress; NULL where K is a filter
    lac_compliance *across, *cross; ///< of slip in two directions: tractions along y of slip along
                                    ///< y, and of each of the other; NULL
    double *k_across;               ///< [levels] as k, of slip along y
} lac_elastic;

enum { LAC_ELASTIC_ITERATIONS = 1000 }; ///< at most

/// Doubles of scratch of the two functions below.
size_t lac_elastic_work(const lac_elastic *e);

/// force = K slip, also without k; NaN where the iteration does not end. @return iterations, -1
/// where it does not
int lac_elastic_apply(const lac_elastic *e, const double *slip, double *force, double *work);

/// (D + K + k_mean P_m) x = y; x may be y. Iterations, or -1 as above or where it is not positive
/// definite.
int lac_elastic_solve(const lac_elastic *e, double k_mean, const double *diagonal, const double *y,
                      double *x, double *work);

/// Readies it for slip in two directions; the others are of lac_transfer_pair, of this state.
lac_status lac_elastic_direct(const lac_transfer_scene *scene, const lac_rock *rock, lac_elastic *e,
                              lac_error *err);
size_t lac_elastic_pair_work(const void *state);
void lac_elastic_pair_apply(const void *state, const double *const slip[2], double *const force[2],
                            double *work);
bool lac_elastic_pair_solve(const void *state, double k_mean, const double *const diagonal[3],
                            double *const x[2], double *work);

/// A symmetric positive definite system and what is near its inverse, for conjugate gradients.
typedef struct lac_krylov {
    size_t n;
    void *self; ///< of the two functions
    void (*multiply)(void *self, const double *x, double *y);
    /// z = M r. Gives back how large the error is that r stands for, squared: r . z, or another
    /// measure of it; NaN where there is no M.
    double (*precondition)(void *self, const double *r, double *z);
} lac_krylov;

/// Adds to x, to which r belongs, what makes the residual small.
/// @param size  of the error that counts as 1, as precondition measures it; NaN: that of r
/// @param work  three vectors
/// @return iterations; -1 where the system is not positive definite, or they do not suffice
int lac_elastic_iterate(const lac_krylov *a, double *x, double *r, double size, double tolerance,
                        double *work);
