/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_DATE_H
#define LACUNA_BASE_DATE_H

#include <stdbool.h>
#include <stddef.h>

/// Reads an ISO 8601 date or date and time: 1963-10-09, 1963-10-09T22:39, ...T22:39:05.25,
/// with Z, +01:00 or no zone (read as UTC). A space may stand for the T.
/// @param seconds  since 1970-01-01T00:00:00Z, proleptic Gregorian
/// @return false where the text is anything else, a date that does not exist included
bool lac_date_parse(const char *text, double *seconds);

/// Writes YYYY-MM-DDThh:mm:ssZ, rounded to a second.
/// @return text; "" where the date does not fit years 0 to 9999 or the buffer (at least 21 bytes)
const char *lac_date_format(double seconds, char *text, size_t size);

#endif
