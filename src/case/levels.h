/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/param.h"
#include "base/units.h"
#include "forecast/verdict.h"

/// Least horizon of alarms [s]: a bare number is of seconds, and "3" was hardly meant so.
#define LAC_LEAST_HORIZON 600.0

// The thresholds of a verdict's level in a small file in the manner of a case.

/// The keys, a row of lac_levels each. Defaults are those of lac_levels_default, not of the rows.
extern const lac_model_info lac_levels_table;

/// Reads and checks a file; what it does not name is the default.
/// @param out  set only on success
/// @return LAC_OK; LAC_EINPUT (the first error with its line and key); LAC_EIO; LAC_ENOMEM
lac_status lac_levels_read(const char *path, const lac_units *units, lac_levels *out,
                           lac_error *err);

/// Writes the default as such a file: above each key what it does.
void lac_levels_put_default(FILE *out);
