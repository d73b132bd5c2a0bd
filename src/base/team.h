/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

enum { LAC_TEAM_MOST = 256 }; ///< ranks: as many as there are blocks of cells at most

/// Bytes that go to a rank, or come from it.
typedef struct lac_piece {
    void *at;
    size_t n;
} lac_piece;

/// Processes that work on one case, each on its part of the cells. NULL: one alone. Every function
/// is called by all of them, in the same order.
typedef struct lac_team {
    int rank, ranks;
    void *context;
    /// Each word becomes the bitwise or of those of all ranks: what one of them fills, the others
    /// having 0 there, comes to all to the bit.
    void (*join)(const struct lac_team *team, uint64_t *words, size_t n);
    /// Hands give[rank] to each rank and takes take[rank] from it.
    void (*exchange)(const struct lac_team *team, const lac_piece *give, const lac_piece *take);
    /// As join of a word of each rank, by which they agree: one with an error does not wait for
    /// ever where others wait for something else, but ends all. NULL: join.
    void (*fare)(const struct lac_team *team, uint64_t *words, lac_status here,
                 const lac_error *err);
    bool over; ///< all know of an error: there is nothing more to agree on
} lac_team;

/// Whether this is the process that speaks and writes.
static inline bool lac_team_leads(const lac_team *team) { return team == NULL || team->rank == 0; }

/// The same of numbers: of those of all ranks, where each rank has some and the others 0.
void lac_team_join(const lac_team *team, double *x, size_t n);

/// What rank 0 has of a word of 8 bytes, to all.
void lac_team_follow(const lac_team *team, void *word);

/// One rank after the other goes on with the values where the one before has left them: what one
/// process does along all rows, to the bit. All have them then.
typedef void lac_team_part(void *context, double *values);
void lac_team_relay(const lac_team *team, lac_team_part *part, void *context, double *values,
                    size_t n);

/// Whether it is so with any, or with all of them; the largest and the least, NaN where one is.
bool lac_team_any(const lac_team *team, bool here);
static inline bool lac_team_all(const lac_team *team, bool here)
{
    return !lac_team_any(team, !here);
}
double lac_team_most(const lac_team *team, double here);
static inline double lac_team_least(const lac_team *team, double here)
{
    return -lac_team_most(team, -here);
}

/// The error of the lowest rank that has one, to all, with its message.
/// @return LAC_OK where all have that
lac_status lac_team_agree(lac_team *team, lac_status here, lac_error *err);

/// Zeros that each needs before what they do together. NULL, to all: one of them has no room.
void *lac_team_alloc(lac_team *team, size_t bytes);
