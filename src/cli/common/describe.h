/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/command.h"
#include "data/json.h"

// Parts of `lacuna describe` that tell what is no model: rocks, and the gates of forecasts.

#define CLI_ROCK "rock"
#define CLI_ROCK_SUMMARY \
    "rocks and gouges that a friction law can take f0, a, b and dc from, by its key rock"

/// lacuna describe rock [NAME]: the list, or one of them.
lac_status cli_describe_rock(const cli_request *request, lac_error *err);

void cli_describe_gates(void);
void cli_describe_gates_json(lac_json *json);
