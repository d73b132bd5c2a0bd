/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdio.h>

#include "series/series.h"

/// Reads as lac_series_read from a stream (the fuzzer's way in); def->path names it in messages.
lac_status lac_series_read_stream(FILE *stream, const lac_series_def *def,
                                  const struct lac_units *units, lac_series **out, lac_error *err);

/// Whether a file begins as netCDF does; the stream is at its beginning before and after.
bool lac_series_is_netcdf(FILE *stream);

/// Reads as lac_series_read from a netCDF file.
lac_status lac_series_read_netcdf(const lac_series_def *def, const struct lac_units *units,
                                  lac_series **out, lac_error *err);

enum { LAC_SERIES_VALUES = 4 }; ///< displacement, velocity, any other, error of a displacement

/// A row of a file: time, values (NaN: not given), line.
typedef struct lac_row {
    double time, value[LAC_SERIES_VALUES];
    size_t line;
} lac_row;

/// Sorts rows by time, and by line where times are equal.
/// @return how many were earlier than the one before them
size_t lac_rows_sort(size_t n, lac_row *rows);

/// Keeps the first of the sorted rows of each time; a value that it lacks comes from a later one.
/// @param n          how many there are; on return, how many are kept
/// @param conflicts  rows dropped although a value differs from the one that is kept
/// @return a line that was dropped so, the first; 0: none
size_t lac_rows_merge(size_t *n, lac_row *rows, size_t *conflicts);

/// Asks about a column whose unit nobody named: its name may end in one, as "disp_mm",
/// "rate (cm per day)" and "hour" do.
/// @param where  file, or file and line, for the message
/// @param si     the unit that would be taken
/// @param known  whether the name says that it is that one
/// @return LAC_OK; LAC_EINPUT where it says another
lac_status lac_series_ask(const struct lac_units *units, const char *where, const char *name,
                          const char *si, bool *known, lac_error *err);

/// Notes a doubt about what was read.
void lac_series_doubt(lac_series *series, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Lines of a text, one at a time; any of LF, CRLF and CR ends one.
typedef struct lac_lines {
    FILE *stream;
    const char *path;
    char *text; ///< the line, without its end; owned
    size_t length, capacity;
    size_t number; ///< 1-based
} lac_lines;

/// Reads the next line.
/// @param more  false at the end of the text
/// @return LAC_OK; LAC_EINPUT where the bytes are not text; LAC_EIO; LAC_ENOMEM
lac_status lac_lines_next(lac_lines *lines, bool *more, lac_error *err);

/// Text without blanks at its ends; in place.
char *lac_text_trim(char *text);

/// What separates the fields of a header: the most frequent of ; , and tab outside quotes.
char lac_text_separator(const char *header);

/// Takes the next field off a line, in place: quotes removed, blanks trimmed.
/// @param rest       what is left of the line; NULL after the last field
/// @param separator  between fields
/// @return the field; NULL where a quoted one does not end
char *lac_text_field(char **rest, char separator);

/// Whether a field stands for no value: empty, NA, N/A, #N/A, NaN, null, none, -, --.
bool lac_text_missing(const char *field);

/// A number as it may be written in a file: decimal, whole field.
/// @param mark  '.' or ',': the decimal mark
/// @pre   the thread's locale is "C"
/// @return false where it is not one, or not finite
bool lac_text_number(const char *field, char mark, double *value);

/// Decimal exponent of the last digit of what lac_text_number takes: -2 of "1,70", 2 of "3e2".
int lac_text_digit(const char *field, char mark);

/// A field fit for a message: cut, and without control characters.
const char *lac_text_show(const char *field, char *shown, size_t size);

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
