/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/team.h"

enum {
    LAC_RANGE_BLOCKS = 256,       ///< of all cells, at most
    LAC_RANGE_BLOCK_LEAST = 4096, ///< cells of a block
    LAC_RANGE_ALONE = 1 << 16,    ///< fewer cells are one block: ranks gain next to nothing there
    LAC_RANGE_PIECE = 1 << 20     ///< cells that the leading rank has of others at once
};

/// The cells of a case that are worked on here, and how sums over all of them are made: in blocks
/// that the number of all cells fixes, one after the other. So they have the same bits for any
/// number of threads, and of processes that have some blocks each.
typedef struct lac_range {
    size_t all;     ///< cells of the case
    size_t first;   ///< the first of those here, which begins a block
    size_t n;       ///< those here
    size_t block;   ///< cells of a block; the last one may have fewer
    lac_team *team; ///< who has the others; NULL: all are here
} lac_range;

/// Blocks of all cells.
static inline size_t lac_range_blocks(const lac_range *range)
{
    return (range->all + range->block - 1) / range->block;
}

/// All of so many cells.
lac_range lac_range_whole(size_t all);

/// Those of a rank of a team: as many blocks as of any other, or one fewer; all without a team.
lac_range lac_range_of(lac_team *team, int rank, size_t all);

/// Values first ... first + n - 1 of all, to the rank that leads; of a range of ranks.
/// @param x    [n here]
/// @param out  [n] there
void lac_range_bring(const lac_range *range, const double *x, size_t first, size_t n, double *out);

/// Takes the next n values of an array of all cells.
typedef void lac_range_take(void *context, double *x, size_t n);

/// Hands arrays of the cells, those of one after the other, to the rank that leads: piece by piece,
/// so that it needs no room for all. @param x  [arrays][n]
/// @return false, on all ranks: memory is short
bool lac_range_hand(const lac_range *range, double *x, size_t arrays, lac_range_take *take,
                    void *context);

enum { LAC_RANGE_SUMS = 3 };

/// Adds to sums what the cells first ... end - 1 give, counted from the first one here.
typedef void lac_range_body(const void *context, size_t first, size_t end, double *sums);

// What follows where the cells are not one block here.
void lac_range_join(const lac_range *range, size_t values, lac_range_body *body,
                    const void *context, double *sums);

/// Sums over all cells of so many values (at most LAC_RANGE_SUMS), in one pass over them.
/// @param sums  [values] overwritten
static inline void lac_range_sums(const lac_range *range, size_t values, lac_range_body *body,
                                  const void *context, double *sums)
{
    for (size_t k = 0; k < values; k++) {
        sums[k] = 0.0;
    }
    if (range->all <= range->block && range->team == NULL) {
        body(context, 0, range->n, sums);
    } else {
        lac_range_join(range, values, body, context, sums);
    }
}

/// Sum of x. @param x  [n]
double lac_range_sum(const lac_range *range, const double *x);
