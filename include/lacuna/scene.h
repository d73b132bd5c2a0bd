/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_H
#define LACUNA_SCENE_H

#include "lacuna/case.h"
#include "lacuna/fractal.h"
#include "lacuna/store.h"

/// The contact part of a scene: surface -> contact -> fractal measures.
typedef struct lac_scene_contact {
    lac_grid grid;
    double mean_pressure;       ///< total, over the nominal area [Pa]
    double e_star;              ///< [Pa]; NaN where no surface is pressed
    double *heights, *gap;      ///< [ny * nx] [m]; NULL where there is no surface
    double *pressure;           ///< [ny * nx] [Pa]
    lac_surface_report surface; ///< what the heights look like, where they are kept
    bool solved;                ///< a surface was pressed: `report` holds
    lac_contact_report report;
    bool counted; ///< box counting was possible: `boxes` holds
    lac_box_count boxes;
    bool scaled; ///< the contact was solved at coarser resolutions too: `scaling` holds
    lac_scaling scaling;
    lac_domain *domain;
} lac_scene_contact;

/// Everything that a case's run needs, built stage by stage; only what the case names.
typedef struct lac_scene {
    const lac_case *source;
    lac_scene_contact contact;
    lac_hierarchy *hierarchy;
    lac_transfer transfer;
    lac_friction *friction;
    lac_load_set loads;
    double damping; ///< [Pa s/m]
    lac_problem *problem;
} lac_scene;

/// Solves the contact of a case.
/// @param all  keep heights, gap and pressure, and measure the area scaling where the grid has
///             four resolutions (for `contact`); else only what a run needs
/// @return LAC_OK; LAC_EINPUT; LAC_ENUMERIC; LAC_ENOMEM
lac_status lac_scene_contact_solve(const lac_case *c, bool all, lac_scene_contact *out,
                                   lac_error *err);
void lac_scene_contact_clear(lac_scene_contact *contact);

/// Builds the whole scene of a case. The case must outlive it.
/// @return as lac_scene_contact_solve
lac_status lac_scene_create(const lac_case *c, lac_scene **out, lac_error *err);

/// Frees a scene; NULL is fine.
void lac_scene_free(lac_scene *scene);

#endif
