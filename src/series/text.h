/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"
#include "series/series.h"

/// Reads as lac_series_read from a stream (the fuzzer's way in); def->path names it in messages.
lac_status lac_series_read_stream(FILE *stream, const lac_series_def *def,
                                  const struct lac_units *units, lac_series **out, lac_error *err);

enum { LAC_SERIES_AXES = 3 };

/// Columns of the components of a displacement: two or three, and what they are projected on.
typedef struct lac_components {
    size_t count;                      ///< 0: none was asked for
    const char *name[LAC_SERIES_AXES]; ///< NULL beyond count
    const char *unit[LAC_SERIES_AXES]; ///< NULL: not named
    bool sighted;                      ///< on the line of sight; else on the main direction
    double direction[LAC_SERIES_AXES]; ///< of it, of length 1
    char *owned;
} lac_components;

/// Understands def->components and def->line_of_sight.
/// @param out  owned->owned is to be freed in any case
/// @return LAC_OK; LAC_EINPUT; LAC_ENOMEM
lac_status lac_components_read(const lac_series_def *def, lac_components *out, lac_error *err);

/// One with room for n readings of the columns asked for, in one piece.
lac_status lac_series_new(const lac_series_def *def, const lac_components *components, size_t n,
                          const char *attribution, lac_series **out, lac_error *err);

/// Whether a file begins as netCDF does; the stream is at its beginning before and after.
bool lac_series_is_netcdf(FILE *stream);

/// Reads as lac_series_read from a netCDF file; *out is to be freed in any case.
lac_status lac_series_read_netcdf(const lac_series_def *def, const struct lac_units *units,
                                  lac_series **out, lac_error *err);

/// Displacement, velocity, any other, error of a displacement; its components; error and upper
/// bound of a velocity, how far a time may be off.
enum { LAC_SERIES_VALUES = 7 + LAC_SERIES_AXES };

/// A row of a file: time, values (NaN: not given), line.
typedef struct lac_row {
    double time, value[LAC_SERIES_VALUES];
    double digit[2]; ///< what the last digit of displacement and velocity counts, in SI
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

/// A column of numbers as the file has them: (x - offset) / scale.
typedef struct lac_column {
    size_t n;
    const double *first;
    size_t stride; ///< from one to the next [bytes]
    double scale, offset;
} lac_column;

static inline double lac_column_at(const lac_column *c, size_t i)
{
    const double *x = (const void *)((const char *)c->first + i * c->stride);
    return (*x - c->offset) / c->scale;
}

/// Looks for a number made of nines (-9999, 999.9) that stands more than once in a column and
/// further from all others than these are from one another: a logger's word for "no value".
/// @return its first place; n: there is none
size_t lac_series_find_code(const lac_column *column, double *code, size_t *count);

/// Further than any slope moves [m], faster [m/s]: numbers beyond are marks, or of another unit.
#define LAC_SERIES_MOST 1e9

/// How such a column is refused, behind the number: count and n.
#define LAC_CODE_IS                                                                           \
    "stands in %zu of %zu rows, far from all others: where it means that there is no value, " \
    "write NA or leave the field empty"

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
    bool latin;    ///< the line was no UTF-8, and was taken for Windows-1252
} lac_lines;

/// Reads the next line, made UTF-8 where it is not: then it is taken for Windows-1252, of which
/// Latin-1 is a part.
/// @param more  false at the end of the text
/// @return LAC_OK; LAC_EINPUT where the bytes are not text (a workbook, UTF-16 ...); LAC_EIO;
/// LAC_ENOMEM
lac_status lac_lines_next(lac_lines *lines, bool *more, lac_error *err);

/// A text in Windows-1252 as UTF-8; to be freed. NULL where memory is short.
char *lac_text_decode(const char *text);

/// Whether a text is UTF-8.
bool lac_text_is_utf8(const char *text);

/// Text without blanks at its ends; in place.
char *lac_text_trim(char *text);

/// What separates the fields of a header: the most frequent of ; , and tab outside quotes; blanks
/// where it has none of them.
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

/// Whether a field is a number with marks between its thousands: "1,234.5", "1 234,5".
/// @param plain  [size] the number without them
bool lac_text_thousands(const char *field, char *plain, size_t size);

/// A field fit for a message: cut, and without control characters.
const char *lac_text_show(const char *field, char *shown, size_t size);

/// How the times of a file are written.
typedef struct lac_time_format {
    const char *pattern;  ///< with % marks; NULL: numbers, or ISO 8601 and seconds
    bool any;             ///< ISO 8601 or seconds, whichever the first row has
    bool dated;           ///< of numbers: they count from a date
    bool decimal_year;    ///< of numbers: years, with the part that is over
    bool monthly;         ///< of patterns: no day, so the middle of the month
    double scale, offset; ///< of numbers: seconds = scale x + offset
    char unit[16];        ///< of numbers, "day"; "" where the name is longer
    char allowed[128];    ///< for messages: what a time must be
} lac_time_format;

/// Understands a format: NULL or "iso" (ISO 8601, else seconds), "unix", "excel" (days since
/// 1899-12-30), "decimal-year" (2015.4932), a pattern such as "%d/%m/%Y %H:%M" (Y m d y b j H I M S
/// p z), or what CF calls time units: "day", "hours since 2015-06-07".
/// @param text  borrowed
/// @return LAC_OK; LAC_EINPUT
lac_status lac_time_format_read(const char *text, const struct lac_units *units,
                                lac_time_format *out, lac_error *err);

enum { LAC_TIME_GUESS = 24 };

/// Patterns by which a field would be a date, the usual ones.
/// @return how many there are, at most `most`
size_t lac_time_format_guess(const char *field, size_t most, char guess[][LAC_TIME_GUESS]);

/// Reads one time.
/// @param mark     decimal mark of numbers
/// @param seconds  since 1970 UTC where dated, else as written
/// @param dated    whether it is a date
/// @return false where the field is no such time
bool lac_time_format_take(const lac_time_format *format, const char *field, char mark,
                          double *seconds, bool *dated);

/// Whether a date says its zone, so that it is not taken to be UTC for want of one.
bool lac_time_format_zoned(const lac_time_format *format, const char *field);
