// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/fractal.h"
#include "rg/study.h"

size_t lac_rg_sample_levels(const lac_grid *grid)
{
    size_t levels = 0;
    for (int axis = 0; axis < 2; axis++) {
        size_t cells = axis == 0 ? grid->nx : grid->ny;
        cells *= !grid->periodic && cells > 1 ? 2 : 1;
        while (((size_t)1 << levels) < cells) {
            levels++;
        }
    }
    return levels;
}

// Side of the largest block that slips as a whole at each load [m].
static void largest_block(const lac_rg_tree *tree, const lac_grid *grid, size_t loads,
                          lac_rg_sample *out)
{
    const size_t levels = lac_rg_levels(tree);
    const double side = fmax(grid->dx, grid->dy);
    for (size_t i = 0; i < loads; i++) {
        out->block[i] = 0.0;
        for (size_t level = 0; level <= levels; level++) {
            if (out->fraction[i * (levels + 1) + level] > 0.0) {
                out->block[i] = ldexp(side, (int)level);
            }
        }
    }
}

// What slips by itself just before the joint slides.
static void count_at_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path,
                              double *work, lac_rg_sample *out)
{
    double *gap = work + lac_rg_blocks_at(tree, 0);
    lac_rg_path_at(path, fmax(0.0, out->critical - 2e-9), work, gap);
    (void)lac_rg_pass(tree, rule, work, gap);
    for (size_t level = 0; level <= lac_rg_levels(tree); level++) {
        out->blocks[level] = (double)lac_rg_blocks_at(tree, level);
        out->slipping[level] = (double)lac_rg_slipping(tree, level);
    }
}

lac_status lac_rg_sample_take(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                              size_t dy, const double *load, lac_rg_sample *out, lac_error *err)
{
    const lac_domain *domain = joint->domain;
    lac_rg_tree *tree = NULL;
    double *work = malloc(2 * domain->n * sizeof *work);
    lac_status status = work != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    LAC_TRY(lac_rg_tree_create_at(domain, dx, dy, joint->strength, joint->drop, &tree, err));
    out->critical = lac_rg_critical(tree, def->rule, joint->path, work);
    LAC_TRY(lac_rg_curve(tree, def->rule, joint->path, def->loads, load, out->fraction, work, err));
    largest_block(tree, &domain->grid, def->loads, out);
    count_at_critical(tree, def->rule, joint->path, work, out);
    LAC_TRY(lac_rg_size_effect(tree, def->rule, joint->path, domain->grid.ny == 1, out->size, work,
                               err));
out:
    lac_rg_tree_free(tree);
    free(work);
    return status;
}

// Longer side of the largest cluster of slipped cells [m]; `pressure` is scratch of the grid, all
// 0.
static lac_status largest_cluster(const lac_domain *domain, const uint8_t *slipped,
                                  double *pressure, double *extent, lac_error *err)
{
    lac_domain *part = NULL;
    lac_clusters *clusters = NULL;
    lac_status status = LAC_OK;
    size_t count = 0;
    *extent = 0.0;
    for (size_t i = 0; i < domain->n; i++) {
        pressure[domain->index[i]] = slipped[i] != 0 ? 1.0 : 0.0;
        count += slipped[i];
    }
    if (count > 0) {
        LAC_TRY(lac_domain_create(&domain->grid, pressure, &part, err));
        LAC_TRY(lac_clusters_create(part, &clusters, err));
        for (size_t c = 0; c < clusters->n; c++) {
            *extent = fmax(*extent, lac_cluster_extent(clusters, &domain->grid, c));
        }
    }
out:
    lac_clusters_free(clusters);
    lac_domain_free(part);
    return status;
}

static lac_status take_order(const lac_rg_joint *joint, const lac_rg_study_def *def,
                             const double *load, lac_rg_tree *tree, lac_rg_order *out,
                             lac_error *err)
{
    const lac_domain *domain = joint->domain;
    lac_status status;
    double *work = malloc(2 * domain->n * sizeof *work);
    uint8_t *slipped = malloc(domain->n);
    double *pressure = calloc(lac_grid_cells(&domain->grid), sizeof *pressure);
    bool made = work != NULL && slipped != NULL && pressure != NULL;
    status = made ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    for (size_t i = def->loads; i-- > 0;) {
        lac_rg_path_at(joint->path, load[i], work, work + domain->n);
        (void)lac_rg_pass(tree, def->rule, work, work + domain->n);
        lac_rg_settle(tree, slipped, NULL);
        for (size_t c = 0; c < domain->n; c++) {
            out->cell_load[c] = slipped[c] != 0 ? load[i] : out->cell_load[c];
        }
        LAC_TRY(largest_cluster(domain, slipped, pressure, &out->cluster[i], err));
    }
out:
    free(pressure);
    free(slipped);
    free(work);
    return status;
}

lac_status lac_rg_order_take(const lac_rg_joint *joint, const lac_rg_study_def *def,
                             const double *load, lac_rg_order *out, lac_error *err)
{
    lac_rg_tree *tree = NULL;
    for (size_t i = 0; i < joint->domain->n; i++) {
        out->cell_load[i] = NAN;
    }
    lac_status status =
        lac_rg_tree_create_at(joint->domain, 0, 0, joint->strength, joint->drop, &tree, err);
    if (status == LAC_OK) {
        status = take_order(joint, def, load, tree, out, err);
    }
    lac_rg_tree_free(tree);
    return status;
}
