/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FRACTAL_H
#define LACUNA_FRACTAL_H

#include "lacuna/contact.h"

enum { LAC_BOX_SIZES = 32 };

/// Box counting of one contact map: how, and what came out.
typedef struct lac_box_def {
    size_t smallest, largest; ///< box sides used in the fit [cells], powers of two; 0: chosen
    size_t origins;           ///< random origins averaged (at least 1)
    uint64_t seed;
} lac_box_def;

typedef struct lac_box_count {
    size_t sizes;                  ///< number of box sides counted
    double side[LAC_BOX_SIZES];    ///< [cells]
    double count[LAC_BOX_SIZES];   ///< occupied boxes, mean over the origins
    double minimum[LAC_BOX_SIZES]; ///< occupied boxes, least over the origins
    double slope[LAC_BOX_SIZES];   ///< local slope between side i and i + 1
    size_t fit_first, fit_last;    ///< range of the fit (indices)
    double dimension, error;       ///< D_box and its standard error
    bool few_cells;                ///< fewer than 500 cells: a weak estimate
    bool dense;                    ///< more than 30 % of the area: not a fractal set
} lac_box_count;

/// Sides 2 to an eighth of the grid, 16 origins, seed 1.
lac_box_def lac_box_default(void);

/// Box-counting dimension of a contact domain.
/// N(s) ~ s^-D; least squares of ln N on ln s; the error covers the spread over origins and over
/// sub-ranges of the fit, not the regression alone.
/// @return LAC_OK; LAC_ENOMEM; LAC_EINPUT where fewer than three box sides fit the grid
lac_status lac_box_dimension(const lac_domain *domain, const lac_box_def *def,
                             lac_box_count *result, lac_error *err);

/// The clusters of a contact domain: cells that touch by a side or a corner belong together.
/// Largest first; of equals the one whose first cell comes first in the domain. Immutable.
typedef struct lac_clusters {
    size_t n;        ///< clusters
    size_t cells;    ///< cells of the domain
    uint32_t *label; ///< [cells] cluster of each cell of the domain
    uint32_t *size;  ///< [n] cells of each cluster
    uint32_t *width; ///< [n] columns that it occupies: its extent along x, nx where it goes round
    uint32_t *depth; ///< [n] rows that it occupies: its extent along y
} lac_clusters;

/// Finds the clusters, across the edges where the grid is periodic.
/// @return LAC_OK; LAC_EINPUT where no cell is in contact; LAC_ENOMEM
/// @cost   O(grid cells); 4 bytes a cell of the grid and 12 a contact cell while it works
lac_status lac_clusters_create(const lac_domain *domain, lac_clusters **clusters, lac_error *err);

/// Frees clusters; NULL is fine.
void lac_clusters_free(lac_clusters *clusters);

/// Linear extent of one cluster: the longer of its two extents [m].
double lac_cluster_extent(const lac_clusters *clusters, const lac_grid *grid, size_t cluster);

#endif
