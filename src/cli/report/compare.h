/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"
#include "cli/common/options.h"
#include "data/json.h"
#include "series/series.h"

/// The monitoring series that a case lays beside its run.
typedef struct cli_compare {
    const lac_case *source;
    size_t count;
    lac_series **series; ///< [count] on the run's clock
} cli_compare;

/// Reads the case's series, before anything is computed, and warns of doubts.
/// @return LAC_OK; LAC_EIO; LAC_EINPUT (a wrong file; dates beside a run without a date);
///         LAC_ENOMEM
lac_status cli_compare_read(const cli_request *request, const lac_case *c, cli_compare *compare,
                            lac_error *err);
void cli_compare_clear(cli_compare *compare);

/// Prints one table per series: observed and modelled where there are few readings, and misfits.
/// @param run  times on the clock of dates where the case has one
void cli_compare_print(const cli_compare *compare, const lac_history *run);

/// The same as a list under `compare`.
void cli_compare_json(lac_json *json, const cli_compare *compare, const lac_history *run);
