/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/units.h"
#include "cli/common/options.h"
#include "data/json.h"
#include "series/series.h"

/// Reads a monitoring file by the options --time, --time-format, --displacement, --velocity and
/// --sigma, and warns of doubts.
/// @param known  its columns where the options name none; NULL: they must
/// @return LAC_OK; LAC_EINPUT; LAC_EIO; LAC_ENOMEM
lac_status cli_series_read(const cli_request *request, const lac_series_def *known,
                           const char *path, const lac_units *units, lac_series **out,
                           lac_error *err);

/// Whether options name columns to read.
bool cli_series_named(const cli_request *request);

/// Says what was taken for want of a word, a line each, unless --quiet.
void cli_series_warn(const cli_request *request, const char *path, const lac_series *series);

/// The same as JSON's list of texts, `warnings`.
void cli_series_warnings(lac_json *json, const lac_series *series);

/// Reads a time on the series' clock: a date where it is dated, else a quantity such as "10 day".
/// @param option  for the message
/// @return LAC_OK; LAC_EINPUT
lac_status cli_series_time(const char *option, const char *text, bool dated, const lac_units *units,
                           double *time, lac_error *err);
