/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "hierarchy/hierarchy.h"

/// Blocks of each level all of whose contact cells slip, kept up to date cell by cell. Levels
/// between which no blocks merge share a tier.
typedef struct lac_slip_blocks {
    size_t levels, tiers;    ///< levels above the cells; distinct ones, the cells' included
    size_t *tier;            ///< [levels + 1] of each level
    size_t *slipping;        ///< [tiers] blocks that slip as a whole
    const uint32_t **parent; ///< [tiers - 1] of [blocks]: block of the next tier; the hierarchy's
    uint32_t **sticking;     ///< [tiers]; [0] is NULL, else of [blocks]: children that do not slip
    uint32_t *memory;
} lac_slip_blocks;

/// All cells stick. The hierarchy must outlive them.
lac_status lac_slip_blocks_create(const lac_hierarchy *h, lac_slip_blocks *out, lac_error *err);
void lac_slip_blocks_clear(lac_slip_blocks *b);

/// A cell begins to slip or ceases.
void lac_slip_blocks_change(lac_slip_blocks *b, uint32_t cell, bool slips);

/// N_slip of a level.
static inline size_t lac_slip_blocks_at(const lac_slip_blocks *b, size_t level)
{
    return b->slipping[b->tier[level]];
}
