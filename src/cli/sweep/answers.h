/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "sweep/answers.h"

/// Prints what an ensemble says, in words.
void cli_answers_print(const lac_answers *answers);

/// Reads --by, a time of the case or a date; NaN: not given.
/// @return as cli_parse_time
lac_status cli_sweep_by(const cli_request *request, const lac_case *c, double *by, lac_error *err);
