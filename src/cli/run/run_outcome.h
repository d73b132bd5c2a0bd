/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_RUN_OUTCOME_H
#define LACUNA_CLI_RUN_RUN_OUTCOME_H

#include "cli/report/compare.h"
#include "cli/run/history.h"
#include "simulation/simulation.h"

/// Everything that is said about a run when it is over.
typedef struct cli_outcome {
    const lac_outcome *of;
    const cli_history *history;
    const cli_compare *compare;
    const char *status; ///< complete, interrupted; failed also where the file is not whole
    const lac_checkpoint *resumed; ///< what the run went on from; NULL: from the start
    const char *path;              ///< of the file
    double wall_time;              ///< [s]
} cli_outcome;

/// Whether the slope failed, of a run that did not break: what was computed then counts for
/// nothing.
bool cli_outcome_failed(const cli_outcome *outcome);

/// The summary on stdout.
void cli_outcome_print(const cli_outcome *outcome);

/// The same as one JSON object.
lac_status cli_outcome_json(const cli_outcome *outcome, lac_error *err);

#endif
