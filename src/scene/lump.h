/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"
#include "run/points.h"

/// Cells of blocks taken together: the scene's problem on few cells, each with a weight.
typedef struct lac_lump {
    lac_domain *domain; ///< those cells: some of the scene's, with weights
    lac_friction *friction;
    lac_load_set loads; ///< borrowed but for the shape
    lac_classes *classes;
    lac_problem *problem;
    uint32_t *leaf;  ///< [cells of the scene] which of them stands for each
    uint32_t *kept;  ///< [cells of the domain] which of the scene's they are
    double *bond;    ///< [nodes of the classes] their k as the scene has it
    size_t level;    ///< of the blocks
    size_t blocks;   ///< of that level
    double rest;     ///< error of the quadrature: of the logarithm of the slip rate [1]
    double weakness; ///< p b/dc over what holds the cells of a block against each other [1]
    double mismatch; ///< of the slip apart that its leaves have, relative [1]
    double gain;  ///< by which the time of failure is more off than that, near a steady state [1]
    size_t inner; ///< nodes, behind the leaves, that are blocks of leaves
} lac_lump;

/// What a lump is made from.
typedef struct lac_lump_source {
    lac_problem_def whole;       ///< the scene's, as its problem was made
    const lac_problem *problem;  ///< made of it
    const lac_hierarchy *blocks; ///< over its cells
    const lac_lump *like;        ///< whose cells and weights are taken; NULL: what suits
} lac_lump_source;

/// Takes the cells of each block of a level together. docs/theory/lumped.md.
/// @return LAC_OK; LAC_EINPUT (why the scene cannot be lumped); LAC_ENOMEM
/// @cost   O(n levels); of each block as lac_cubature_thin
lac_status lac_lump_create(const lac_lump_source *source, const lac_lump_def *def, lac_lump **out,
                           lac_error *err);
void lac_lump_free(lac_lump *lump);

/// Makes the cells of a block follow their traction `softness` times as far as they do: 1 as it is,
/// near 0 as one. Its problem is another one then.
void lac_lump_soften(lac_lump *lump, double softness);

/// Softness at which a second run tells what slip apart within the blocks does in all.
#define LAC_LUMP_STIFF 0.25

/// How far off a result of the lump may be, relative: docs/theory/lumped.md eq. 3.
/// @param other   the result at LAC_LUMP_STIFF
/// @param driven  the joint fails, so that friction alone decides it
/// @return INFINITY where it cannot be told
double lac_lump_bound(const lac_lump *lump, double value, double other, bool driven);

/// Makes points that were found among the cells those of the leaves that stand for them.
void lac_lump_points(const lac_lump *lump, const lac_domain *cells, lac_points *points);
