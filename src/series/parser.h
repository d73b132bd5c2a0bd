/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// What is known of a text file of readings while it is read: header (header.c), rows (read.c), and
// what its numbers look like (suspect.c).

#include <locale.h>

#include "series/text.h"

enum {
    VALUES = LAC_SERIES_VALUES,
    CLOCK = 1 + VALUES, ///< the time of day, where dates have a column of their own
    COLUMNS,
    OTHER = 3, ///< any other value: of what it is the unit, its reader knows
    SIGMA = 4,
    COMPONENT = 5, ///< the first
    SHOWN = 48,
    LONGEST_NAME = 64, ///< of a unit
};

/// Of time, displacement, velocity, any other value, the error of a displacement, its components,
/// error and bound of a velocity, how far a time may be off, the time of day.
typedef struct lac_wanted {
    const char *name;  ///< NULL: not asked for
    const char *unit;  ///< that was named; NULL: none
    const char *si;    ///< unit of what is kept
    const char *taken; ///< the SI unit, for want of another; NULL: one was named
    size_t index;      ///< in the header
    double scale, offset;
    size_t doubtful_line;  ///< of what is doubtful; 0: nothing
    int digit;             ///< smallest exponent of a last digit
    char bracket[SHOWN];   ///< what stands in brackets in the header's name; "": nothing
    char doubtful[SHOWN];  ///< the first number that may have a mark of thousands: 1.234
    bool whole3, decimals; ///< has numbers such as 998, and such as 1.5 or 0.234
} lac_wanted;

typedef struct lac_parser {
    lac_lines lines;
    lac_wanted wanted[COLUMNS];
    lac_components components;
    size_t skip;
    size_t header_line,
        first_line; ///< numbers of the header, and of the first line that might be it
    bool header_latin;
    char *header, **column; ///< the names that it has; owned
    char separator;
    size_t fields; ///< of the header
    char first_name[SHOWN];
    char dated_name[SHOWN]; ///< a column that has a date in the first row, and is not the time; ""
    char mark;              ///< decimal mark: '.', ',' or 0 while none has been seen
    lac_time_format format;
    bool time_named, time_known, dated, zoned;
    size_t unit_line;                 ///< of the last row of units; 0: none
    size_t headers_again, again_line; ///< rows that repeat the header, and the first one's line
    const struct lac_units *units;
    locale_t plain, callers; ///< the "C" locale, and the one of the thread before
    lac_row *readings;
    size_t count, capacity, missing;
    char *attribution;
    size_t attribution_length;
} lac_parser;

/// @return LAC_EINPUT, with file, line, column, value and what is allowed
lac_status lac_parser_fail(const lac_parser *p, lac_error *err, const char *column,
                           const char *value, const char *allowed);

/// Finds the header and its columns: the line after those skipped, or else the first that names all
/// that was asked for.
lac_status lac_parser_header(lac_parser *p, lac_error *err);

/// Looks for the header in the line that was read, after one has been found, and takes it.
/// @param found  whether the line names all that was asked for
lac_status lac_parser_again(lac_parser *p, bool *found, lac_error *err);

/// Takes a unit that the file states for a column: in brackets of its name, or in a row of units.
/// @param strict  whether text that is no such unit is refused where no other was named
lac_status lac_parser_unit(lac_parser *p, size_t column, const char *text, bool strict,
                           lac_error *err);

/// Whether text that stands where a unit may is one, of any kind: no label such as (N), (P1),
/// (min).
bool lac_parser_is_unit(const lac_parser *p, const char *text);

/// Notes what a number may mean besides what it was taken for.
void lac_parser_suspect(lac_parser *p, size_t column, const char *field, char mark);

/// Refuses a value that no slope has: a length or speed beyond LAC_SERIES_MOST.
lac_status lac_parser_check_size(const lac_parser *p, size_t column, const char *field,
                                 double value, lac_error *err);

/// Says of which columns every reading is missing.
lac_status lac_parser_fail_empty(const lac_parser *p, lac_error *err);

/// Refuses what its numbers do not seem to be: thousands as decimals, and as seconds days of Excel,
/// years, dates written in digits, numbers of rows.
/// @pre  rows are sorted
lac_status lac_parser_check(const lac_parser *p, lac_error *err);
