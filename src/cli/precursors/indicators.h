/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_PRECURSORS_INDICATORS_H
#define LACUNA_CLI_PRECURSORS_INDICATORS_H

#include "cli/precursors/precursors.h"
#include "store/store_events.h"

/// What a source holds besides its motion: of a run its events and cells.
typedef struct cli_cells {
    lac_stored_values event_time, event_duration, event_moment; ///< the second turns into ends
    lac_stored_values time, n_slip, n_tot, length, critical;
    lac_event_list events;
    lac_slip_history slip;
    lac_evidence evidence; ///< of the two above; points into this
} cli_cells;

/// Reads it. Where it ends is cut off at each time of issue.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status cli_cells_read(const cli_watched *watched, cli_cells *out, lac_error *err);
void cli_cells_clear(cli_cells *cells);

void cli_indicators_print(size_t count, const lac_precursor *indicator);
void cli_indicators_json(lac_json *json, size_t count, const lac_precursor *indicator);

/// One number of each indicator at each time of issue at which any has one.
void cli_course_print(const cli_precursors_result *r);

#endif
