/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdint.h>

#include "contact/tangential.h"
#include "contact/tangential_space.h"

/// One step of a sheared contact, on its contact cells only: minimise tau.C tau/2 - tau.(u0 + d)
/// over |tau_i| <= limit_i, d the shift of this step, given or such that the sum of tau is given.
/// Vectors hold all x first, then all y. Tractions in any unit, displacements as lac_shear_space.
typedef struct lac_shear_problem {
    lac_shear_space *space;
    size_t n;             ///< contact cells
    const uint32_t *cell; ///< [n] index in the grid
    const double *limit;  ///< [n] f p > 0; all INFINITY: nothing ever slips
    const double *before; ///< [2n] u0, displacements before the step
    bool held[2];         ///< whether the load is given along an axis
    double load[2];       ///< where it is: sum of the tractions
    double shift[2];      ///< elsewhere given; where the load is, what it takes
    double tolerance;
    int64_t max_iterations;
    double *tau;      ///< [2n] first guess; the tractions
    double *u;        ///< [2n] C tau, a fresh product
    uint8_t *limited; ///< [n] whether |tau| = limit
    double scale;     ///< unit of displacements that the residual is relative to
    double residual;  ///< worst cell: slip where it sticks, slip not along tau where it slips
    int64_t iterations, products;
} lac_shear_problem;

/// The fields of u of all cells are in space->fft[axis]->real at the end, where used.
lac_status lac_shear_solve(lac_shear_problem *p, lac_error *err);

/// tau_i = the point of the disc of radius limit_i nearest to y_i + lambda; lambda, a first guess,
/// is such that tractions sum to `load` along the axes held. `limited`: y_i + lambda lies outside.
void lac_shear_project(const lac_shear_problem *p, const double *y, double *tau, uint8_t *limited,
                       double lambda[2]);
