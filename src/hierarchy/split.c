// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a hierarchy that a rank has, and what it must know of the others: the blocks at its
// borders. A rank has whole blocks of the tree, and of those that borders cut a part; over the
// largest whole ones, the leaves, all ranks eliminate the same top.
#include "hierarchy/split.h"

// Where the ranks begin.
typedef struct borders {
    const lac_hierarchy *whole;
    size_t count;
    size_t cell[LAC_TEAM_MOST]; // the first of all ranks but those before which there are none
} borders;

static bool cut(const borders *at, size_t first, size_t end)
{
    for (size_t k = 0; k < at->count; k++) {
        if (first < at->cell[k] && at->cell[k] < end) {
            return true;
        }
    }
    return false;
}

// A leaf, by its place in the whole.
typedef struct leaf {
    size_t partition, block;
} leaf;

// Lists the leaves below a block from the n-th on; gives back how many there are then.
// @param out  NULL: they are counted
static size_t list_leaves(const borders *at, size_t partition, size_t block, size_t n, leaf *out)
{
    const lac_partition *part = &at->whole->part[partition];
    if (!cut(at, part->first[block], part->first[block + 1])) {
        if (out != NULL) {
            out[n] = (leaf){partition, block};
        }
        return n + 1;
    }
    for (uint32_t c = part[-1].child[block]; c < part[-1].child[block + 1]; c++) {
        n = list_leaves(at, partition - 1, c, n, out);
    }
    return n;
}

// The level at which two blocks are one.
static uint8_t meet(const lac_hierarchy *whole, leaf a, leaf b)
{
    while (a.partition != b.partition || a.block != b.block) {
        leaf *finer = a.partition <= b.partition ? &a : &b;
        finer->block = whole->part[finer->partition].parent[finer->block];
        finer->partition++;
    }
    return (uint8_t)(whole->part[a.partition - 1].level + 1);
}

// The blocks of the top begin at cells, not at leaves, and the last ones are those of the whole.
static void count_cells(const lac_hierarchy *whole, const leaf *leaves, lac_hierarchy *top)
{
    uint32_t *first = top->memory;
    for (size_t j = 0; j < top->partitions; j++) {
        top->part[j].last = whole->part[whole->of_level[top->part[j].level]].last;
        for (size_t i = 0; i <= top->part[j].count; i++, first++) {
            const leaf *of = &leaves[*first < top->cells ? *first : 0];
            *first = *first < top->cells ? whole->part[of->partition].first[of->block]
                                         : (uint32_t)whole->cells;
        }
    }
    top->heaped = true;
    top->room = top->blocks > top->cells ? top->blocks : top->cells;
}

static lac_status make_top(const lac_hierarchy *whole, const leaf *leaves, size_t n,
                           lac_hierarchy **out, lac_error *err)
{
    uint8_t *merge = calloc(n, sizeof *merge);
    LAC_FAIL_MEMORY_IF(merge == NULL, err);
    for (size_t i = 1; i < n; i++) {
        merge[i] = meet(whole, leaves[i - 1], leaves[i]);
    }
    const lac_status status = lac_hierarchy_build(n, whole->levels, merge, out, err);
    free(merge);
    if (status == LAC_OK) {
        count_cells(whole, leaves, *out);
    }
    return status;
}

// What of a partition is here: its blocks from `from` on.
typedef struct stretch {
    size_t from, count;
} stretch;

// @param at  of each partition; filled in
static lac_status take_part(const lac_hierarchy *whole, const lac_range *range, stretch *at,
                            lac_hierarchy *h, lac_error *err)
{
    size_t total = 1;
    at[0] = (stretch){range->first, range->n};
    for (size_t j = 0; j + 1 < whole->partitions; j++) {
        const uint32_t *parent = whole->part[j].parent + at[j].from;
        const size_t n = at[j].count, first = n > 0 ? parent[0] : 0;
        at[j + 1] = (stretch){first, n > 0 ? parent[n - 1] - first + 1 : 0};
        total += n + 2 * at[j + 1].count + 1;
    }
    uint32_t *next = h->memory = malloc(total * sizeof *next);
    LAC_FAIL_MEMORY_IF(next == NULL, err);
    h->cells = at[0].count;
    h->blocks = 0;
    for (size_t j = 0; j < whole->partitions; j++) {
        h->part[j].count = (uint32_t)at[j].count;
        h->part[j].first = whole->part[j].first + at[j].from;
        h->blocks += j > 0 ? at[j].count : 0;
    }
    for (size_t j = 0; j + 1 < whole->partitions; j++) {
        next = lac_hierarchy_link(&h->part[j], &h->part[j + 1], next);
    }
    h->room = h->blocks;
    return LAC_OK;
}

// Blocks of partitions 1 ... j - 1.
static size_t blocks_below(const lac_hierarchy *h, size_t j)
{
    size_t n = 0;
    for (size_t i = 1; i < j; i++) {
        n += h->part[i].count;
    }
    return n;
}

static void add_edge(const lac_hierarchy *h, const lac_range *range, size_t j, size_t block)
{
    lac_split *split = h->split;
    const uint32_t *first = h->part[j].first + block;
    if (first[0] >= range->first && first[1] <= range->first + range->n) {
        return;
    }
    const lac_hierarchy *top = split->top;
    const size_t there = top->of_level[h->part[j].level];
    size_t place = 0;
    while (top->part[there].first[place] != first[0]) {
        place++;
    }
    split->edge[j][split->edges[j]++] =
        (lac_edge){(uint32_t)block, (uint32_t)(blocks_below(top, there) + place)};
}

static lac_status place_leaves(const leaf *leaves, size_t n, const lac_range *range,
                               const stretch *at, lac_hierarchy *h, lac_error *err)
{
    lac_split *split = h->split;
    split->leaf = malloc((n + 1) * sizeof *split->leaf);
    LAC_FAIL_MEMORY_IF(split->leaf == NULL, err);
    for (size_t i = 0; i < n; i++) {
        const size_t j = leaves[i].partition, b = leaves[i].block;
        const bool here = at[j].count > 0 && b >= at[j].from && b < at[j].from + at[j].count;
        if (here) {
            split->first = split->own == 0 ? i : split->first;
            split->leaf[split->own++] =
                j == 0 ? b - at[0].from : h->cells + blocks_below(h, j) + (b - at[j].from);
        }
    }
    for (size_t j = 1; j < h->partitions; j++) { // the first and the last
        for (size_t b = 0; b<at[j].count; b += at[j].count> 1 ? at[j].count - 1 : 1) {
            add_edge(h, range, j, b);
        }
    }
    return LAC_OK;
}

lac_status lac_hierarchy_split(const lac_hierarchy *whole, const lac_range *range,
                               lac_hierarchy **out, lac_error *err)
{
    lac_status status = LAC_OK;
    borders at = {.whole = whole};
    stretch of[LAC_MAX_LEVELS + 1];
    leaf *leaves = NULL;
    lac_hierarchy *h = *out = malloc(sizeof *h);
    LAC_FAIL_MEMORY_IF(h == NULL, err);
    *h = *whole;
    h->memory = NULL;
    h->split = calloc(1, sizeof *h->split);
    LAC_TRY(h->split != NULL ? LAC_OK : lac_fail_memory(err));
    h->split->team = range->team;
    for (int k = 1; k < range->team->ranks; k++) {
        at.cell[at.count++] = lac_range_of(range->team, k, range->all).first;
    }
    LAC_TRY(take_part(whole, range, of, h, err));
    const size_t n = list_leaves(&at, whole->partitions - 1, 0, 0, NULL);
    if (n > 1) {
        leaves = malloc(n * sizeof *leaves);
        LAC_TRY(leaves != NULL ? LAC_OK : lac_fail_memory(err));
        (void)list_leaves(&at, whole->partitions - 1, 0, 0, leaves);
        LAC_TRY(make_top(whole, leaves, n, &h->split->top, err));
        LAC_TRY(place_leaves(leaves, n, range, of, h, err));
    }
out:
    free(leaves);
    LAC_MADE(status, out, lac_hierarchy_free);
}

void lac_split_free(lac_split *split)
{
    if (split != NULL) {
        lac_hierarchy_free(split->top);
        free(split->leaf);
        free(split);
    }
}

size_t lac_split_work(const lac_split *split)
{
    return split->top == NULL ? 0 : 3 * split->top->cells + 1 + lac_hierarchy_work(split->top);
}

bool lac_split_join(const lac_hierarchy *h, bool good, const lac_split_values *from, double *leaves)
{
    const lac_split *split = h->split;
    const size_t n = split->top->cells;
    memset(leaves, 0, (2 * n + 1) * sizeof *leaves);
    for (size_t i = 0; i < split->own; i++) {
        const size_t at = split->leaf[i];
        const bool cell = at < h->cells;
        for (int k = 0; k < 2 && from->cells[k] != NULL; k++) {
            leaves[(size_t)k * n + split->first + i] =
                cell ? from->cells[k][at] : from->blocks[k][at - h->cells];
        }
    }
    leaves[2 * n] = good ? 0.0 : 1.0;
    lac_team_join(split->team, leaves, 2 * n + 1);
    return leaves[2 * n] == 0.0;
}
