/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"
#include "scene/lump_walk.h"

/// Cells of blocks taken together: the scene's problem on few cells, each with a weight.
typedef struct lac_lump {
    lac_domain *domain; ///< those cells: some of the scene's, with weights
    lac_friction *friction;
    lac_load_set loads; ///< borrowed but for the shape
    lac_classes *classes;
    lac_problem *problem;
    uint32_t *leaf;           ///< [cells of the scene] which of them stands for each
    uint32_t *kept;           ///< [cells of the domain] which of the scene's they are
    size_t level;             ///< of the blocks
    size_t blocks;            ///< of that level
    double stretch;           ///< by which what ties the leaves of its blocks is multiplied
    lac_lump_arrival arrival; ///< how the run ends, by the way there in few steps
    double comes_to;          ///< by that way
    double error; ///< estimated, relative, of what it then comes to; INFINITY: cannot be told
} lac_lump;

/// What a lump is made from.
typedef struct lac_lump_source {
    lac_problem_def whole;       ///< the scene's, as its problem was made
    const lac_problem *problem;  ///< made of it
    const lac_hierarchy *blocks; ///< over its cells
    const lac_lump *like;        ///< whose cells and weights are taken; NULL: what suits
    const lac_run_def *ends;     ///< how its runs end, as lac_lump_walk takes it
} lac_lump_source;

/// Takes the cells of each block of a level together. docs/theory/lumped.md.
/// @return LAC_OK; LAC_EINPUT (why the scene cannot be lumped); LAC_ENOMEM
/// @cost   O(n levels); of each block as lac_cubature_thin
lac_status lac_lump_create(const lac_lump_source *source, const lac_lump_def *def, lac_lump **out,
                           lac_error *err);
void lac_lump_free(lac_lump *lump);

/// Error of a run of the lump, estimated, relative: of the time of failure or of a limit, or, where
/// its time was over first, of the mean slip. INFINITY: cannot be told.
/// @param value  what it came to; NaN: it was stopped on its way
double lac_lump_error(const lac_lump *lump, bool by_time, double value);

/// @return LAC_OK; LAC_ENUMERIC: the error is more than `most`, or cannot be told
lac_status lac_lump_judge(const lac_lump *lump, double error, double most, lac_error *err);
