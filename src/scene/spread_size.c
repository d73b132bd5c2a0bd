// SPDX-License-Identifier: GPL-3.0-or-later
// How large the patch or the block is that a cell belongs to.
#include <math.h>

#include "scene/internal.h"

static lac_status patch_sizes(const lac_domain *domain, double *size, lac_error *err)
{
    lac_clusters *clusters = NULL;
    double cell = lac_grid_cell_area(&domain->grid);
    lac_status status = lac_clusters_create(domain, &clusters, err);
    for (size_t i = 0; status == LAC_OK && i < domain->n; i++) {
        size[i] = sqrt(cell * clusters->size[clusters->label[i]]);
    }
    lac_clusters_free(clusters);
    return status;
}

// Level by level upwards: a block of 2^l x 2^l cells (2^l on a line) is full where as many touch.
static void block_sizes(const lac_domain *domain, const lac_hierarchy *blocks, double *size)
{
    const lac_grid *grid = &domain->grid;
    bool line = grid->nx == 1 || grid->ny == 1;
    double side = sqrt(lac_grid_cell_area(grid));
    size_t full = 1;
    for (size_t i = 0; i < domain->n; i++) {
        size[i] = side;
    }
    for (size_t level = 1; level <= lac_hierarchy_levels(blocks); level++) {
        const uint32_t *first = lac_hierarchy_offsets(blocks, level);
        side *= 2.0;
        full *= line ? 2 : 4;
        for (size_t b = 0; b < lac_hierarchy_blocks(blocks, level); b++) {
            for (size_t i = first[b]; first[b + 1] - first[b] == full && i < first[b + 1]; i++) {
                size[i] = side;
            }
        }
    }
}

lac_status lac_spread_sizes(const lac_spread_place *place, lac_size_of of, double *size,
                            lac_error *err)
{
    if (of == LAC_SIZE_PATCH) {
        return patch_sizes(place->domain, size, err);
    }
    if (place->hierarchy != NULL) {
        block_sizes(place->domain, place->hierarchy, size);
        return LAC_OK;
    }
    lac_hierarchy *blocks = NULL;
    lac_status status = lac_hierarchy_create(place->domain, &blocks, err);
    if (status == LAC_OK) {
        block_sizes(place->domain, blocks, size);
    }
    lac_hierarchy_free(blocks);
    return status;
}
