/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/crest.h"

/// An event on its way.
typedef struct lac_open_event {
    double origin, local; ///< of its start: origin + local [s]
    uint32_t first;       ///< cell that moved first; of a vacant place: the next vacant one
    double slip;          ///< sum over the motions that have ended [m]
    double max_rate;      ///< [m/s]
    size_t moving;        ///< cells that move now
    uint32_t *cells;      ///< [count] that have moved; some may stand there twice
    size_t count, room;
    bool open, before; ///< before: cells of it moved when the run began
} lac_open_event;

/// A cell that begins or ceases to move within a step.
typedef struct lac_motion_change {
    double share; ///< of the step's length before it
    uint32_t cell;
    bool rises;
} lac_motion_change;

/// The catalogue of a run's events: docs/theory/events.md. What changes is from `begun` to
/// `slip_sum`; the rest follows from how it was made, or is scratch.
typedef struct lac_catalogue {
    const lac_domain *domain;
    double rise, fall;   ///< slip rates at which a cell begins and ceases to move [m/s]
    double modulus;      ///< G [Pa]; NaN: none
    uint32_t *neighbour; ///< [8 n]
    bool begun;
    double origin, local; ///< of the last step [s]
    lac_crest past;       ///< rates up to then
    double *slip;         ///< [n] slip then [m]
    double *slip_at_rise; ///< [n] of cells that move [m]
    uint8_t *moves;       ///< [n]
    uint32_t *event; ///< [n] and the arrays of its kind below: place of the open event it belongs
                     ///< to; UINT32_MAX: none
    uint32_t *active, *place; ///< [n] cells that move; where each of them stands there
    size_t actives;           ///< of them
    lac_open_event *open;     ///< [places]
    size_t places;
    uint32_t vacant;                             ///< first vacant place; UINT32_MAX: none
    int64_t events, cut;                         ///< put out; of them cut by the ends of the run
    double largest_slip, largest_size, slip_sum; ///< of one event [m], [m]; of all [m]
    lac_motion_change *change;                   ///< [n] scratch
    uint32_t *cell_mark, *x_mark, *y_mark;       ///< [n], [nx], [ny] scratch
    uint32_t mark;
} lac_catalogue;

/// @param modulus  G [Pa]; NaN: none
lac_status lac_catalogue_create(const lac_domain *domain, double rise, double fall, double modulus,
                                lac_catalogue *out, lac_error *err);
void lac_catalogue_clear(lac_catalogue *c);

/// Follows a step; events that end within it go to the sink.
lac_status lac_catalogue_step(lac_catalogue *c, const lac_step *step, const lac_sink *sink,
                              lac_error *err);

/// Passes what it has seen so far; to a catalogue that was just made, where the archive is loading.
void lac_catalogue_serialize(lac_catalogue *c, lac_archive *archive);

/// Ends the events that are open at the last step.
lac_status lac_catalogue_close(lac_catalogue *c, const lac_sink *sink, lac_error *err);
