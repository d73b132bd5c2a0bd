/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LOAD_DIFFUSED_H
#define LACUNA_LOAD_DIFFUSED_H

#include "load/lagged.h"

/// What comes of a pressure p(t) of straight pieces at the face of a half-space, at a depth in it.
typedef struct lac_diffused {
    size_t n;
    double first; ///< p before the first piece, everywhere at rest [Pa]
    double *t;    ///< [n] where p bends [s], rising
    double *bend; ///< [n] by how much its slope changes there [Pa/s]
    double time;  ///< distance^2/(4 diffusivity) [s]
} lac_diffused;

/// The half-space under the drive of `face`, which must be continuous.
/// @param distance, diffusivity  [m], [m2/s], > 0
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_diffused_create(const lac_lagged *face, double distance, double diffusivity,
                               lac_diffused *out, lac_error *err);

/// Exact pressure and its rate: sums of the answer to one bend.
/// A unit step answers with erfc(x), x = distance/sqrt(4 D t) (Carslaw & Jaeger 1959, 2.4), hence a
/// unit ramp with t [(1 + 2x^2) erfc(x) - 2 x exp(-x^2)/sqrt(pi)].
/// @cost  O(bends so far)
lac_signal lac_diffused_at(const lac_diffused *diffused, double t);

void lac_diffused_clear(lac_diffused *diffused);

#endif
