/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_HIERARCHY_HIERARCHY_H
#define LACUNA_HIERARCHY_HIERARCHY_H

#include "contact/contact.h"

/// The blocks over the contact cells, scale by scale: a level-l block is a 2^l x 2^l square of
/// the grid (2^l cells of a line) and exists only if it holds a contact cell. Immutable.
typedef struct lac_hierarchy lac_hierarchy;

/// Builds the blocks over a domain; level 0 is the contact cells, level m the one root.
/// 2^m is the smallest power of two that covers the grid.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_hierarchy_create(const lac_domain *domain, lac_hierarchy **out, lac_error *err);

/// Frees a hierarchy; NULL is fine.
void lac_hierarchy_free(lac_hierarchy *h);

/// Contact cells n.
size_t lac_hierarchy_cells(const lac_hierarchy *h);

/// m: the number of stiffnesses k_0 ... k_{m-1}; 0 for a single block.
size_t lac_hierarchy_levels(const lac_hierarchy *h);

/// Occupied blocks of a level, 0 <= level <= m.
size_t lac_hierarchy_blocks(const lac_hierarchy *h, size_t level);

/// Rank of P_l - P_{l+1}: blocks(l) - blocks(l+1).
size_t lac_hierarchy_rank(const lac_hierarchy *h, size_t level);

/// First contact cell of each block of a level, and n at the end: [blocks(level) + 1].
const uint32_t *lac_hierarchy_offsets(const lac_hierarchy *h, size_t level);

/// Doubles of scratch that apply and solve need.
size_t lac_hierarchy_work(const lac_hierarchy *h);

/// y = K x with K = sum_l k_l (P_l - P_{l+1}); docs/theory/transfer.md.
/// @param k     [m] stiffness of each level [Pa/m]
/// @param x     [n] slip [m]
/// @param y     [n] stress taken off each cell [Pa]; overwritten
/// @param work  [lac_hierarchy_work] scratch
/// @pre   x and y do not overlap
/// @cost  O(n): one pass up, one pass down; allocates nothing; cannot fail
void lac_hierarchy_apply(const lac_hierarchy *h, const double *k, const double *x, double *y,
                         double *work);

/// Solves (D + K + k_mean P_m) x = y exactly.
/// @param k         [m] stiffness of each level [Pa/m]
/// @param k_mean    stiffness of the mean mode (springs) [Pa/m]
/// @param diagonal  [n] D [Pa/m]; may be negative where K makes up for it
/// @param y         [n] right-hand side
/// @param x         [n] solution; overwritten; may be y itself
/// @param work      [lac_hierarchy_work] scratch
/// @return false where a pivot is not finite and positive, x is then undefined. Where true, the
///         matrix is positive definite; the converse holds where k falls with the level down to
///         k_mean, else a positive definite matrix with D_i <= -k_l may be refused as well
/// @cost   O(n): one pass up, one pass down; allocates nothing
bool lac_hierarchy_solve(const lac_hierarchy *h, const double *k, double k_mean,
                         const double *diagonal, const double *y, double *x, double *work);

#endif
