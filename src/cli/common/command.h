/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"

/// Exit statuses of the program.
enum {
    CLI_EXIT_DONE = 0,
    CLI_EXIT_FAILED = 1,      ///< the computation broke
    CLI_EXIT_WRONG = 2,       ///< usage, case or data
    CLI_EXIT_FILE = 3,        ///< could not be read or written
    CLI_EXIT_INTERRUPTED = 4, ///< what was computed is whole
};

/// That of a result: the one place that says so.
int cli_exit_status(lac_status status);

/// What each command does, a row each of the table in registry.c.
typedef lac_status cli_action(const cli_request *request, lac_error *err);
cli_action cli_run, cli_check, cli_contact, cli_rg, cli_precursors, cli_fit, cli_trade, cli_sweep,
    cli_gather, cli_report_page, cli_export, cli_watch, cli_mend, cli_new, cli_completion,
    cli_describe;

/// Prints what may stand in the place of the last word, one candidate a line: "WORD<Tab>MEANING". A
/// line ":BEFORE<Tab>ENDINGS" says that a name of a file may, behind what is before it in the word:
/// one of these endings ("yaml|nc"), or any where none is named. Says nothing else, whatever the
/// words are.
/// @param word  [count] the words after the program's name, up to the cursor; also as bash cuts
///              them at = and :, and with the quotes that were typed
void cli_complete(int count, char **word);

/// A text that the program writes as it is, made from the files in `texts/` when Lacuna is built.
typedef struct cli_named_text {
    const char *name;
    const char *text;
} cli_named_text;

/// Cases to start from by their kind, and what shells read by the shell; the last name is NULL.
extern const cli_named_text cli_templates[], cli_template_readings[], cli_shells[];
