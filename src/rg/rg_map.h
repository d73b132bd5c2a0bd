/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stddef.h>

#include "base/fail.h"

/// The renormalization map s' = S(s) of the slipped fraction from a level to the next, fitted by
/// logit s' = lambda logit s + g, so that S(0) = 0 and S(1) = 1.
typedef struct lac_rg_map {
    size_t points;      ///< pairs (s, s') with both between 0.05 and 0.95
    double lambda;      ///< slope at the fixed point, in logits as in s [1]
    double g;           ///< [1]
    double fixed_point; ///< C, the unstable one [1]; NaN where lambda is not > 1
    double nu;          ///< exponent of the correlation length, ln 2 / ln lambda; NaN likewise
    double residual;    ///< rms of the fit, in logits
} lac_rg_map;

/// Fits the map to pairs (s, s').
lac_status lac_rg_map_fit(size_t n, const double *s, const double *s_next, lac_rg_map *map,
                          lac_error *err);
