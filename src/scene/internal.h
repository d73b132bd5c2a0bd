/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/scene.h"

typedef struct lac_estimate lac_estimate;

// The mean normal stress that a case states [Pa]; NaN where it follows from the contact.
double lac_case_pressure(const lac_case *c);

// The loads that a case names, and these made ready as lac_load_set_create does.
lac_load_models lac_case_loads(const lac_case *c);
lac_status lac_scene_loads_create(const lac_case *c, lac_load_files *files, lac_load_set *out,
                                  lac_error *err);

// Finds out what of an estimate (its cells known) says how cells hold one another.
void lac_judge_stability(const lac_case *c, lac_estimate *e);

// The other fidelity, where it is known to be the faster one; NULL.
const char *lac_faster_fidelity(const lac_case *c, const lac_estimate *e);

// Sees whether a case's scene can be made, and what counts as its failure.
lac_status lac_scene_try(const lac_case *c, lac_load_files *files, lac_estimate *e, lac_error *err);

// What is kept of a contact besides its domain.
typedef enum lac_scene_keep {
    LAC_SCENE_DOMAIN,   // nothing
    LAC_SCENE_FIELDS,   // heights, gaps and pressures
    LAC_SCENE_MEASURED, // those, and what the surface is like
} lac_scene_keep;

// lac_scene_contact_solve, with a choice of what is kept.
lac_status lac_scene_contact_make(const lac_case *c, lac_scene_keep keep, lac_scene_contact *out,
                                  lac_error *err);

// A contact that was solved, to be pressed again.
lac_contact_def lac_scene_contact_def(const lac_scene_contact *contact);

// Counts boxes where the grid is large enough for a dimension.
lac_status lac_scene_contact_count(lac_scene_contact *contact, lac_error *err);

// Adds the box-counting dimension of a contact to its dataset.
lac_status lac_describe_dimension(const lac_scene_contact *contact, lac_dataset *dataset,
                                  lac_error *err);

// Adds its other fractal measures.
lac_status lac_describe_fractal(const lac_scene_contact *contact, lac_dataset *dataset,
                                lac_error *err);

// Where a parameter varies.
typedef struct lac_heterogeneity_place {
    const lac_domain *domain;
    const lac_hierarchy *hierarchy; // of the domain; NULL: made where it is needed
} lac_heterogeneity_place;

// Values of one parameter over the cells: nominal, or the map of values, times the factors of all
// its spreads. A random factor depends on its seed, the key, its rank among the key's spreads and
// the cell's place on the grid only.
// @param nominal  NaN where only a map gives values
lac_status lac_heterogeneity_fill(const lac_heterogeneity_place *place,
                                  const lac_heterogeneity_list *list, const char *key,
                                  const char *unit, double nominal, double *values, lac_error *err);

// Size of every cell's patch or block [m]. @param size  [n] overwritten
lac_status lac_heterogeneity_sizes(const lac_heterogeneity_place *place, lac_size_of of,
                                   double *size, lac_error *err);
