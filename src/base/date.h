/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Reads an ISO 8601 date or date and time, with Z, +01:00 or no zone (UTC), as seconds since 1970;
/// a space may stand for the T. False where the text is anything else, a date that does not exist
/// included.
bool lac_date_parse(const char *text, double *seconds);

/// Writes YYYY-MM-DDThh:mm:ssZ, rounded to a second.
/// @return text; "" where the date does not fit years 0 to 9999 or the buffer (at least 21 bytes)
const char *lac_date_format(double seconds, char *text, size_t size);
