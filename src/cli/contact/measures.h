/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_CONTACT_MEASURES_H
#define LACUNA_CLI_CONTACT_MEASURES_H

#include "data/json.h"
#include "scene/scene.h"

/// Rows on the contact: grid, cells, fraction, pressures, D_box with what weakens it.
void cli_measures_print(const lac_scene_contact *contact);

/// The same as keys of an open object.
/// @return LAC_OK; LAC_ENOMEM
lac_status cli_measures_json(lac_json *json, const lac_scene_contact *contact, lac_error *err);

#endif
