/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_COMMON_COMMAND_H
#define LACUNA_CLI_COMMON_COMMAND_H

#include "cli/common/options.h"

/// One command of the program.
struct cli_command {
    const char *name;
    const char *arguments; ///< "CASE", "[NAME]"
    const char *summary;   ///< one line
    const char *notes;     ///< a paragraph of the help text, wrapped, ending in a newline
    const char *example;
    size_t least, most; ///< number of arguments
    unsigned options;   ///< CLI_OPT_* it takes besides the common ones
    /// Does the command; prints results on stdout. An error it has already printed leaves the
    /// message in `err` empty.
    lac_status (*run)(const cli_request *request, lac_error *err);
};

/// The index-th command, NULL past the end.
const cli_command *cli_command_at(size_t index);

/// The command of a name, NULL where there is none.
const cli_command *cli_command_find(const char *name);

lac_status cli_run(const cli_request *request, lac_error *err);
lac_status cli_check(const cli_request *request, lac_error *err);
lac_status cli_contact(const cli_request *request, lac_error *err);
lac_status cli_rg(const cli_request *request, lac_error *err);
lac_status cli_precursors(const cli_request *request, lac_error *err);
lac_status cli_fit(const cli_request *request, lac_error *err);
lac_status cli_trade(const cli_request *request, lac_error *err);
lac_status cli_report_page(const cli_request *request, lac_error *err);
lac_status cli_mend(const cli_request *request, lac_error *err);
lac_status cli_new(const cli_request *request, lac_error *err);
lac_status cli_completion(const cli_request *request, lac_error *err);
lac_status cli_describe(const cli_request *request, lac_error *err);

#endif
