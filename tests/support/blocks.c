// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/blocks.h"

#include "support/trees.h"

static void point(test_blocks *t, size_t levels)
{
    for (size_t level = 0; level <= levels; level++) {
        t->pointer[level] = t->first[level];
    }
    t->blocks = (lac_rg_blocks){levels, t->count, t->pointer};
}

void blocks_draw(test_blocks *t, uint64_t seed)
{
    size_t n = (size_t)draw_log(seed, 1, 1.0, BLOCKS_CELLS + 1);
    size_t level = 0;
    t->count[0] = n;
    for (size_t i = 0; i <= n; i++) {
        t->first[0][i] = (uint32_t)i;
    }
    // Blocks of a level end where some of those below do; the last level holds everything.
    while (t->count[level] > 1 || draw_uniform(seed, 50 + level, 0, 1) < 0.3) {
        double keep = level + 2 > BLOCKS_LEVELS ? 0.0 : draw_uniform(seed, 100 + level, 0, 1);
        size_t m = 0;
        t->first[level + 1][0] = 0;
        for (size_t b = 1; b <= t->count[level]; b++) {
            double u = draw_uniform(seed, 1000 * (level + 1) + b, 0, 1);
            if (u < keep || b == t->count[level]) {
                t->first[level + 1][++m] = t->first[level][b];
            }
        }
        t->count[++level] = m;
        if (level == BLOCKS_LEVELS) {
            break;
        }
    }
    point(t, level);
}

typedef struct relabelling {
    const test_blocks *from;
    test_blocks *to;
    uint64_t seed;
    uint32_t *cell;
    uint32_t cells;
} relabelling;

// Lists the cells of a block, its children in a random order.
static void list(relabelling *r, size_t level, uint32_t begin, uint32_t end)
{
    r->to->first[level][r->to->count[level]++] = r->cells;
    if (level == 0) {
        r->cell[r->cells++] = begin;
        return;
    }
    uint32_t start[BLOCKS_CELLS + 1];
    uint32_t stop[BLOCKS_CELLS + 1];
    size_t n = 0;
    for (size_t b = 0; b < r->from->count[level - 1]; b++) {
        if (r->from->first[level - 1][b] >= begin && r->from->first[level - 1][b] < end) {
            size_t at = (size_t)draw_uniform(r->seed, 100 * level + b, 0, (double)n + 1);
            start[n] = start[at];
            stop[n++] = stop[at];
            start[at] = r->from->first[level - 1][b];
            stop[at] = r->from->first[level - 1][b + 1];
        }
    }
    for (size_t i = 0; i < n; i++) {
        list(r, level - 1, start[i], stop[i]);
    }
}

void blocks_relabel(const test_blocks *from, uint64_t seed, test_blocks *to, uint32_t *cell)
{
    relabelling r = {from, to, seed, cell, 0};
    const size_t levels = from->blocks.levels;
    for (size_t level = 0; level <= levels; level++) {
        to->count[level] = 0;
    }
    list(&r, levels, 0, (uint32_t)from->count[0]);
    for (size_t level = 0; level <= levels; level++) {
        to->first[level][to->count[level]] = r.cells;
    }
    point(to, levels);
}
