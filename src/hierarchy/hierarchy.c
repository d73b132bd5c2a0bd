// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks over the contact cells, level by level; levels between which nothing merges share memory.
#include "hierarchy/hierarchy.h"

#include "hierarchy/split.h"

const double lac_is_child[5][4] = {
    {0, 0, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 0}, {1, 1, 1, 1},
};

static uint64_t code_of(const lac_domain *domain, size_t cell)
{
    size_t i = domain->index[cell];
    return lac_morton((uint32_t)(i % domain->grid.nx), (uint32_t)(i / domain->grid.nx));
}

static void find_merges(const lac_domain *domain, uint8_t *merge)
{
    uint64_t last = code_of(domain, 0);
    for (size_t i = 1; i < domain->n; i++) {
        uint64_t code = code_of(domain, i);
        merge[i] = (uint8_t)((63 - __builtin_clzll(code ^ last)) / 2 + 1);
        last = code;
    }
}

// Counts the blocks of every level and gives equal levels one partition.
static void number_partitions(lac_hierarchy *h, const uint8_t *merge)
{
    size_t merges[LAC_MAX_LEVELS + 1] = {0};
    for (size_t i = 1; i < h->cells; i++) {
        merges[merge[i]]++;
    }
    h->partitions = 1;
    h->part[0].count = (uint32_t)h->cells;
    for (size_t level = 1; level <= h->levels; level++) {
        if (merges[level] > 0) {
            uint32_t finer = h->part[h->partitions - 1].count;
            h->part[h->partitions].count = finer - (uint32_t)merges[level];
            h->blocks += h->part[h->partitions].count;
            h->partitions++;
        }
        h->of_level[level] = (uint8_t)(h->partitions - 1);
        h->part[h->partitions - 1].level = level;
    }
}

// Lists the first cells of a partition: those that merge above its level.
static void find_first(const lac_hierarchy *h, size_t j, const uint8_t *merge, uint32_t *first)
{
    size_t block = 0;
    first[block++] = 0;
    for (size_t i = 1; i < h->cells; i++) {
        if (merge[i] > h->part[j].level) {
            first[block++] = (uint32_t)i;
        }
    }
    first[block] = (uint32_t)h->cells;
}

uint32_t *lac_hierarchy_link(lac_partition *fine, const lac_partition *coarse, uint32_t *memory)
{
    uint32_t *parent = memory, *child = parent + fine->count, *single = child + coarse->count + 1;
    uint32_t b = 0;
    child[0] = fine->singles = fine->whole = 0;
    for (uint32_t c = 0; c < fine->count; c++) {
        if (c > 0 && fine->first[c] == coarse->first[b + 1]) {
            b++;
        }
        if (fine->first[c] == coarse->first[b]) {
            child[b] = c;
        }
        parent[c] = b;
    }
    child[coarse->count] = fine->count;
    for (b = 0; b < coarse->count; b++) {
        const uint32_t *only = fine->first + child[b];
        if (only[0] == coarse->first[b] && only[1] == coarse->first[b + 1]) {
            single[fine->singles++] = b;
        }
        fine->whole += (uint64_t)child[b] + 4 <= fine->count;
    }
    fine->parent = parent;
    fine->child = child;
    fine->single = single;
    return single + fine->singles;
}

static lac_status fill_partitions(lac_hierarchy *h, const uint8_t *merge, lac_error *err)
{
    // first (count + 1) and parent (count) of all partitions, child (count + 1) and single (at
    // most count) of all but the cells.
    size_t total = 2 * h->cells + 4 * h->blocks + 2 * h->partitions;
    uint32_t *next = h->memory = malloc(total * sizeof *h->memory);
    LAC_FAIL_MEMORY_IF(next == NULL, err);
    for (size_t j = 0; j < h->partitions; j++) {
        find_first(h, j, merge, next);
        h->part[j].first = next;
        next += h->part[j].count + 1;
    }
    for (size_t j = 0; j + 1 < h->partitions; j++) {
        next = lac_hierarchy_link(&h->part[j], &h->part[j + 1], next);
        h->part[j].last = h->part[j + 1].first[h->part[j].whole];
    }
    return LAC_OK;
}

lac_status lac_hierarchy_build(size_t cells, size_t levels, const uint8_t *merge,
                               lac_hierarchy **out, lac_error *err)
{
    lac_hierarchy *h = *out = calloc(1, sizeof *h);
    LAC_FAIL_MEMORY_IF(h == NULL, err);
    h->cells = cells;
    h->levels = levels;
    number_partitions(h, merge);
    h->room = h->blocks;
    const lac_status status = fill_partitions(h, merge, err);
    LAC_MADE(status, out, lac_hierarchy_free);
}

lac_status lac_hierarchy_create(const lac_domain *domain, lac_hierarchy **out, lac_error *err)
{
    *out = NULL;
    uint8_t *merge = calloc(domain->n, sizeof *merge);
    LAC_FAIL_MEMORY_IF(merge == NULL, err);
    find_merges(domain, merge);
    const size_t levels = lac_grid_levels(&domain->grid);
    const lac_status status = lac_hierarchy_build(domain->n, levels, merge, out, err);
    free(merge);
    return status;
}

void lac_hierarchy_free(lac_hierarchy *h)
{
    if (h != NULL) {
        lac_split_free(h->split);
        free(h->memory);
        free(h);
    }
}

size_t lac_hierarchy_cells(const lac_hierarchy *h) { return h->cells; }

size_t lac_hierarchy_levels(const lac_hierarchy *h) { return h->levels; }

size_t lac_hierarchy_blocks(const lac_hierarchy *h, size_t level)
{
    return h->part[h->of_level[level]].count;
}

size_t lac_hierarchy_rank(const lac_hierarchy *h, size_t level)
{
    return lac_hierarchy_blocks(h, level) - lac_hierarchy_blocks(h, level + 1);
}

const uint32_t *lac_hierarchy_offsets(const lac_hierarchy *h, size_t level)
{
    return h->part[h->of_level[level]].first;
}

const uint32_t *lac_hierarchy_parents(const lac_hierarchy *h, size_t level)
{
    return h->part[h->of_level[level]].parent;
}
