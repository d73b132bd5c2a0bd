/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_JSON_H
#define LACUNA_CLI_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/// Writes one JSON value piece by piece. Keys are NULL at the top and within lists.
typedef struct cli_json {
    FILE *out;
    int depth;
    bool filled; ///< something stands before on this level
} cli_json;

/// Opens an object ('{') or a list ('[').
void cli_json_open(cli_json *json, const char *key, char bracket);

/// Closes it ('}' or ']'); the outermost one ends the line.
void cli_json_close(cli_json *json, char bracket);

/// The shortest digits that read back to the same double, a whole number below 2^53 without an
/// exponent; null where not finite.
void cli_json_number(cli_json *json, const char *key, double value);
void cli_json_integer(cli_json *json, const char *key, int64_t value);
void cli_json_boolean(cli_json *json, const char *key, bool value);
void cli_json_null(cli_json *json, const char *key);

/// Length of the UTF-8 sequence at `s`, 0 where it is none (overlong forms, surrogates included).
size_t cli_utf8_length(const unsigned char *s);

/// Text in quotes, escaped; bytes that are no UTF-8 become U+FFFD; null where NULL.
void cli_json_text(cli_json *json, const char *key, const char *text);

#endif
