/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/scene.h"

typedef struct lac_estimate lac_estimate;

// The loads that a case names made ready as lac_load_set_create does.
lac_status lac_scene_loads_create(const lac_case *c, lac_load_files *files, lac_load_set *out,
                                  lac_error *err);

// Whether the friction of cells differs in any of these. @param keys  NULL at the end
bool lac_case_spreads(const lac_case *c, const char *const keys[]);

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
