/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_ANALYSIS_H
#define LACUNA_CLI_RUN_ANALYSIS_H

#include "cli/json.h"
#include "lacuna/analysis.h"

/// What the indicators say when the run is over; NULL: nothing.
void cli_analysis_print(const lac_analysis *analysis);
void cli_analysis_json(cli_json *json, const lac_analysis *analysis);

#endif
