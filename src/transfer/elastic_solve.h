/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "hierarchy/hierarchy.h"
#include "transfer/compliance.h"

/// How the operator of the half-spaces is had: docs/theory/transfer.md, "The elastic transfer".
typedef struct lac_elastic {
    size_t n;
    lac_compliance *rock;
    const lac_hierarchy *h;
    double *k;               ///< [levels] calibrated, of the preconditioner [Pa/m]; NULL: apply
                             ///< does without, by the rock on full contact
    double anchor;           ///< stiffness of the mean slip there [Pa/m]
    bool direct;             ///< K is a filter; else the inverse of C
    bool floating;           ///< the mean slip is free: K 1 = 0
    double tolerance;        ///< of apply
    double newton_tolerance; ///< of solve
    double *last;            ///< [2n] the last slip and its stress; NULL where K is a filter
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
