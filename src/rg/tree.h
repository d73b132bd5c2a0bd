/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "rg/rg_study.h"

enum { LAC_RG_LEVELS = 40 };

/// One set of blocks. Levels between which no blocks merge share it.
typedef struct lac_rg_layer {
    size_t count;
    uint32_t *child;  ///< [count + 1] first block of each in the layer below; NULL: the cells
    double *cells;    ///< [count] contact cells in each
    double *strength; ///< [count] their summed strength
    double *drop;     ///< [count] their summed drop
    double *shear;    ///< [count] their summed traction
    double *gap;      ///< [count] threshold
    double *received; ///< [count] stress that came from siblings, of the pass down
} lac_rg_layer;

/// A child of the block at hand, with what decides its turn.
typedef struct lac_rg_child {
    double gap, strength;
    uint32_t block;
} lac_rg_child;

struct lac_rg_tree {
    size_t levels, layers;
    uint8_t of_level[LAC_RG_LEVELS + 1];
    lac_rg_layer layer[LAC_RG_LEVELS + 1];
    lac_rg_child *order; ///< [most children of a block]
    uint32_t *cell;      ///< [n] the caller's number of each cell; NULL: the same
    double *memory;
    uint32_t *links;
    double tolerance; ///< of a threshold [Pa]
    lac_rg_rule rule; ///< of the last pass
};

/// Levels of the trees that lac_rg_tree_create_at makes over a grid.
size_t lac_rg_levels_over(const lac_grid *grid);

/// After a pass up: of each cell the level of the largest block around it that slips by itself, NaN
/// where none does.
void lac_rg_own_levels(lac_rg_tree *tree, double *level);

/// What is known of a block on the way along a path.
typedef struct lac_rg_block_state {
    double gap, force; ///< at the load before [Pa], sum of its cells' tractions [Pa]
    double fall;       ///< of `gap` in the step to that load, over the load [Pa]
    double load;       ///< Q/Q_nom at which it slipped by itself, where it has
    double carried;    ///< `force` then
    bool slipped;      ///< whether it has
} lac_rg_block_state;

/// @param states  [blocks of all layers] layer by layer; the caller frees
lac_status lac_rg_states_create(const lac_rg_tree *tree, lac_rg_block_state **states,
                                lac_error *err);

/// After a pass at `load`: takes note of the blocks that have slipped since the load `before`:
/// when, by interpolation between thresholds; where they end at 0, by how they fell before; and
/// midway where there are none (LUMP).
void lac_rg_states_note(const lac_rg_tree *tree, double before, double load,
                        lac_rg_block_state *states);

/// The size effect that follows.
void lac_rg_states_summarise(const lac_rg_tree *tree, const lac_rg_block_state *states, bool line,
                             lac_rg_sizes *sizes);

#define LAC_RG_WITHIN_SOLVED 1e-6 // of Q/Q_nom: contacts are solved to 1e-8

enum { LAC_RG_SCAN = 60 }; // loads at which it is seen whether the joint slides, at least

/// Whether the joint carries tractions before the path begins.
bool lac_rg_path_is_preloaded(const lac_rg_path *path);

/// Q/Q_nom at a part of the path, 0 to 1.
double lac_rg_path_load(const lac_rg_path *path, double part);

/// Threshold of the root at a load. @param work  [2 cells]
double lac_rg_root(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double load,
                   double *work);

/// What one joint gave with its blocks at one place.
typedef struct lac_rg_sample {
    double critical;
    double *fraction;   ///< [loads * (levels + 1)]
    double *block;      ///< [loads] side of the largest block slipped as a whole [m]
    double *blocks;     ///< [levels + 1]
    double *slipping;   ///< [levels + 1]
    double *begin;      ///< [levels + 1]
    lac_rg_sizes *size; ///< [levels + 1]
} lac_rg_sample;

/// What one joint gave at its own place only.
typedef struct lac_rg_order {
    const lac_domain *domain;
    double *cell_load; ///< [n] the first load at which each cell has slipped in the end; NaN;
                       ///< holds the two below, too
    double *own_level; ///< [n] of the largest block around it that slips by itself where a loaded
                       ///< path begins; NaN
    double *cluster;   ///< [loads] longer side of the largest cluster of slipped cells [m]
    uint8_t *slipped;  ///< [n] scratch
    lac_domain part;   ///< scratch
} lac_rg_order;

lac_status lac_rg_order_create(const lac_domain *domain, size_t loads, lac_rg_order *order,
                               lac_error *err);

void lac_rg_order_clear(lac_rg_order *order);

/// @param order  NULL: not wanted
lac_status lac_rg_sample_take(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                              size_t dy, const double *load, lac_rg_order *order,
                              lac_rg_sample *out, lac_error *err);

/// The critical force of a sample on contacts that are solved for it, where the joint has them.
lac_status lac_rg_sample_solve(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                               size_t dy, lac_rg_sample *sample, lac_error *err);

/// Fits xi ~ (1 - load/critical)^-exponent below the critical load.
lac_rg_power lac_rg_power_fit(size_t n, const double *load, const double *xi, double critical);
