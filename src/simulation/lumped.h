/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "simulation/simulation.h"

/// A sink before another one that writes what it gets of leaves back to their cells.
typedef struct lac_lumped_sink lac_lumped_sink;

lac_status lac_lumped_sink_create(const lac_lump *lump, const lac_domain *cells,
                                  const lac_sink *next, lac_lumped_sink **out, lac_error *err);
void lac_lumped_sink_free(lac_lumped_sink *sink);
lac_sink lac_lumped_sink_of(lac_lumped_sink *sink);
