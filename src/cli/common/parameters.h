/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/param.h"
#include "data/json.h"

/// Two lines a parameter: key, default, range; what it is.
void cli_parameters_print(const lac_param *params, size_t count);

/// The list `parameters` of {key, type, unit, default, min, max, ...}.
void cli_parameters_json(lac_json *json, const lac_param *params, size_t count);
