/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "hierarchy/hierarchy.h"

/// What a block that slips does to its siblings; docs/theory/rg.md.
typedef enum lac_rg_rule {
    LAC_RG_FIX,  ///< sheds the drop of its own strength, as the paper reads
    LAC_RG_CONS, ///< sheds what it carried above its residual strength: forces balance
    LAC_RG_LUMP, ///< as a point of its summed strength and load, whole or not at all
} lac_rg_rule;

/// What a case calls them, and the ways in which shear spreads over the cells; NULL at their ends.
extern const char *const lac_rg_rule_names[], *const lac_rg_field_names[];

/// The blocks over the contact cells as the cascade sees them: what each holds, what it sheds, and
/// the answers of the last pass. Not shared between threads.
typedef struct lac_rg_tree lac_rg_tree;

/// The tree of a hierarchy. It may be freed before the tree.
/// @param strength  [n] f p of each contact cell [Pa], > 0
/// @param drop      [n] (1 - beta) f p, the strength that it loses by slipping [Pa], 0 to strength
lac_status lac_rg_tree_create(const lac_hierarchy *h, const double *strength, const double *drop,
                              lac_rg_tree **out, lac_error *err);

/// The tree of a domain whose blocks lie elsewhere: the cells are moved by (dx, dy) against the
/// grid of blocks. Periodic grids wrap; others are laid into one twice as long on each side of more
/// than a cell, so that they have a level more. Cells keep their numbers in all that follows.
lac_status lac_rg_tree_create_at(const lac_domain *domain, size_t dx, size_t dy,
                                 const double *strength, const double *drop, lac_rg_tree **out,
                                 lac_error *err);

/// Blocks over cells, level by level.
typedef struct lac_rg_blocks {
    size_t levels;       ///< above the cells; the last holds one block, the root; 0: one cell
    const size_t *count; ///< [levels + 1] blocks of each level; count[0]: the cells
    const uint32_t *const *first; ///< [levels + 1] of [count + 1]: first cell of each block, and n;
                                  ///< first[0] is not used
} lac_rg_blocks;

/// Any tree, of blocks with any number of children.
/// @pre   the blocks of a level nest in those of the next; strengths are a path's, drops no more
lac_status lac_rg_tree_from_blocks(const lac_rg_blocks *blocks, const double *strength,
                                   const double *drop, lac_rg_tree **out, lac_error *err);
void lac_rg_tree_free(lac_rg_tree *tree);

/// Levels above the cells: the root is block 0 of level lac_rg_levels.
size_t lac_rg_levels(const lac_rg_tree *tree);

/// Blocks of a level, N_tot.
size_t lac_rg_blocks_at(const lac_rg_tree *tree, size_t level);

/// The pass up the tree under one load: the threshold of every block, that is the smallest further
/// stress, the same on all its cells, that makes it slip as a whole; <= 0: it slips by itself.
/// LUMP has no thresholds: 0 where it slips, infinity where not.
/// @param shear  [n] traction of each cell [Pa], at most its strength unless `gap` is given
/// @param gap    [n] what each cell lacks to slip [Pa], may be < 0; NULL: strength - shear
/// @return the threshold of the root: the joint slides where it is <= 0 (lac_rg_slips)
double lac_rg_pass(lac_rg_tree *tree, lac_rg_rule rule, const double *shear, const double *gap);

/// Whether a threshold counts as reached: within 1e-12 of the mean strength.
bool lac_rg_slips(const lac_rg_tree *tree, double threshold);

/// Blocks of a level that slip by themselves after a pass, N_slip.
size_t lac_rg_slipping(const lac_rg_tree *tree, size_t level);

/// The pass down the tree after a pass up: what the slip of each block does inside its siblings.
/// FIX and CONS; with LUMP a cell slips at last where it or a block that holds it slips by itself.
/// @param slipped  [n] 1 where a cell has slipped in the end, 0 where it sticks; overwritten
/// @param stress   [n] stress that each sticking cell has received from others [Pa]; overwritten;
///                 NULL if not wanted; with LUMP all 0
void lac_rg_resolve(lac_rg_tree *tree, uint8_t *slipped, double *stress);

/// How the shear force spreads over the cells as it grows from 0 to f P. Immutable.
typedef struct lac_rg_path lac_rg_path;

/// Springs of equal stiffness with caps, `equal`: q = min(tau, f p); the map sees the gap f p -
/// tau. Under a joint that is loaded already each cell carries max(q, min(q + tau, f p)), tau the
/// further stress, the same on all; the map sees the gap f p - q - tau, and the load runs from
/// Q/Q_nom, the sum of the q over f P, to where no cell can take up more.
/// @param strength  [n] f p of each contact cell [Pa], > 0
/// @param shear  [n] q, the traction of each cell [Pa]; may be beyond f p; NULL: none
lac_status lac_rg_path_further(size_t n, const double *strength, const double *shear,
                               lac_rg_path **out, lac_error *err);

/// The same stress on every cell, however weak, as a slow ramp puts it on: q = tau, and the gap
/// f p - tau, < 0 where a cell has slipped on the way.
/// @param strength  [n] f p of each contact cell [Pa], > 0
lac_status lac_rg_path_uniform(size_t n, const double *strength, lac_rg_path **out, lac_error *err);

enum { LAC_RG_LOADS = 24, LAC_RG_MOST_LOADS = 500 };

/// Parts of the normal load at which `elastic` solves the contact: 1 to 0.1 evenly, to 0.002 by a
/// constant factor, 0. Against 72 of them 24 make Q_crit/Q_nom come out low by 0.000, 0.008 and
/// 0.005 on average at beta 0.8, 0.7 and 0.6 (FIX, 24 joints of 256^2 cells), by up to 0.02 on one.
/// @param loads  10 to LAC_RG_MOST_LOADS; LAC_RG_LOADS is usual
void lac_rg_loads(size_t loads, double *part);

/// Contact pressures of the same cells under falling load.
typedef struct lac_rg_series {
    size_t n, loads;
    const double *part;     ///< [loads] parts of the load, falling, from 1 to 0
    const double *pressure; ///< [loads * n] of each contact cell at each [Pa]; the last row all 0
    double friction;        ///< f [1]
} lac_rg_series;

/// Elastic contact, q = f [p(P) - p(P - Q/f)] (Ciavarella 1998, Jaeger 1998): the gap of a cell is
/// f p(P - Q/f), its strength under the load that is left.
lac_status lac_rg_path_elastic(const lac_rg_series *series, lac_rg_path **out, lac_error *err);

/// Solves the contact, under load control, at each part of the load (lac_rg_loads), from one to the
/// next.
/// @param pressure  [loads * domain->n] [Pa]
lac_status lac_rg_series_solve(const lac_contact_def *contact, const lac_domain *domain,
                               size_t loads, double *pressure, lac_error *err);
void lac_rg_path_free(lac_rg_path *path);

/// Tractions and gaps at a load, Q/Q_nom [1].
void lac_rg_path_eval(const lac_rg_path *path, double load, double *shear, double *gap);

/// The smallest load at which the joint slides, as part of Q_nom = f P; where it slides already
/// before a further load, the load that it carries.
/// @return Q_crit/Q_nom, to 1e-9
double lac_rg_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double *work);

/// A contact that can be solved again under less load.
typedef struct lac_rg_resolve_def {
    const lac_contact_def *contact; ///< load control
    const lac_domain *domain;       ///< its solution's
    double friction;                ///< f [1]
} lac_rg_resolve_def;

/// The load at which the joint slides, on contacts that are solved for it, each from the one
/// before, instead of interpolated ones: first near the critical load of the path, then closer.
/// @param path      elastic, of the same contact
/// @param critical  Q_crit/Q_nom, to 1e-6. The tree is left just before the joint slides
lac_status lac_rg_critical_solved(lac_rg_tree *tree, lac_rg_rule rule,
                                  const lac_rg_resolve_def *press, const lac_rg_path *path,
                                  double *critical, lac_error *err);

/// When the blocks of each level slip by themselves along a path: the size effect of the strength.
typedef struct lac_rg_sizes {
    size_t blocks;   ///< of the level that slip before all of the joint's strength is used up
    double load;     ///< Q/Q_nom of the joint at which they do, mean [1]
    double strength; ///< force that they carry then over their nominal area, mean [Pa]
    double spread;   ///< standard deviation of that [Pa]
} lac_rg_sizes;
