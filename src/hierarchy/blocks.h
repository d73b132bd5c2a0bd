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
    uint32_t last;          ///< the first cell of those that cannot, where all cells are here
    uint32_t singles;       ///< blocks of the next partition with a single child
    size_t level;           ///< the last level with this partition: k[level] ties it to the next
    const uint32_t *first;  ///< [count + 1] first contact cell of each block, and n
    const uint32_t *parent; ///< [count] block of the next partition; NULL at the root
    const uint32_t *child;  ///< [next count + 1] first block of each block of the next partition
    const uint32_t *single; ///< [singles] those with a single child
} lac_partition;

/// A block at the border of what a rank has, which others have a part of.
typedef struct lac_edge {
    uint32_t here; ///< its place in its partition here
    uint32_t top;  ///< and among the blocks of all partitions of the top but the leaves
} lac_edge;

/// What a rank knows of the blocks of the others: the top, over the largest blocks that each of
/// them has whole, the leaves. All ranks have it alike.
typedef struct lac_split {
    lac_team *team;
    lac_hierarchy *top;                ///< its cells are the leaves
    size_t first, own;                 ///< leaves of this rank
    size_t *leaf;                      ///< [own] a cell here, or cells + block of any partition
    uint8_t edges[LAC_MAX_LEVELS + 1]; ///< of each partition
    lac_edge edge[LAC_MAX_LEVELS + 1][2];
} lac_split;

struct lac_hierarchy {
    size_t cells, levels;
    size_t partitions;                    ///< >= 1; the last is the root
    size_t blocks;                        ///< over all partitions but the cells
    uint8_t of_level[LAC_MAX_LEVELS + 1]; ///< partition of each level
    lac_partition part[LAC_MAX_LEVELS + 1];
    size_t room;      ///< blocks that the weights of a solve take: of any partition
    bool heaped;      ///< the cells are blocks of several themselves
    uint32_t *memory; ///< what the partitions point into
    lac_split *split; ///< what others have; NULL: all is here
};

/// Builds the blocks over cells of which merge[i] is the level at which cell i comes into the block
/// of cell i - 1: in Morton order the blocks of level l are the runs of cells with merge <= l.
lac_status lac_hierarchy_build(size_t cells, size_t levels, const uint8_t *merge,
                               lac_hierarchy **out, lac_error *err);

/// Links a partition to the next: parents, children, and which blocks have a single child; of a
/// part, the children that are here. @return what it leaves of the memory
uint32_t *lac_hierarchy_link(lac_partition *fine, const lac_partition *coarse, uint32_t *memory);

/// lac_is_child[c][i] = 1 where i < c, the number of children; else 0.
extern const double lac_is_child[5][4];
