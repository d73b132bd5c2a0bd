/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_BLOCKS_H
#define LACUNA_TESTS_BLOCKS_H

#include "rg/rg.h"

enum { BLOCKS_CELLS = 64, BLOCKS_LEVELS = 12 };

/// A small tree of blocks with any number of children.
typedef struct test_blocks {
    size_t count[BLOCKS_LEVELS + 1];
    uint32_t first[BLOCKS_LEVELS + 1][BLOCKS_CELLS + 1];
    const uint32_t *pointer[BLOCKS_LEVELS + 1];
    lac_rg_blocks blocks; ///< points into the above: not to be copied
} test_blocks;

/// A random tree of 1 ... BLOCKS_CELLS cells: chains, fans and single cells included.
void blocks_draw(test_blocks *t, uint64_t seed);

/// The same tree with the children of every block in another order.
/// @param cell  [cells] of each cell its number in `from`
void blocks_relabel(const test_blocks *from, uint64_t seed, test_blocks *to, uint32_t *cell);

#endif
