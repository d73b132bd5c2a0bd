/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RG_TREE_H
#define LACUNA_RG_TREE_H

#include "rg/rg.h"

enum { LAC_RG_LEVELS = 40 };

/// One set of blocks. Levels between which no blocks merge share it.
typedef struct lac_rg_layer {
    size_t count;
    uint32_t *child;  ///< [count + 1] first block of each in the layer below; NULL: the cells
    double *cells;    ///< [count] contact cells in each
    double *strength; ///< [count] their summed strength
    double *drop;     ///< [count] their summed drop
    double *shear;    ///< [count] their summed traction
    double *gap;      ///< [count] threshold
    double *received; ///< [count] stress that came from siblings, of the pass down
} lac_rg_layer;

/// A child of the block at hand, with what decides its turn.
typedef struct lac_rg_child {
    double gap, strength;
    uint32_t block;
} lac_rg_child;

struct lac_rg_tree {
    size_t levels, layers;
    uint8_t of_level[LAC_RG_LEVELS + 1];
    lac_rg_layer layer[LAC_RG_LEVELS + 1];
    lac_rg_child *order; ///< [most children of a block]
    uint32_t *cell;      ///< [n] the caller's number of each cell; NULL: the same
    double *memory;
    uint32_t *links;
    double tolerance; ///< of a threshold [Pa]
    lac_rg_rule rule; ///< of the last pass
};

/// After a pass up: of each cell the level of the largest block around it that slips by itself, NaN
/// where none does.
/// @param level  [n] overwritten
void lac_rg_own_levels(lac_rg_tree *tree, double *level);

/// The pass up with rule LUMP, over the layers above the cells.
void lac_rg_lump(lac_rg_tree *tree);

#endif
