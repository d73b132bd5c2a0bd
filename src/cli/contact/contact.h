/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/scene.h"

/// Rows on the contact: grid, cells, fraction, pressures, D_box with what weakens it.
void cli_measures_print(const lac_scene_contact *contact);

/// All that was measured, in rows and, if `tables`, the whole series.
void cli_contact_print(const lac_case *c, const lac_contact_outcome *outcome, const char *path,
                       bool tables);
