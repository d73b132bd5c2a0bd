/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_REPORT_TEXT_H
#define LACUNA_REPORT_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A text that grows: the page's data as JSON. Memory that runs out is remembered, and told once
/// at the end.
typedef struct lac_page_text {
    char *at; ///< owned; ends in '\0'; NULL while empty
    size_t length, room;
    bool broken; ///< memory ran out
    bool comma;  ///< something stands before on this level
} lac_page_text;

void lac_page_text_clear(lac_page_text *text);

/// Adds bytes as they are.
void lac_page_raw(lac_page_text *text, const char *bytes, size_t length);
void lac_page_puts(lac_page_text *text, const char *string);

/// Opens or closes an object ('{') or a list ('['). A member of a list has the key NULL.
void lac_page_open(lac_page_text *text, const char *key, char bracket);
void lac_page_close(lac_page_text *text, char bracket);

/// Members. A string is escaped so that it may stand in a script of a page; NULL is null, and so
/// is a number that is not finite.
void lac_page_string(lac_page_text *text, const char *key, const char *value);
void lac_page_number(lac_page_text *text, const char *key, double value, int digits);
void lac_page_bool(lac_page_text *text, const char *key, bool value);

/// The numbers of a column at the records that are kept.
/// @param keep  [n] NULL: all
void lac_page_column(lac_page_text *text, const char *key, size_t n, const double *value,
                     const uint8_t *keep, int digits);

/// Bytes in base 64.
void lac_page_bytes(lac_page_text *text, const char *key, const uint8_t *bytes, size_t n);

#endif
