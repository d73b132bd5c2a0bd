/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/team.h"

/// The rows of a grid that a rank has, in grains of some rows; or the columns.
typedef struct lac_strip {
    lac_team *team;            ///< who has the others; NULL: all are here
    size_t all, grain, grains; ///< rows; in how many grains of how many they are handed out
    size_t first, n;           ///< those here
} lac_strip;

/// Those of this rank: as many grains as of any other, or one fewer; all without a team.
lac_strip lac_strip_of(lac_team *team, size_t all, size_t grain);

/// The rows of a field: in pairs, as transforms take them.
static inline lac_strip lac_strip_rows(lac_team *team, size_t ny)
{
    return lac_strip_of(team, ny, 2);
}

/// The same grains with other numbers of rows.
lac_strip lac_strip_like(const lac_strip *strip, size_t all, size_t grain);

/// Those of a rank.
lac_strip lac_strip_at(const lac_strip *strip, int rank);

/// To each rank the rows that it wants, whoever has them. @param wants  [ranks] first row and
/// number
/// @param rows  those here, of `size` bytes each
/// @param out   [wanted here]
void lac_strip_exchange(const lac_strip *strip, const uint64_t wants[][2], size_t size,
                        const void *rows, void *out);

/// Rows first ... first + n - 1 of all, whoever has them; called by all ranks, each for its own.
/// @param made  set to what the caller frees
/// @return without a team a part of rows; NULL, to all: memory is short
const void *lac_strip_bring(const lac_strip *strip, size_t first, size_t n, size_t size,
                            const void *rows, void **made);

/// Sum of n of each rank's, each over so many, and mean of all rows of nx: to the bits of one.
double lac_strip_sum(const lac_strip *strip, size_t n, const double *x, double over);
static inline double lac_strip_mean(const lac_strip *strip, size_t nx, const double *x)
{
    return lac_strip_sum(strip, strip->n * nx, x, (double)(strip->all * nx));
}

/// A matrix whose rows are in strips; each rank works on some of its columns, grain by grain.
typedef struct lac_turn {
    lac_strip rows;
    size_t lead;                 ///< of the plane: from column to column; 0: it has rows of a grain
    char *packet, *come, *plane; ///< what is sent, and what came
} lac_turn;

/// What is done to columns first ... first + width - 1.
typedef struct lac_turn_use {
    void *context;
    /// Those of the rows here: [width][rows here]. NULL: of doubles, they are in `matrix`.
    /// @param back  the other way
    void (*pack)(void *context, size_t first, size_t width, void *packet, bool back);
    void *matrix; ///< [rows here][stride] items
    size_t stride;
    /// All their rows: [width][lead], or [rows][grain].
    void (*work)(void *context, size_t first, size_t width, void *plane);
    bool returns; ///< the columns come back
} lac_turn_use;

/// @param grain_bytes  of an item, times the columns of a grain, at most
lac_status lac_turn_create(const lac_strip *rows, size_t lead, size_t grain_bytes, lac_turn **out,
                           lac_error *err);
void lac_turn_free(lac_turn *c);

/// @param columns  of which each rank has some
/// @param size     bytes of an item
void lac_turn_pass(const lac_turn *c, const lac_strip *columns, size_t size,
                   const lac_turn_use *use);
