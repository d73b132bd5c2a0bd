/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "sweep/ensemble.h"

/// What is asked of an ensemble.
typedef struct cli_question {
    lac_ensemble_result of;
    double by; ///< in its unit; NaN: not given
} cli_question;

/// Prints what an ensemble says, in words.
void cli_answers_print(const lac_answers *answers);

/// Reads --of and --by: the latter of a time of failure a time of the case or a date, else a
/// quantity of the result's unit.
/// @param extra  [extras] of the ensemble
/// @return as lac_ensemble_result_find, cli_parse_time
lac_status cli_question_read(const cli_request *request, const lac_case *c, size_t extras,
                             const lac_ensemble_extra *extra, cli_question *out, lac_error *err);
