/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_INTERNAL_H
#define LACUNA_SCENE_INTERNAL_H

#include "lacuna/scene.h"

// What is kept of a contact besides its domain.
typedef enum lac_scene_keep {
    LAC_SCENE_DOMAIN,   // nothing
    LAC_SCENE_FIELDS,   // heights, gaps and pressures
    LAC_SCENE_MEASURED, // those, and what the surface is like
} lac_scene_keep;

// lac_scene_contact_solve, with a choice of what is kept.
lac_status lac_scene_contact_make(const lac_case *c, lac_scene_keep keep, lac_scene_contact *out,
                                  lac_error *err);

// Counts boxes where the grid is large enough for a dimension.
lac_status lac_scene_contact_count(lac_scene_contact *contact, lac_error *err);

// eta = G/(2 cs) [Pa s/m]; no shear speed and no density: 0.
double lac_damping_of(const lac_material_def *material);

// Values of one parameter over the cells of a domain: nominal, spread by a distribution. Each
// cell's number depends on seed, key and its place on the grid only.
void lac_spread_fill(const lac_spread *spread, const lac_domain *domain, const double *nominal,
                     double *values);

// The spread of a key in a list; NULL where it has none.
const lac_spread *lac_spread_find(const lac_spread_list *list, const char *key);

#endif
