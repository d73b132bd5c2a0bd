/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_HALF_SPACE_H
#define LACUNA_TESTS_HALF_SPACE_H

#include "contact/contact.h"

/// Rock on both sides of an interface, for references that share no code with the library.
typedef struct rock_def {
    double g, nu;  ///< shear modulus, Poisson's ratio (0: antiplane)
    double height; ///< of the slab on either side; INFINITY: half-space
    bool line;     ///< where it does not repeat: a line, not a strip
} rock_def;

/// Stiffness of wave (p, q) of slip along x on the grid's torus; slabs by integration through their
/// thickness.
double wave_stiffness(const rock_def *rock, const lac_grid *grid, size_t p, size_t q);

/// Dense K: the slip under unit traction on each cell, summed over all waves or, where the grid
/// does not repeat, by quadrature, inverted by elimination, the mean slip left free unless slabs
/// hold it.
/// @param dense  [n * n]; overwritten
void dense_elastic(const rock_def *rock, const lac_domain *domain, double *dense);

/// Traction taken off at (x, y) by unit slip along x of a cell of dx by dy in the full space, by
/// quadrature of the point's; a line's where dy is 0.
double held_traction(const rock_def *rock, double dx, double dy, double x, double y);

/// The same between two cells below a free surface: of a line, beside its first cell, with the
/// mirror image; of an upright plane, beside its first row, by differences of Okada's displacements
/// (1992, Bull. Seismol. Soc. Am. 82, 1018, table 6), the mean of either way.
double traction_below_surface(const rock_def *rock, const lac_grid *grid, size_t a, size_t b);

#endif
