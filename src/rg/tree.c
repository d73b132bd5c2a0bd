// SPDX-License-Identifier: GPL-3.0-or-later
// The blocks over the cells as the cascade keeps them: levels that merge nothing share a layer.
#include "rg/tree.h"

#include <assert.h>

enum { SUMS = 6 }; // arrays of doubles a layer

size_t lac_rg_levels(const lac_rg_tree *tree) { return tree->levels; }

static const lac_rg_layer *layer_at(const lac_rg_tree *tree, size_t level)
{
    return &tree->layer[tree->of_level[level]];
}

size_t lac_rg_blocks_at(const lac_rg_tree *tree, size_t level)
{
    return layer_at(tree, level)->count;
}

bool lac_rg_slips(const lac_rg_tree *tree, double threshold)
{
    return threshold <= tree->tolerance;
}

size_t lac_rg_slipping(const lac_rg_tree *tree, size_t level)
{
    const lac_rg_layer *layer = layer_at(tree, level);
    size_t n = 0;
    for (size_t i = 0; i < layer->count; i++) {
        n += layer->gap[i] <= tree->tolerance ? 1 : 0;
    }
    return n;
}

// Gives levels without a merger the layer of the level below; returns the blocks above the cells.
static size_t number_layers(lac_rg_tree *tree, const lac_rg_blocks *b)
{
    size_t above = 0;
    tree->levels = b->levels;
    tree->layers = 1;
    tree->layer[0].count = b->count[0];
    for (size_t level = 1; level <= b->levels; level++) {
        if (b->count[level] != tree->layer[tree->layers - 1].count) {
            tree->layer[tree->layers].count = b->count[level];
            above += b->count[level];
            tree->layers++;
        }
        tree->of_level[level] = (uint8_t)(tree->layers - 1);
    }
    return above;
}

// First block of each block in the layer below, from the first cells of both.
static void link_layer(const uint32_t *fine, size_t n_fine, const uint32_t *coarse, size_t n_coarse,
                       uint32_t *child)
{
    size_t j = 0;
    for (size_t b = 0; b <= n_coarse; b++) {
        while (j < n_fine && (fine != NULL ? fine[j] : (uint32_t)j) < coarse[b]) {
            j++;
        }
        child[b] = (uint32_t)j;
    }
    assert(child[0] == 0 && child[n_coarse] == n_fine);
}

static void link_layers(lac_rg_tree *tree, const lac_rg_blocks *b, uint32_t *links)
{
    const uint32_t *fine = NULL;
    for (size_t level = 1; level <= b->levels; level++) {
        size_t k = tree->of_level[level];
        if (k != tree->of_level[level - 1]) {
            lac_rg_layer *above = &tree->layer[k];
            above->child = links;
            links += above->count + 1;
            link_layer(fine, tree->layer[k - 1].count, b->first[level], above->count, above->child);
            fine = b->first[level];
        }
    }
}

static void place_sums(lac_rg_tree *tree, double *memory)
{
    for (size_t k = 0; k < tree->layers; k++) {
        lac_rg_layer *layer = &tree->layer[k];
        double **part[SUMS] = {&layer->cells, &layer->strength, &layer->drop,
                               &layer->shear, &layer->gap,      &layer->received};
        for (size_t i = 0; i < SUMS; i++) {
            *part[i] = memory;
            memory += layer->count;
        }
    }
}

static size_t most_children(const lac_rg_tree *tree)
{
    size_t most = 1;
    for (size_t k = 1; k < tree->layers; k++) {
        const uint32_t *child = tree->layer[k].child;
        for (size_t b = 0; b < tree->layer[k].count; b++) {
            size_t n = child[b + 1] - child[b];
            most = n > most ? n : most;
        }
    }
    return most;
}

// What does not change with the load.
static void fill_sums(lac_rg_tree *tree, const double *strength, const double *drop)
{
    const size_t n = tree->layer[0].count;
    double total = 0.0;
    for (size_t i = 0; i < n; i++) {
        tree->layer[0].cells[i] = 1.0;
        tree->layer[0].strength[i] = strength[i];
        tree->layer[0].drop[i] = drop[i];
        total += strength[i] / (double)n;
    }
    tree->tolerance = 1e-12 * total;
    for (size_t k = 1; k < tree->layers; k++) {
        const lac_rg_layer *below = &tree->layer[k - 1];
        lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++) {
            double sum[3] = {0};
            for (uint32_t c = layer->child[b]; c < layer->child[b + 1]; c++) {
                sum[0] += below->cells[c];
                sum[1] += below->strength[c];
                sum[2] += below->drop[c];
            }
            layer->cells[b] = sum[0];
            layer->strength[b] = sum[1];
            layer->drop[b] = sum[2];
        }
    }
}

lac_status lac_rg_tree_from_blocks(const lac_rg_blocks *blocks, const double *strength,
                                   const double *drop, lac_rg_tree **out, lac_error *err)
{
    lac_status status;
    *out = NULL;
    assert(blocks->levels <= LAC_RG_LEVELS && blocks->count[blocks->levels] == 1);
    lac_rg_tree *tree = *out = calloc(1, sizeof *tree);
    LAC_FAIL_MEMORY_IF(tree == NULL, err);
    size_t above = number_layers(tree, blocks);
    tree->memory = calloc(SUMS * (blocks->count[0] + above), sizeof *tree->memory);
    tree->links = malloc((above + tree->layers) * sizeof *tree->links);
    LAC_TRY(tree->memory != NULL && tree->links != NULL ? LAC_OK : lac_fail_memory(err));
    link_layers(tree, blocks, tree->links);
    tree->order = malloc(most_children(tree) * sizeof *tree->order);
    LAC_TRY(tree->order != NULL ? LAC_OK : lac_fail_memory(err));
    place_sums(tree, tree->memory);
    fill_sums(tree, strength, drop);
out:
    LAC_MADE(status, out, lac_rg_tree_free);
}

lac_status lac_rg_tree_create(const lac_hierarchy *h, const double *strength, const double *drop,
                              lac_rg_tree **out, lac_error *err)
{
    size_t count[LAC_RG_LEVELS + 1];
    const uint32_t *first[LAC_RG_LEVELS + 1];
    const lac_rg_blocks blocks = {lac_hierarchy_levels(h), count, first};
    for (size_t level = 0; level <= blocks.levels; level++) {
        count[level] = lac_hierarchy_blocks(h, level);
        first[level] = lac_hierarchy_offsets(h, level);
    }
    return lac_rg_tree_from_blocks(&blocks, strength, drop, out, err);
}

// A tree whose grid of blocks is moved over the joint shows how much its place decides.

// Where a grid is laid into, to be moved.
static lac_grid roomy(const lac_grid *grid)
{
    lac_grid room = *grid;
    room.nx *= !grid->periodic && grid->nx > 1 ? 2 : 1;
    room.ny *= !grid->periodic && grid->ny > 1 ? 2 : 1;
    return room;
}

size_t lac_rg_levels_over(const lac_grid *grid)
{
    const lac_grid room = roomy(grid);
    return lac_grid_levels(&room);
}

static size_t moved(size_t i, size_t by, size_t n) { return i + by < n ? i + by : i + by - n; }

// The moved domain, and for each of its cells the one of the domain.
static lac_status shift(const lac_domain *domain, size_t dx, size_t dy, lac_domain **out,
                        uint32_t *cell, lac_error *err)
{
    const lac_grid *from = &domain->grid;
    const lac_grid grid = roomy(from);
    lac_status status;
    double *pressure = calloc(lac_grid_cells(&grid), sizeof *pressure);
    uint32_t *origin = malloc(lac_grid_cells(&grid) * sizeof *origin);
    LAC_TRY(pressure != NULL && origin != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t i = 0; i < domain->n; i++) {
        size_t x = moved(domain->index[i] % from->nx, dx, grid.nx);
        size_t y = moved(domain->index[i] / from->nx, dy, grid.ny);
        pressure[y * grid.nx + x] = domain->pressure[i];
        origin[y * grid.nx + x] = (uint32_t)i;
    }
    LAC_TRY(lac_domain_create(&grid, pressure, out, err));
    for (size_t i = 0; i < domain->n; i++) {
        cell[i] = origin[(*out)->index[i]];
    }
out:
    free(origin);
    free(pressure);
    return status;
}

lac_status lac_rg_tree_create_at(const lac_domain *domain, size_t dx, size_t dy,
                                 const double *strength, const double *drop, lac_rg_tree **out,
                                 lac_error *err)
{
    const size_t n = domain->n;
    lac_domain *there = NULL;
    lac_hierarchy *h = NULL;
    uint32_t *cell = NULL;
    double *moved_values = NULL;
    lac_status status;
    *out = NULL;
    LAC_FAIL_IF(
        dx >= domain->grid.nx || dy >= domain->grid.ny, err, LAC_EINPUT,
        "blocks can be moved by less than the %zu x %zu cells of the grid, not by %zu x %zu",
        domain->grid.nx, domain->grid.ny, dx, dy);
    cell = malloc(n * sizeof *cell);
    moved_values = malloc(2 * n * sizeof *moved_values);
    LAC_TRY(cell != NULL && moved_values != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(shift(domain, dx, dy, &there, cell, err));
    LAC_TRY(lac_hierarchy_create(there, &h, err));
    for (size_t i = 0; i < n; i++) {
        moved_values[i] = strength[cell[i]];
        moved_values[n + i] = drop[cell[i]];
    }
    LAC_TRY(lac_rg_tree_create(h, moved_values, moved_values + n, out, err));
    (*out)->cell = cell;
    cell = NULL;
out:
    free(moved_values);
    free(cell);
    lac_hierarchy_free(h);
    lac_domain_free(there);
    return status;
}

void lac_rg_tree_free(lac_rg_tree *tree)
{
    if (tree == NULL) {
        return;
    }
    free(tree->cell);
    free(tree->order);
    free(tree->links);
    free(tree->memory);
    free(tree);
}
