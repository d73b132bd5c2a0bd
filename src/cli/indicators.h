/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_INDICATORS_H
#define LACUNA_CLI_INDICATORS_H

#include "cli/precursors.h"
#include "lacuna/precursor.h"

/// What the indicators say at the last reading.
typedef struct cli_indicators {
    size_t count;
    lac_precursor found[LAC_PRECURSORS_MAX];
} cli_indicators;

/// Looks at the source up to the last reading: the motion, and of a run its events and cells.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status cli_indicators_look(const cli_watched *watched, const lac_outlook *outlook,
                               cli_indicators *out, lac_error *err);

void cli_indicators_print(const cli_indicators *indicators);
void cli_indicators_json(cli_json *json, const cli_indicators *indicators);

#endif
