/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/archive.h"
#include "lacuna/simulation.h"

/// What a run put out, to be put out again: a run whose sink is not known yet.
typedef struct lac_tape {
    size_t values; ///< that an analysis adds to a record
    size_t points; ///< that records tell of
    bool cells;    ///< records keep their cells
    bool steps;    ///< it keeps them, all of whose cells have moved on
    size_t most;   ///< bytes that it may take; beyond them it drops all
    bool over;     ///< it came to that
    lac_archive kept;
} lac_tape;

/// The sink that fills it: records, snapshots, events, steps where it keeps them; no checkpoints.
lac_sink lac_tape_sink(lac_tape *tape);

/// Puts out what there is, in the order in which it came.
/// @return LAC_OK; what the sink returns
lac_status lac_tape_play(const lac_tape *tape, const lac_sink *to, lac_error *err);

/// Drops what there is.
void lac_tape_clear(lac_tape *tape);
