/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>

#include "base/fft.h"
#include "base/grid.h"

/// Two equal elastic half-spaces sheared against each other, on one grid. Lengths are in units of
/// the longest side, so that displacements come out in units of traction * length / (pi (1-nu) E*).
/// Free grids sit in the corner of a transform twice as long.
typedef struct lac_shear_space {
    size_t nx, ny;
    double length;     ///< longest side [m]
    lac_fft *fft[2];   ///< x and y; rows of real are fft->nx long
    bool used[2];      ///< axes that carry anything; both where they are coupled
    double *xx;        ///< [ny * nkx]; nu = 0: [nkx * ny] by columns, of both axes
    double *yy, *xy;   ///< [ny * nkx]; nu = 0: NULL, the axes are not coupled
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
