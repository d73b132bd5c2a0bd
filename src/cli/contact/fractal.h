/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_CONTACT_FRACTAL_H
#define LACUNA_CLI_CONTACT_FRACTAL_H

#include "cli/common/options.h"
#include "scene/scene.h"

/// What --boxes, --coarsening and --sizes ask for; the defaults where they are not given.
/// @return LAC_OK; LAC_EINPUT where a value makes no sense; LAC_EIO; LAC_ENOMEM
lac_status cli_fractal_read(const cli_request *request, lac_scene_measure_def *def, lac_error *err);

/// Rows on clusters, area scaling and size effect of a measured contact.
void cli_fractal_print(const lac_scene_contact *contact);

/// The whole series, as tables.
void cli_fractal_tables(const lac_scene_contact *contact);

#endif
