/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "simulation/simulation.h"

/// Error that taking cells together caused in a run that has ended, relative: of its time of
/// failure or of a limit, else of its mean slip; lac_lump_bound of it and of one more run, in which
/// the cells of a block slip less apart. INFINITY where that run ends otherwise.
/// @param def    of the run; its rtol, sink and points do not count
/// @param lump   of which the run was; as before afterwards
/// @return LAC_OK; as lac_run
/// @cost   a run of the lump at an rtol no tighter than 1e-5
/// @source docs/theory/lumped.md
lac_status lac_lumped_judge(lac_lump *lump, const lac_run_def *def, const lac_run_result *run,
                            double *error, lac_error *err);

/// A sink before another one that writes what it gets of leaves back to their cells.
typedef struct lac_lumped_sink lac_lumped_sink;

lac_status lac_lumped_sink_create(const lac_lump *lump, const lac_domain *cells,
                                  const lac_sink *next, lac_lumped_sink **out, lac_error *err);
void lac_lumped_sink_free(lac_lumped_sink *sink);
lac_sink lac_lumped_sink_of(lac_lumped_sink *sink);
