/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "simulation/simulation.h"

/// Runs the lump of a scene: its cells' fields are what the sink gets. A time that may be off by
/// more than the case allows is none.
/// @param sink  NULL: nothing is put out
/// @return as lac_run; LAC_ENUMERIC: its error is more than solver.lump.error, or cannot be told
lac_status lac_lumped_run(const lac_scene *scene, const lac_run_def *def, const lac_sink *sink,
                          lac_run_result *out, lac_error *err);
