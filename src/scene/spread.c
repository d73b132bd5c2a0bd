// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters that differ from cell to cell: drawn at random, read from a map, or set by size.
#include "scene/internal.h"
#include "store/store_cells.h"

// Tries of a truncated factor; fewer than one in a hundred kept is refused as good as always.
enum { MOST_DRAWS = 1000 };

// Odd 64-bit constants of splitmix64: they set streams apart.
static const uint64_t next_rank = 0x9e3779b97f4a7c15u;
static const uint64_t next_draw = 0xbf58476d1ce4e5b9u;

// One parameter on its way from nominal values to those of the cells.
typedef struct filling {
    const lac_heterogeneity_place *place;
    const char *key, *unit;
    double *factor; // [n]
} filling;

static lac_status draw_factors(const lac_heterogeneity *spread, uint64_t rank, const filling *f,
                               lac_error *err)
{
    const lac_heterogeneity_kind *kind = (const void *)spread->model.info;
    const lac_heterogeneity_random *p = spread->model.params;
    const lac_domain *domain = f->place->domain;
    // Parameters that share a seed still get numbers of their own.
    uint64_t stream = lac_sum_bytes(LAC_SUM_OF_NOTHING, f->key, strlen(f->key)) + rank * next_rank;
    for (size_t i = 0; i < domain->n; i++) {
        double factor = kind->draw(p, domain->index[i], stream);
        for (uint64_t again = 1; factor < p->lowest || factor > p->highest; again++) {
            LAC_FAIL_IF(again >= MOST_DRAWS, err, LAC_EINPUT,
                        "%s: none of %d factors drawn for cell %zu lies between lowest and highest",
                        kind->info.name, MOST_DRAWS, i);
            factor = kind->draw(p, domain->index[i], stream + again * next_draw);
        }
        f->factor[i] = factor;
    }
    return LAC_OK;
}

static lac_status read_map(const lac_heterogeneity *spread, const filling *f, lac_error *err)
{
    const lac_heterogeneity_map *map = spread->model.params;
    const lac_map_def def = {.path = map->path,
                             .variable = map->variable,
                             .unit = map->as == LAC_MAP_VALUE ? f->unit : "1"};
    return lac_map_read(&def, f->place->domain, f->factor, err);
}

// How large the patch or the block is that a cell belongs to.
static lac_status patch_sizes(const lac_domain *domain, double *size, lac_error *err)
{
    lac_clusters *clusters = NULL;
    double cell = lac_grid_cell_area(&domain->grid);
    LAC_TRY_RETURN(lac_clusters_create(domain, &clusters, err));
    for (size_t i = 0; i < domain->n; i++) {
        size[i] = sqrt(cell * clusters->size[clusters->label[i]]);
    }
    lac_clusters_free(clusters);
    return LAC_OK;
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

lac_status lac_heterogeneity_sizes(const lac_heterogeneity_place *place, lac_size_of of,
                                   double *size, lac_error *err)
{
    if (of == LAC_SIZE_PATCH) {
        return patch_sizes(place->domain, size, err);
    }
    lac_hierarchy *made = NULL;
    if (place->hierarchy == NULL) {
        LAC_TRY_RETURN(lac_hierarchy_create(place->domain, &made, err));
    }
    block_sizes(place->domain, made != NULL ? made : place->hierarchy, size);
    lac_hierarchy_free(made);
    return LAC_OK;
}

static lac_status scale_by_size(const lac_heterogeneity *spread, const filling *f, lac_error *err)
{
    const lac_heterogeneity_size *p = spread->model.params;
    lac_status status = lac_heterogeneity_sizes(f->place, (lac_size_of)p->of, f->factor, err);
    for (size_t i = 0; status == LAC_OK && i < f->place->domain->n; i++) {
        f->factor[i] = pow(f->factor[i] / p->reference, p->exponent);
    }
    return status;
}

static lac_status find_factors(const lac_heterogeneity *spread, uint64_t rank, const filling *f,
                               lac_error *err)
{
    if (spread->model.info == &lac_heterogeneity_map_kind.info) {
        return read_map(spread, f, err);
    }
    if (spread->model.info == &lac_heterogeneity_size_kind.info) {
        return scale_by_size(spread, f, err);
    }
    return draw_factors(spread, rank, f, err);
}

lac_status lac_heterogeneity_fill(const lac_heterogeneity_place *place,
                                  const lac_heterogeneity_list *list, const char *key,
                                  const char *unit, double nominal, double *values, lac_error *err)
{
    size_t n = place->domain->n;
    lac_status status = LAC_OK;
    uint64_t rank = 0;
    filling f = {place, key, unit, malloc(n * sizeof(double))};
    LAC_FAIL_MEMORY_IF(f.factor == NULL, err);
    for (size_t k = 0; k < list->count; k++) {
        bool outright =
            strcmp(list->item[k].key, key) == 0 && lac_heterogeneity_is_value(&list->item[k]);
        nominal = outright ? 1.0 : nominal;
    }
    for (size_t i = 0; i < n; i++) {
        values[i] = nominal;
    }
    for (size_t k = 0; k < list->count; k++) {
        if (strcmp(list->item[k].key, key) == 0) {
            LAC_TRY(find_factors(&list->item[k], rank++, &f, err));
            for (size_t i = 0; i < n; i++) {
                values[i] *= f.factor[i];
            }
        }
    }
out:
    free(f.factor);
    return status;
}
