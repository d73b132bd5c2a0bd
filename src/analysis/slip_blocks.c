// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks that slip as a whole, counted at every level while single cells begin and cease to slip.
#include "analysis/slip_blocks.h"

#include <stdlib.h>

// Tiers, and the entries that the tables of all need.
static size_t number_tiers(const lac_hierarchy *h, lac_slip_blocks *b)
{
    size_t entries = 0;
    b->tiers = 1;
    b->tier[0] = 0;
    for (size_t level = 1; level <= b->levels; level++) {
        if (lac_hierarchy_blocks(h, level) < lac_hierarchy_blocks(h, level - 1)) {
            entries += lac_hierarchy_blocks(h, level);
            b->tiers++;
        }
        b->tier[level] = b->tiers - 1;
    }
    return entries;
}

lac_status lac_slip_blocks_create(const lac_hierarchy *h, lac_slip_blocks *out, lac_error *err)
{
    const size_t levels = lac_hierarchy_levels(h);
    *out = (lac_slip_blocks){.levels = levels};
    out->tier = malloc((levels + 1) * sizeof *out->tier);
    out->slipping = calloc(levels + 1, sizeof *out->slipping);
    out->parent = calloc(levels + 1, sizeof *out->parent);
    out->sticking = calloc(levels + 1, sizeof *out->sticking);
    size_t entries = out->tier != NULL ? number_tiers(h, out) : 0;
    out->memory = calloc(entries + 1, sizeof *out->memory);
    if (out->tier == NULL || out->slipping == NULL || out->parent == NULL ||
        out->sticking == NULL || out->memory == NULL) {
        lac_slip_blocks_clear(out);
        return lac_fail_memory(err);
    }
    uint32_t *next = out->memory;
    for (size_t level = 0; level < levels; level++) {
        size_t t = out->tier[level];
        if (out->tier[level + 1] == t) {
            continue;
        }
        out->parent[t] = lac_hierarchy_parents(h, level);
        out->sticking[t + 1] = next;
        next += lac_hierarchy_blocks(h, level + 1);
        for (size_t b = 0; b < lac_hierarchy_blocks(h, level); b++) {
            out->sticking[t + 1][out->parent[t][b]]++;
        }
    }
    return LAC_OK;
}

void lac_slip_blocks_clear(lac_slip_blocks *b)
{
    free(b->tier);
    free(b->slipping);
    free(b->parent);
    free(b->sticking);
    free(b->memory);
    *b = (lac_slip_blocks){0};
}

void lac_slip_blocks_change(lac_slip_blocks *b, uint32_t cell, bool slips)
{
    uint32_t block = cell;
    for (size_t t = 0;; t++) {
        b->slipping[t] += slips ? 1 : (size_t)-1;
        if (t + 1 == b->tiers) {
            return;
        }
        block = b->parent[t][block];
        uint32_t *sticking = &b->sticking[t + 1][block];
        // Only the last child that joins, or the first that leaves, changes the block itself.
        if (slips ? --*sticking > 0 : (*sticking)++ > 0) {
            return;
        }
    }
}
