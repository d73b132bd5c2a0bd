/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/slip_events.h"
#include "cli/report/report.h"
#include "data/json.h"
#include "simulation/simulation.h"

/// A sink that passes everything on and keeps what the summary and the comparison need.
typedef struct cli_history {
    lac_sink next;
    bool keep;    ///< keep time, slip and rate of every record, and those of the points
    double clock; ///< added to the kept times [s]
    cli_kept kept;
    bool begun;
    lac_record first, last;
    lac_slip_events slip_events; ///< with fidelity ode
} cli_history;

/// The sink; valid while `history` stays where it is.
lac_sink cli_history_sink(cli_history *history);

/// Everything that is said about a run when it is over.
typedef struct cli_outcome {
    const lac_outcome *of;
    cli_history history;
    cli_compare compare;
    const char *status; ///< complete, interrupted; failed also where the file is not whole
    const lac_checkpoint *resumed; ///< what the run went on from; NULL: from the start
    char *path;                    ///< of the file
    double wall_time;              ///< [s]
} cli_outcome;

/// Whether the slope failed, of a run that did not break: what was computed then counts for
/// nothing.
bool cli_outcome_failed(const cli_outcome *outcome);

/// The summary on stdout.
void cli_outcome_print(const cli_outcome *outcome);

/// The same as one JSON object.
lac_status cli_outcome_json(const cli_outcome *outcome, lac_error *err);

/// Why a failure rate that is lowered counts in the place of the case's, and how it is judged.
extern const char *const cli_failure_lowered;

/// Warns where damping leaves little or nothing between the slip rate at the start and failure.
void cli_failure_warn(const lac_failure *failure);
