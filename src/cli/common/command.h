/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_COMMON_COMMAND_H
#define LACUNA_CLI_COMMON_COMMAND_H

#include "cli/common/options.h"

// What each command does, a row each of the table in registry.c.
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
