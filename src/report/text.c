// SPDX-License-Identifier: GPL-3.0-or-later
// JSON that grows in memory; no text in it can end the script of the page that it stands in.
#include "report/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hidden.h"

enum { FIRST_ROOM = 1 << 16 };

void lac_page_text_clear(lac_page_text *text)
{
    free(text->at);
    *text = (lac_page_text){0};
}

static bool make_room(lac_page_text *text, size_t more)
{
    size_t room = text->room > 0 ? text->room : FIRST_ROOM;
    while (!text->broken && room - text->length <= more) {
        if (room > SIZE_MAX / 2) {
            text->broken = true;
        }
        room *= 2;
    }
    if (!text->broken && room != text->room) {
        char *grown = realloc(text->at, room);
        text->broken = grown == NULL;
        text->at = grown != NULL ? grown : text->at;
        text->room = grown != NULL ? room : text->room;
    }
    return !text->broken;
}

void lac_page_raw(lac_page_text *text, const char *bytes, size_t length)
{
    if (make_room(text, length)) {
        memcpy(text->at + text->length, bytes, length);
        text->length += length;
        text->at[text->length] = '\0';
    }
}

void lac_page_puts(lac_page_text *text, const char *string)
{
    lac_page_raw(text, string, strlen(string));
}

// The comma before a member, and its key.
static void begin(lac_page_text *text, const char *key)
{
    if (text->comma) {
        lac_page_puts(text, ",");
    }
    text->comma = true;
    if (key != NULL) {
        lac_page_puts(text, "\"");
        lac_page_puts(text, key);
        lac_page_puts(text, "\":");
    }
}

void lac_page_open(lac_page_text *text, const char *key, char bracket)
{
    begin(text, key);
    lac_page_raw(text, &bracket, 1);
    text->comma = false;
}

void lac_page_close(lac_page_text *text, char bracket)
{
    lac_page_raw(text, &bracket, 1);
    text->comma = true;
}

// '<' is escaped so that no text can end the script that it stands in; hidden characters are '?'.
void lac_page_string(lac_page_text *text, const char *key, const char *value)
{
    begin(text, key);
    if (value == NULL) {
        lac_page_puts(text, "null");
        return;
    }
    lac_page_puts(text, "\"");
    const char *end = value + strlen(value);
    for (const char *c = value; c < end; c++) {
        char escaped[8];
        const size_t hidden = lac_hidden_length(c, (size_t)(end - c));
        if (hidden > 0) {
            lac_page_puts(text, "?");
            c += hidden - 1;
        } else if ((unsigned char)*c < 0x20 || *c == '"' || *c == '\\' || *c == '<' ||
                   *c == '\x7f') {
            (void)snprintf(escaped, sizeof escaped, "\\u%04x", (unsigned)(unsigned char)*c);
            lac_page_puts(text, escaped);
        } else {
            lac_page_raw(text, c, 1);
        }
    }
    lac_page_puts(text, "\"");
}

static void put_number(lac_page_text *text, double value, int digits)
{
    char number[40];
    if (isfinite(value)) {
        int length = snprintf(number, sizeof number, "%.*g", digits, value);
        lac_page_raw(text, number, (size_t)length);
    } else {
        lac_page_puts(text, "null");
    }
}

void lac_page_number(lac_page_text *text, const char *key, double value, int digits)
{
    begin(text, key);
    put_number(text, value, digits);
}

void lac_page_bool(lac_page_text *text, const char *key, bool value)
{
    begin(text, key);
    lac_page_puts(text, value ? "true" : "false");
}

void lac_page_column(lac_page_text *text, const char *key, size_t n, const double *value,
                     const uint8_t *keep, int digits)
{
    lac_page_open(text, key, '[');
    for (size_t i = 0; i < n; i++) {
        if (keep == NULL || keep[i]) {
            lac_page_number(text, NULL, value[i], digits);
        }
    }
    lac_page_close(text, ']');
}

void lac_page_bytes(lac_page_text *text, const char *key, const uint8_t *bytes, size_t n)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    begin(text, key);
    lac_page_puts(text, "\"");
    for (size_t i = 0; i < n; i += 3) {
        size_t left = n - i;
        uint32_t word = (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                        (left > 2 ? bytes[i + 2] : 0);
        const char four[4] = {letters[word >> 18], letters[word >> 12 & 63],
                              left > 1 ? letters[word >> 6 & 63] : '=',
                              left > 2 ? letters[word & 63] : '='};
        lac_page_raw(text, four, sizeof four);
    }
    lac_page_puts(text, "\"");
}
