/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/contact.h"

enum { LAC_BOX_SIZES = 32 };

/// log2 n, rounded down; 0 of 0.
static inline size_t lac_octave(size_t n)
{
    size_t j = 0;
    while (n >>= 1) {
        j++;
    }
    return j;
}

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
    double minimum[LAC_BOX_SIZES]; ///< occupied boxes, least over these and the grid's own origin
    double slope[LAC_BOX_SIZES];   ///< local slope between side i and i + 1
    size_t fit_first, fit_last;    ///< range of the fit (indices)
    double dimension, error;       ///< D_box and its standard error: stated as D +- 2 errors
    double regression_error;       ///< its standard error, from the regression alone
    bool few_cells;                ///< fewer than 500 cells: a weak estimate
    bool dense;                    ///< more than 30 % of the area: not a fractal set
} lac_box_count;

/// Sides 2 to an eighth of the grid, 16 origins, seed 1.
lac_box_def lac_box_default(void);

/// Box-counting dimension of a contact domain.
/// N(s) ~ s^-D; least squares of ln N on ln s; the error covers the spread over origins and over
/// sub-ranges of the fit and the bias of boxes that cover loosely, not the regression alone.
lac_status lac_box_dimension(const lac_domain *domain, const lac_box_def *def,
                             lac_box_count *result, lac_error *err);

/// The blocks of a domain's own grid: squares of 2^l cells a side that hold a contact cell, up to
/// the one that covers the grid.
typedef struct lac_dyadic {
    size_t levels;               ///< above the cells
    double count[LAC_BOX_SIZES]; ///< [levels + 1] N_l
    double dimension;            ///< -slope of log2 N_l on l, all levels alike; NaN for one cell
} lac_dyadic;

/// Counts the blocks of every level.
lac_dyadic lac_dyadic_count(const lac_domain *domain);

/// Solves the contact at the normal load at which lac_dyadic has a given dimension, > 0 and below
/// that of full contact: to 1e-4, or 0.02 where single cells jump further. The load of `def` does
/// not count.
lac_status lac_dimension_solve(const lac_contact_def *def, double dimension, double *pressure,
                               double *gap, lac_contact_stats *report, lac_error *err);

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
lac_status lac_clusters_create(const lac_domain *domain, lac_clusters **clusters, lac_error *err);
void lac_clusters_free(lac_clusters *clusters);

/// Linear extent of one cluster: the longer of its two extents, on a line its length [m].
double lac_cluster_extent(const lac_clusters *clusters, const lac_grid *grid, size_t cluster);

enum { LAC_CLUSTER_OCTAVES = 32 };

/// What the clusters of a domain are like.
typedef struct lac_cluster_summary {
    size_t n, cells;       ///< clusters, and cells in all of them
    size_t largest;        ///< cells of the largest
    double largest_extent; ///< longer extent of the largest [m]
    double widest;         ///< longest extent of any [m]
    double mean;           ///< cells of a cluster, each cluster counted once
    double weighted;       ///< cells of the cluster that a contact cell belongs to, mean over cells
    size_t octaves;        ///< sizes from 2^i to 2^(i+1) - 1 cells, i < octaves
    size_t count[LAC_CLUSTER_OCTAVES];    ///< clusters of each octave
    size_t cells_of[LAC_CLUSTER_OCTAVES]; ///< cells in them
} lac_cluster_summary;

/// Sums up clusters; docs/theory/fractal.md.
lac_cluster_summary lac_clusters_summarise(const lac_clusters *clusters, const lac_grid *grid);

enum { LAC_SCALING_POINTS = 24 };

/// How a finer grid becomes a coarser one; the two give different slopes of the surface.
typedef enum lac_coarsening {
    LAC_SAMPLE,     ///< one point of each block: h[::m, ::m]
    LAC_BLOCK_MEAN, ///< the mean of each block
} lac_coarsening;

/// The same interface under the same load at one resolution r.
typedef struct lac_resolution {
    double cell;     ///< r, side of a cell [m]
    double area;     ///< A_r, real area of contact [m2]
    double pressure; ///< p_r, mean over A_r [Pa]
    double slope;    ///< h'_r, rms slope between neighbouring cells along x and y [1]; 0: not known
    size_t cells;    ///< cells in contact; not fitted
    double local;    ///< Delta_S between this resolution and the next finer one; NaN at the finest
} lac_resolution;

/// How coarser grids were made, in words.
const char *lac_coarsening_text(lac_coarsening coarsening);

/// Area scaling of an interface, A_r ~ r^(2 - Delta_S), and what follows from it.
typedef struct lac_scaling {
    size_t n;                              ///< resolutions
    lac_resolution at[LAC_SCALING_POINTS]; ///< [n] coarsest first
    lac_coarsening coarsening;             ///< how the coarser ones came about
    size_t left_out;                       ///< finest resolutions left out of the fit
    double dimension;                      ///< Delta_S
    double regression_error;               ///< its standard error, from the regression alone
    double error;                          ///< its standard error, with the spread over sub-ranges
    bool few_cells;      ///< fewer than 100 cells touch at the coarsest resolution: a weak estimate
    double load;         ///< P, mean of p_r A_r [N]
    double load_error;   ///< largest |p_r A_r - P| / P [1]
    double from_slopes;  ///< 2 - d ln h'_r / d ln(1/r): Delta_S if A_r h'_r did not depend on r;
                         ///< NaN where a slope is not known
    double fractal_area; ///< A* = A_r r^(Delta_S - 2), mean over the fit [m^Delta_S]
    double fractal_pressure; ///< p* = P / A* [N m^-Delta_S]
} lac_scaling;

/// Fits Delta_S = 2 - d ln A_r / d ln r: docs/theory/fractal.md. At least three resolutions must
/// stay; the finest of a surface is its own cut-off, and left out. Cell, area and pressure are
/// given.
void lac_scaling_fit(lac_scaling *scaling, size_t left_out);

/// Which resolutions of one interface are solved.
typedef struct lac_scaling_def {
    size_t coarsest;           ///< cells along the shorter side of the coarsest grid, at most
    size_t left_out;           ///< finest resolutions solved but left out of the fit
    lac_coarsening coarsening; ///< how the coarser grids are made
    const double *finest;      ///< [ny * nx] pressures at the finest resolution, where they are
                               ///< known [Pa]; NULL: solved for
} lac_scaling_def;

/// From 64 cells by point sampling, the finest resolution left out of the fit.
lac_scaling_def lac_scaling_default(void);

/// Solves the contact of one interface, under load control, at its own resolution and at 2, 4, 8
/// ... times its cell, each from a flat start, and fits the areas.
lac_status lac_scaling_measure(const lac_contact_def *contact, const lac_scaling_def *def,
                               lac_scaling *scaling, lac_error *err);

/// Strength of specimens of other sizes than the one measured.
typedef struct lac_size_def {
    double dimension, error; ///< Delta_S and its standard error
    double size;             ///< b_0, side of the interface that was measured [m]
    double pressure;         ///< p_0(b_0), its apparent mean pressure, or its shear strength [Pa]
} lac_size_def;

/// One specimen.
typedef struct lac_size_strength {
    double size;      ///< b, side of the specimen [m]
    double pressure;  ///< p_0(b) at the same fractal pressure p*, or the shear strength [Pa]
    double relative;  ///< p_0(b) / p_0(b_0), as q_crit(b) / q_crit(b_0) [1]
    double low, high; ///< relative, at Delta_S a standard error lower and higher [1]; low <= high
} lac_size_strength;

/// The size effect of n specimens: q_crit ~ p_0 ~ p* b^-(2 - Delta_S); docs/theory/fractal.md
/// eq. 6.
/// @source Borri-Brunetto, Carpinteri and Chiaia (2004), eq. 2 and 3
lac_status lac_size_effect(const lac_size_def *def, size_t n, const double *size,
                           lac_size_strength *rows, lac_error *err);

/// A published exponent x of the size effect, strength ~ b^-x, x = 2 - Delta_S.
typedef struct lac_size_exponent {
    const char *quantity;         ///< what falls with the size
    double low, high;             ///< x, equal where one value is stated [1]
    double shortest_m, longest_m; ///< lengths that it was found on [m]; NaN: not stated
    bool stated;                  ///< by the source; else derived from what it states
    const char *source;
} lac_size_exponent;

/// The index-th published exponent, NULL past the end; cases/data/size_effect.csv.
const lac_size_exponent *lac_size_exponent_get(size_t index);
