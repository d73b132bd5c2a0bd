/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "hierarchy/hierarchy.h"

enum { LAC_MAX_LEVELS = 32 }; ///< grid coordinates have 32 bits

/// One distinct partition of the contact cells into blocks. Levels between which no blocks merge
/// share a partition: chains of blocks with a single child cost nothing.
typedef struct lac_partition {
    uint32_t count;         ///< blocks
    uint32_t whole;         ///< blocks of the next partition whose children may be read four at
                            ///< a time without passing the end of this one
    uint32_t singles;       ///< blocks of the next partition with a single child
    size_t level;           ///< the last level with this partition: k[level] ties it to the next
    const uint32_t *first;  ///< [count + 1] first contact cell of each block, and n
    const uint32_t *parent; ///< [count] block of the next partition; NULL at the root
    const uint32_t *child;  ///< [next count + 1] first block of each block of the next partition
    const uint32_t *single; ///< [singles] those with a single child
} lac_partition;

struct lac_hierarchy {
    size_t cells, levels;
    size_t partitions;                    ///< >= 1; the last is the root
    size_t blocks;                        ///< over all partitions but the cells
    uint8_t of_level[LAC_MAX_LEVELS + 1]; ///< partition of each level
    lac_partition part[LAC_MAX_LEVELS + 1];
    uint32_t *memory; ///< what the partitions point into
};

/// lac_is_child[c][i] = 1 where i < c, the number of children; else 0.
extern const double lac_is_child[5][4];
