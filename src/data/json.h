/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Writes one JSON value piece by piece. Keys are NULL at the top and within lists.
typedef struct lac_json {
    FILE *out;
    int depth;
    bool filled; ///< something stands before on this level
    bool line;   ///< in one line, which ends with the outermost value
    bool page;   ///< in one line, and so that no text in it can end the script it stands in
    bool broken; ///< something could not be written
} lac_json;

/// Opens an object ('{') or a list ('[').
void lac_json_open(lac_json *json, const char *key, char bracket);

/// Closes it ('}' or ']'); the outermost one ends the line.
void lac_json_close(lac_json *json, char bracket);

/// The shortest digits that read back to the same double, a whole number below 2^53 without an
/// exponent; null where not finite.
void lac_json_number(lac_json *json, const char *key, double value);
/// So many digits; null where not finite.
void lac_json_digits(lac_json *json, const char *key, double value, int digits);
void lac_json_integer(lac_json *json, const char *key, int64_t value);
void lac_json_boolean(lac_json *json, const char *key, bool value);
void lac_json_null(lac_json *json, const char *key);

/// Text in quotes, escaped; bytes that are no UTF-8 become U+FFFD; null where NULL.
void lac_json_text(lac_json *json, const char *key, const char *text);

/// An object of texts, in a list or at the top: keys and texts in turn, NULL at the end.
void lac_json_texts(lac_json *json, const char *const *pair);
#define LAC_JSON_TEXTS(json, ...) lac_json_texts(json, (const char *const[]){__VA_ARGS__, NULL})

/// Bytes in base 64.
void lac_json_bytes(lac_json *json, const char *key, const uint8_t *bytes, size_t n);
