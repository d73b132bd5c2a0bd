/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_DESCRIBE_H
#define LACUNA_SCENE_DESCRIBE_H

#include "scene/scene.h"

/// Adds the box-counting dimension of a contact to its dataset.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_describe_dimension(const lac_scene_contact *contact, lac_dataset *dataset,
                                  lac_error *err);

/// Adds its other fractal measures.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_describe_fractal(const lac_scene_contact *contact, lac_dataset *dataset,
                                lac_error *err);

#endif
