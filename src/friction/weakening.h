/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"

// What weakens, or strengthens, cells besides the state of their friction, by unknowns of each cell
// of its own. Of a mechanism k, with j over its unknowns, docs/theory/weakening.md eq. 1:
//
//     dx_j/dt = gain_j S_k - decay_j x_j,   z_k = sum of x_j
//
// S_k is one number of the cell, its source; z_k the pore pressure in excess of that of the loads,
// or the part of the cohesion that is broken.

// The mechanisms that a case can name: a new one is one more line here.
// clang-format off
#define LAC_WEAKENINGS(_)           \
    _(lac_weakening_bridges),       \
    _(lac_weakening_dilatancy),     \
    _(lac_weakening_pressurization)
// clang-format on

enum {
    LAC_WEAKENING_MODES = 48, ///< unknowns that one mechanism may have in a cell
    LAC_MOST_WEAKENINGS = 3,  ///< each once
};

/// What the sources of some cells are made of, in the state that they are in. Stresses are over the
/// nominal area.
typedef struct lac_weakening_cells {
    size_t n;
    const double *v;        ///< [n] size of the slip rate [m/s]
    const double *f;        ///< [n] friction coefficient
    const double *f_u;      ///< [n] by ln v
    const double *f_w;      ///< [n] by ln theta
    const double *g;        ///< [n] d ln theta/dt [1/s]
    const double *g_u;      ///< [n] by ln v; NULL where no derivatives are asked for
    const double *g_w;      ///< [n] by ln theta
    const double *normal;   ///< [n] effective normal stress [Pa]
    const double *cohesion; ///< [n] that is not broken [Pa]
} lac_weakening_cells;

/// Sources of cells, and derivatives, all of which are NULL where they are not asked for.
typedef struct lac_weakening_sources {
    double *s;
    double *s_u, *s_w;  ///< by ln v and ln theta
    double *s_normal;   ///< by the effective normal stress
    double *s_cohesion; ///< by the cohesion that is left
} lac_weakening_sources;

/// The unknowns of a mechanism.
typedef struct lac_weakening_modes {
    size_t n;
    double decay[LAC_WEAKENING_MODES]; ///< [1/s]
    double gain[LAC_WEAKENING_MODES];
    double heat[LAC_WEAKENING_MODES]; ///< what it tells of a temperature [K per unit of x]
} lac_weakening_modes;

/// A joint that a mechanism is told of.
typedef struct lac_weakening_joint {
    double normal;   ///< total normal stress over the nominal area [Pa]
    double f0;       ///< of its friction
    double excess;   ///< b - a
    double cohesion; ///< [Pa]
} lac_weakening_joint;

/// A mechanism that a case can name.
typedef struct lac_weakening_kind {
    lac_model_info info;
    bool pore; ///< z is pore pressure [Pa]; else part of the cohesion [1]
    bool warm; ///< it has a temperature
    void (*modes)(const void *params, lac_weakening_modes *modes);
    void (*source)(const void *params, const lac_weakening_cells *cells,
                   const lac_weakening_sources *out);
    /// What it can do to a joint, in a sentence. @param text  [size] set
    void (*words)(const void *params, const lac_weakening_joint *joint, char *text, size_t size);
} lac_weakening_kind;

extern const lac_weakening_kind LAC_WEAKENINGS(LAC_ROW_ITSELF);

/// The index-th mechanism, NULL past the end.
const lac_weakening_kind *lac_weakening_get(size_t index);

/// One that a case names.
typedef struct lac_weakening {
    const lac_weakening_kind *kind;
    const void *params; ///< of the case, which outlives it
    lac_weakening_modes modes;
    size_t first; ///< of its unknowns among those of all
} lac_weakening;

/// Those that a case names.
typedef struct lac_weakening_set {
    size_t count, modes; ///< unknowns of a cell
    bool pore, bridges, warm;
    lac_weakening item[LAC_MOST_WEAKENINGS];
} lac_weakening_set;

/// Puts together what a case names.
/// @param models  [count] the mechanisms; their parameters must outlive the set
/// @return LAC_OK; LAC_EINPUT where one stands twice
lac_status lac_weakening_set_create(const lac_model *models, size_t count, lac_weakening_set *out,
                                    lac_error *err);
