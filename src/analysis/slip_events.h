/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/crest.h"

/// A stretch of time in which the largest slip rate of the whole interface is high.
typedef struct lac_slip_event {
    double start, end; ///< [s]; NaN: before the run begins, after it ends
    double peak,
        max_rate; ///< when its largest slip rate is, and that of which cell ever [s], [m/s]
} lac_slip_event;

/// All of them, from the steps of a run: docs/theory/events.md, "The interface as a whole". Zeros
/// at first.
typedef struct lac_slip_events {
    lac_slip_event *event; ///< [count]
    size_t count, room;
    bool begun, moves;
    double last;    ///< largest slip rate at the end of the last step [m/s]
    lac_crest past; ///< while it moves
} lac_slip_events;

/// Slip rates at which they begin and end [m/s].
#define LAC_SLIP_EVENT_RISE 1e-3
#define LAC_SLIP_EVENT_FALL 5e-4

void lac_slip_events_clear(lac_slip_events *s);

/// Follows a step of all cells. @return LAC_ENOMEM
lac_status lac_slip_events_step(lac_slip_events *s, const lac_step *step, lac_error *err);

/// Passes what it has seen so far; to zeros, where the archive is loading.
void lac_slip_events_serialize(lac_slip_events *s, lac_archive *archive);
