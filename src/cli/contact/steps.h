/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_CONTACT_STEPS_H
#define LACUNA_CLI_CONTACT_STEPS_H

#include "cli/common/options.h"
#include "data/json.h"
#include "scene/scene.h"

/// The history of a contact: what it came to, for the summary.
typedef struct cli_steps {
    const char *status; ///< of the file: complete, interrupted, failed
    double friction;
    lac_grid grid;
    lac_history_result result;
    lac_history_record *record; ///< [result.steps]
} cli_steps;

/// Goes through the history of a case, writes its file, shows progress; SIGINT and SIGTERM end it
/// between two steps.
/// @param def    of the file
/// @param steps  for the caller to print and to clear, whatever the status
/// @return as lac_scene_history_run and the store's functions; LAC_EINTERRUPT with a whole file
lac_status cli_steps_run(const cli_request *request, const lac_case *c,
                         const lac_scene_contact *contact, const lac_history_store_def *def,
                         cli_steps *steps, lac_error *err);

/// Prints a table of the steps.
void cli_steps_print(const cli_steps *steps);

/// Writes the keys `status`, `history_method` ... and `steps`.
void cli_steps_json(lac_json *json, const cli_steps *steps);

void cli_steps_clear(cli_steps *steps);

#endif
