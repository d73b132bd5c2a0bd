/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TRANSFER_KERNELS_H
#define LACUNA_TRANSFER_KERNELS_H

#include "base/fft.h"
#include "base/grid.h"

/// The rock on both sides of an interface.
typedef struct lac_rock {
    double shear_modulus; ///< G [Pa], > 0
    double poisson;       ///< nu [1], < 1; 0 where antiplane
    double thickness; ///< of a slab on either side, its far face rigid [m]; INFINITY: half-space
    bool antiplane;   ///< the scalar problem; differs from nu = 0 in slabs only
    bool line;        ///< a row of cells is a line in plane strain or antiplane, not a strip
    bool creeping;    ///< beyond a free border slip is uniform instead of free of traction
    bool measure;     ///< transforms are planned by measuring
} lac_rock;

/// Tables for lac_fft_filter, [nkx * ny] by columns, with the 1/N of the transforms.
/// @param stiffness   S of each mode; creeping: of slip uniform on each cell of a doubled grid
/// @param compliance  1/S, 0 where S is 0; free: of traction uniform on each cell
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_kernels_fill(lac_fft *fft, const lac_grid *grid, const lac_rock *rock,
                            double *stiffness, double *compliance, lac_error *err);

#endif
