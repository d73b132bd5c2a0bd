/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/range.h"
#include "contact/contact.h"

/// The blocks over the contact cells, scale by scale: a level-l block is a 2^l x 2^l square of
/// the grid (2^l cells of a line) and exists only if it holds a contact cell. Immutable.
typedef struct lac_hierarchy lac_hierarchy;

/// Builds the blocks over a domain; level 0 is the contact cells, level m the one root.
/// 2^m is the smallest power of two that covers the grid.
lac_status lac_hierarchy_create(const lac_domain *domain, lac_hierarchy **out, lac_error *err);
void lac_hierarchy_free(lac_hierarchy *h);

/// The part of it that a range of the cells of a team is: apply and solve are of these cells, to
/// the bits that the whole gives. Of all other functions only lac_hierarchy_work counts.
/// @param whole  of all cells; must outlive it
lac_status lac_hierarchy_split(const lac_hierarchy *whole, const lac_range *range,
                               lac_hierarchy **out, lac_error *err);

/// Contact cells n; m, the number of stiffnesses k_0 ... k_{m-1}, 0 for a single block; occupied
/// blocks of a level, 0 <= level <= m; and the rank of P_l - P_{l+1}, blocks(l) - blocks(l+1).
size_t lac_hierarchy_cells(const lac_hierarchy *h);
size_t lac_hierarchy_levels(const lac_hierarchy *h);
size_t lac_hierarchy_blocks(const lac_hierarchy *h, size_t level);
size_t lac_hierarchy_rank(const lac_hierarchy *h, size_t level);

/// First contact cell of each block of a level, and n at the end: [blocks(level) + 1].
const uint32_t *lac_hierarchy_offsets(const lac_hierarchy *h, size_t level);

/// Block of the next level that each block of a level lies in, where the two levels differ:
/// [blocks(level)].
const uint32_t *lac_hierarchy_parents(const lac_hierarchy *h, size_t level);

/// Doubles of scratch that apply and solve need.
size_t lac_hierarchy_work(const lac_hierarchy *h);

/// y = K x with K = sum_l k_l (P_l - P_{l+1}); docs/theory/transfer.md. x and y do not overlap.
void lac_hierarchy_apply(const lac_hierarchy *h, const double *k, const double *x, double *y,
                         double *work);

/// Solves (D + K + k_mean P_m) x = y exactly; x may be y, D negative where K makes up for it.
/// False where a pivot is not finite and positive. Where true, the matrix is positive definite; the
/// converse holds where k falls with the level down to k_mean.
bool lac_hierarchy_solve(const lac_hierarchy *h, const double *k, double k_mean,
                         const double *diagonal, const double *y, double *x, double *work);

/// The same where each cell has two unknowns, along x and y: D has symmetric 2 x 2 blocks, and each
/// direction stiffnesses k of its own.
/// @param k         [2] of each direction, [levels]
/// @param diagonal  [3] D of each cell: xx, xy, yy, [cells]
/// @param x         [2] the right-hand side, and the solution in its place, [cells]
/// @param work      of lac_hierarchy_pair_work doubles
bool lac_hierarchy_solve_pair(const lac_hierarchy *h, const double *const k[2], double k_mean,
                              const double *const diagonal[3], double *const x[2], double *work);
size_t lac_hierarchy_pair_work(const lac_hierarchy *h);
