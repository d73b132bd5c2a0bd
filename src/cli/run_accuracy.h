/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_ACCURACY_H
#define LACUNA_CLI_RUN_ACCURACY_H

#include "cli/json.h"
#include "cli/progress.h"
#include "lacuna/accuracy.h"

/// Room for cli_accuracy_text.
enum { CLI_ACCURACY_TEXT = 256 };

/// Picks the settings of a run for solver.accuracy; nothing where the case has none.
/// @param pick  `pilots` stays 0 where nothing was asked
/// @return as lac_accuracy_choose
lac_status cli_accuracy_pick(cli_progress *progress, const cli_request *request, lac_scene *scene,
                             lac_case *c, lac_accuracy_pick *pick, lac_error *err);

/// What was picked, in one sentence.
const char *cli_accuracy_text(const lac_accuracy_pick *pick, char *text, size_t size);

/// A row on stdout; nothing where NULL.
void cli_accuracy_print(const lac_accuracy_pick *pick);

/// The key `accuracy` of an open object; null where NULL.
void cli_accuracy_json(cli_json *json, const lac_accuracy_pick *pick);

#endif
