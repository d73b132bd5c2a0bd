/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_INTERNAL_H
#define LACUNA_SCENE_INTERNAL_H

#include "lacuna/scene.h"

// eta = G/(2 cs) [Pa s/m]; no shear speed and no density: 0.
double lac_damping_of(const lac_material_def *material);

// Values of one parameter over the cells of a domain: nominal, spread by a distribution. Each
// cell's number depends on seed, key and its place on the grid only.
void lac_spread_fill(const lac_spread *spread, const lac_domain *domain, const double *nominal,
                     double *values);

// The spread of a key in a list; NULL where it has none.
const lac_spread *lac_spread_find(const lac_spread_list *list, const char *key);

#endif
