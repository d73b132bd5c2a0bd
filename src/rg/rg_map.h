/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RG_RG_MAP_H
#define LACUNA_RG_RG_MAP_H

#include <stddef.h>

#include "lacuna/error.h"

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
/// @return LAC_OK; LAC_EINPUT where fewer than three pairs lie in the range, or all at one s
lac_status lac_rg_map_fit(size_t n, const double *s, const double *s_next, lac_rg_map *map,
                          lac_error *err);

/// S(s) of a fitted map.
double lac_rg_map_at(const lac_rg_map *map, double s);

/// The unstable fixed point of a map that is known in closed form, and the exponent there.
typedef struct lac_rg_closure {
    double fixed_point; ///< between 0 and 1; NaN where there is none
    double lambda;      ///< slope of the map there
    double nu;          ///< ln b / ln lambda of blocks of b = 2 points a side
} lac_rg_closure;

/// A block of n points of one strength that slips where at least k of them do:
/// s' = sum_{j >= k} C(n, j) s^j (1 - s)^(n - j). With rule LUMP and equal loads x, k is the least
/// number whose drops bring the others down: x + h_k (1 - beta) >= 1, h_k = sum_{j <= k} 1/(n - j).
/// @return LAC_OK; LAC_EINPUT (not 1 <= k <= n <= 64)
lac_status lac_rg_closure_points(size_t n, size_t k, lac_rg_closure *closure, lac_error *err);

/// A block of n points with Weibull strengths of modulus m that share the load in equal parts;
/// p -> the probability that all fail.
/// @return LAC_OK; LAC_EINPUT (not 2 <= n <= 16, m not > 0)
/// @source Smalley, Turcotte and Solla (1985), J. Geophys. Res. 90, 1894
lac_status lac_rg_closure_weibull(size_t n, double m, lac_rg_closure *closure, lac_error *err);

/// The probability that each of n ordered uniform numbers lies below its bound: of a block of n
/// points, that all fail, one after the other.
/// @param bound  [n] ascending, of the smallest number first
/// @source Daniels (1945), Proc. R. Soc. A 183, 405; as a recursion, g_n = sum_{j < n}
///         (-1)^(n - j + 1) C(n, j) bound_j^(n - j) g_j
double lac_rg_all_below(size_t n, const double *bound);

#endif
