/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/fft.h"
#include "contact/tangential.h"

/// Two equal elastic half-spaces sheared against each other, on one grid. Lengths are in units of
/// the longest side, so that displacements come out in units of traction * length / (pi (1-nu) E*).
/// Free grids sit in the corner of a transform twice as long.
typedef struct lac_shear_space {
    size_t nx, ny;
    double length;     ///< longest side [m]
    lac_fft *fft[2];   ///< x and y; rows of real are fft->nx long
    double *xx, *yy;   ///< [ny * nkx] of each axis by itself
    double *xy;        ///< [ny * nkx] what couples them
    double *stiffness; ///< [nkx * ny] |q|, by columns
    double self;       ///< displacement of a cell under its own unit traction, about
    double most;       ///< no traction is displaced by more than this times itself
} lac_shear_space;

lac_status lac_shear_space_create(const lac_grid *grid, double poisson, lac_shear_space **out,
                                  lac_error *err);
void lac_shear_space_free(lac_shear_space *s);

/// real -> C real of both axes; periodic: with the mean left out. All of real is read: nothing
/// pulls beyond a free grid.
void lac_shear_space_displace(lac_shear_space *s);

/// real -> |q| real of both axes: roughly the inverse of the above.
void lac_shear_space_unload(lac_shear_space *s);

/// x . C x of x = real by Parseval's theorem; real and spectrum are destroyed.
double lac_shear_space_energy(lac_shear_space *s);

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

/// The fields of u of all cells are in space->fft[axis]->real at the end.
lac_status lac_shear_solve(lac_shear_problem *p, lac_error *err);

/// tau_i = the point of the disc of radius limit_i nearest to y_i + lambda; lambda, a first guess,
/// is such that tractions sum to `load` along the axes held. `limited`: y_i + lambda lies outside.
void lac_shear_project(const lac_shear_problem *p, const double *y, double *tau, uint8_t *limited,
                       double lambda[2]);
