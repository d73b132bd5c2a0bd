/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/dataset.h"
#include "scene/lump.h"

/// Cells that were taken together, as they are told.
typedef struct cli_lump {
    const lac_lump *lump; ///< NULL: none were, nothing is told
    size_t cells;         ///< that it stands for
    double error, asked;  ///< by estimate; allowed
    const char *result;   ///< what the error is of
} cli_lump;

void cli_lump_print(cli_lump of);
void cli_lump_json(lac_json *json, cli_lump of);
