/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "surface/surface.h"

/// A file in memory: every reader works on bytes at hand, never on what a header promises.
typedef struct lac_bytes {
    const char *path; ///< for messages
    const unsigned char *data;
    size_t size;
} lac_bytes;

/// One format: recognised by its content.
typedef struct lac_map_format {
    const char *name;
    bool (*is)(const lac_bytes *bytes);
    /// Fills a map that is zero but for spacings and a place of NaN.
    lac_status (*read)(const lac_bytes *bytes, lac_height_map *map, lac_error *err);
} lac_map_format;

extern const lac_map_format lac_map_npy, lac_map_asc, lac_map_xyz, lac_map_gsf, lac_map_sdf,
    lac_map_netcdf;

/// Reads as lac_height_map_read from memory (the fuzzer's way in).
lac_status lac_height_map_parse(const lac_bytes *bytes, lac_height_map **map, lac_error *err);

/// Gives a map its size, and room for its heights.
/// @param most  heights that the bytes at hand can hold
lac_status lac_map_size(lac_height_map *map, const char *path, uint64_t nx, uint64_t ny,
                        size_t most, lac_error *err);

/// Turns the rows of a map around, where a file begins with the largest y.
void lac_map_flip(lac_height_map *map);

/// How a number is stored.
typedef struct lac_number_type {
    size_t width; ///< bytes
    char kind;    ///< 'f', 'i' (signed) or 'u'
    bool big_endian;
} lac_number_type;

/// A stored number; `data` needs no alignment.
double lac_bytes_number(const unsigned char *data, lac_number_type type);

/// Gives a map its size and its heights, which are the rest of the file from byte `start` on.
/// @param fortran  columns follow each other, not rows
/// @param what     the numbers are called in messages
lac_status lac_map_fill(lac_height_map *map, const lac_bytes *bytes, const uint64_t size[2],
                        size_t start, lac_number_type type, bool fortran, const char *what,
                        lac_error *err);

/// Whether the content begins with a word.
bool lac_bytes_begin(const lac_bytes *bytes, const char *word);

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
