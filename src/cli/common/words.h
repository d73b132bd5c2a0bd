/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"
#include <stdarg.h>

/// An error that says what a word is not, and names the nearest known one, or all of them.
/// @param where  put before it, "" or ending in ": "
/// @param what   "command", "option" ...
/// @return LAC_EINPUT
lac_status cli_unknown(const char *where, const char *word, const char *what,
                       const char *const *known, size_t count, lac_error *err);

/// The row of a table that a word names; rows begin with their name, that of the last one is NULL.
/// @return NULL: none, which `err` says as cli_unknown does
const void *cli_find(const char *where, const char *word, const char *what, const void *rows,
                     size_t stride, lac_error *err);

/// Reads the number of an option, from 1 to `most`. @return LAC_OK; LAC_EINPUT
lac_status cli_count(const char *option, const char *text, int most, int *out, lac_error *err);

/// Prints one line on stderr, after the program's name.
void cli_note(const char *format, ...) __attribute__((format(printf, 1, 2)));
void cli_note_list(const char *format, va_list args) __attribute__((format(printf, 1, 0)));

/// Prints `  label    text` on stdout.
void cli_row(const char *label, const char *format, ...) __attribute__((format(printf, 2, 3)));

/// A short text by value: it lives as long as the statement that it stands in.
typedef struct cli_text {
    char s[560]; ///< longer than LAC_TEXT_ROOM
} cli_text;
cli_text cli_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

/// A value with the unit that reads best, to four digits and in full; a time since 1970 as a date,
/// "" where it has none.
cli_text cli_amount(double value, const char *unit);
cli_text cli_exact(double value, const char *unit);
cli_text cli_date(double seconds);

/// A unit of time, and its name, in a head of four letters too.
typedef struct cli_time_unit {
    double seconds;
    const char *head, *name;
} cli_time_unit;

/// The largest unit of which a time holds so many, else the second.
const cli_time_unit *cli_time_unit_of(double seconds, double least);

/// As cli_row, a text wrapped to 79 columns.
void cli_row_wrap(const char *label, const char *text);

/// Prints `  label    value unit` on stdout, the unit chosen to read well.
void cli_row_quantity(const char *label, double value, const char *unit);

/// Prints a text on stdout, wrapped to 79 columns, each line after `indent`.
void cli_wrap(const char *indent, const char *text);

/// As cli_wrap, the first line after `lead`, which is as wide as the indent.
void cli_wrap_after(const char *lead, const char *indent, const char *text);

/// Puts '?' in the place of control and hidden characters in all that is printed on stdout from
/// here on. Without memory nothing changes.
void cli_clean_stdout(void);
