/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "surface/read.h"

/// A place in a text; LF, CRLF and CR end a line.
typedef struct lac_scan {
    const char *path;
    const char *at, *end;
    size_t line;  ///< 1-based
    char decimal; ///< mark of decimals, '.' or ','
} lac_scan;

/// Part of a text.
typedef struct lac_word {
    const char *text;
    size_t length;
} lac_word;

/// The beginning of a text, beyond a byte order mark.
lac_scan lac_scan_begin(const lac_bytes *bytes);

/// Finds the mark of decimals in what is left of a text: a comma where a digit stands on either
/// side of one and no line but remarks (after one of `remarks`) has a point.
void lac_scan_decimal(lac_scan *scan, const char *remarks);

/// The next word of this line; false at its end.
bool lac_scan_word(lac_scan *scan, lac_word *word);

/// What is left of this line, without blanks at its ends.
lac_word lac_scan_rest(lac_scan *scan);

/// Goes to the next line; false at the end of the text.
bool lac_scan_line(lac_scan *scan);

/// Whether a word is this one, in any case.
bool lac_word_is(lac_word word, const char *text);

/// Copies a word, cut to fit and fit for a message.
const char *lac_word_show(lac_word word, char *shown, size_t size);

/// A finite number; NaN where the word is "nan", with or without a sign, or "NA".
/// @pre    the thread's locale is "C"
lac_status lac_scan_number(const lac_scan *scan, lac_word word, double *value, lac_error *err);

/// What a key of a header holds: one of the four is where its value goes.
typedef struct lac_field {
    const char *key;
    uint64_t *count; ///< a whole number of cells or points, at least 1
    double *length;  ///< finite, above zero
    double *number;
    char *unit; ///< [LAC_UNIT_SIZE]
} lac_field;

/// Reads the value of a key; LAC_EINPUT where it is none.
lac_status lac_scan_field(const lac_scan *scan, const lac_field *field, lac_word word,
                          lac_error *err);
