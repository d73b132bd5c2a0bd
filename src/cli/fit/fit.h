/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_FIT_FIT_H
#define LACUNA_CLI_FIT_FIT_H

#include "fit/fit.h"

/// Whether the draws can be relied on.
/// @return LAC_OK; LAC_ENUMERIC: says which unknown was sampled worst and what it trades off with
lac_status cli_fit_judge(const lac_fit_result *result, lac_error *err);

/// Prints what it came to on stdout.
void cli_fit_print(const lac_fit_outcome *outcome, const char *series, double wall_time,
                   bool verbose);

#endif
