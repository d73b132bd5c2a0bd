/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/fft.h"
#include "contact/contact.h"

/// The rock on both sides of an interface.
typedef struct lac_rock {
    double shear_modulus; ///< G [Pa], > 0
    double poisson;       ///< nu [1], < 1; 0 where antiplane
    double thickness; ///< of a slab on either side, its far face rigid [m]; INFINITY: half-space
    bool antiplane;   ///< the scalar problem; differs from nu = 0 in slabs only
    bool line;        ///< a row of cells is a line in plane strain or antiplane, not a strip
    bool creeping;    ///< beyond a free border slip is uniform instead of free of traction
    bool surface;     ///< the rock ends at a free surface beside the first row; of a line, which is
                      ///< antiplane, beside the first cell; with creeping only
    bool measure;     ///< transforms are planned by measuring
    bool across;      ///< slip is along y, not x
    lac_team *team;   ///< the ranks that share the rows of a plane of many cells, and call all
                      ///< functions together; NULL: one alone
    bool cross;       ///< the stiffness is of traction along y under slip along x, of waves only
} lac_rock;

/// Tables for lac_fft_filter, [nkx * ny] by columns, with the 1/N of the transforms.
/// @param stiffness   S of each mode; creeping: of slip uniform on each cell of a doubled grid; of
/// a
///                    plane with a surface [nkx][ny][ny] for lac_fft_filter_rows
/// @param compliance  1/S, 0 where S is 0; free: of traction uniform on each cell; with
///                    a surface 0: it is not known
lac_status lac_kernels_fill(lac_fft *fft, const lac_grid *grid, const lac_rock *rock,
                            double *stiffness, double *compliance, lac_error *err);

/// The elastic half-spaces on both sides of a contact domain: traction of the contact cells ->
/// slip, along x, gaps free of traction; docs/theory/transfer.md, equations 9 to 12.
typedef struct lac_compliance lac_compliance;

/// Prepares the compliance of a domain. One that does not repeat is alone on the half-spaces, a row
/// of cells too: a strip unless the rock says that it is a line; a periodic row is one anyway.
/// Holds the buffers of its transforms: for one thread at a time.
lac_status lac_compliance_create(const lac_domain *domain, const lac_rock *rock,
                                 lac_compliance **out, lac_error *err);
void lac_compliance_free(lac_compliance *c);

/// slip = C traction, equation 9. @param traction, slip  [n]; may be the same array
void lac_compliance_slip(lac_compliance *c, const double *traction, double *slip);

/// traction = R F^-1 S F R^T slip: the slip held to 0 in the gaps; on full contact K itself.
void lac_compliance_traction(lac_compliance *c, const double *slip, double *traction);

/// Traction K slip that a slip of the contact cells needs, its mean left free (zero net force), and
/// the energy slip . K slip, by preconditioned conjugate gradients. They end where the last two
/// iterations added less than the tolerance to the energy, which is then good to about a tenth of
/// it.
lac_status lac_compliance_invert(lac_compliance *c, const double *slip, double tolerance,
                                 double *traction, double *energy, lac_error *err);
