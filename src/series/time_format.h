/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/fail.h"

struct lac_units;

/// How the times of a file are written.
typedef struct lac_time_format {
    const char *pattern;  ///< with % marks; NULL: numbers, or ISO 8601 and seconds
    bool any;             ///< ISO 8601 or seconds, whichever the first row has
    bool dated;           ///< of numbers: they count from a date
    double scale, offset; ///< of numbers: seconds = scale x + offset
    char unit[16];        ///< of numbers, "day"; "" where the name is longer
    char allowed[96];     ///< for messages: what a time must be
} lac_time_format;

/// Understands a format: NULL or "iso" (ISO 8601, else seconds), "unix", "excel" (days since
/// 1899-12-30), a pattern such as "%d/%m/%Y %H:%M" (Y m d y b j H I M S p z), or what CF calls time
/// units: "day", "hours since 2015-06-07".
/// @param text  borrowed
/// @return LAC_OK; LAC_EINPUT
lac_status lac_time_format_read(const char *text, const struct lac_units *units,
                                lac_time_format *out, lac_error *err);

/// The name of a unit of time, to stand behind a number.
/// @param name  "" where the unit is longer
void lac_time_unit_name(const char *unit, char *name, size_t size);

/// Reads one time.
/// @param mark     decimal mark of numbers
/// @param seconds  since 1970 UTC where dated, else as written
/// @param dated    whether it is a date
/// @return false where the field is no such time
bool lac_time_format_take(const lac_time_format *format, const char *field, char mark,
                          double *seconds, bool *dated);
