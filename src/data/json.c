// SPDX-License-Identifier: GPL-3.0-or-later
// JSON written piece by piece: numbers read back to the same value, texts are always valid UTF-8.
#include "data/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "base/hidden.h"
#include "base/units.h"

size_t lac_utf8_length(const unsigned char *s)
{
    static const struct {
        unsigned char first, last, low, high; // first byte; range of the second
        size_t length;
    } forms[] = {
        {0x00, 0x7f, 0, 0, 1},       {0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
        {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3}, {0xee, 0xef, 0x80, 0xbf, 3},
        {0xf0, 0xf0, 0x90, 0xbf, 4}, {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4},
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        if (s[0] < forms[i].first || s[0] > forms[i].last) {
            continue;
        }
        size_t length = forms[i].length;
        if (length > 1 && (s[1] < forms[i].low || s[1] > forms[i].high)) {
            return 0;
        }
        for (size_t k = 2; k < length; k++) {
            if ((s[k] & 0xc0) != 0x80) {
                return 0;
            }
        }
        return length;
    }
    return 0;
}

// Text goes through here: what cannot be written shows up when the stream is flushed.
static void put(FILE *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(FILE *out, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vfprintf(out, format, args);
    va_end(args);
}

// By its number, in two halves where it is beyond 16 bits.
static void write_escaped(FILE *out, const unsigned char *s, size_t length)
{
    unsigned c = length == 1 ? *s : *s & (0xffu >> (length + 1));
    for (size_t i = 1; i < length; i++) {
        c = (c << 6) | (s[i] & 0x3fu);
    }
    if (c > 0xffff) {
        put(out, "\\u%04x", 0xd7c0u + (c >> 10));
        c = 0xdc00u + (c & 0x3ffu);
    }
    put(out, "\\u%04x", c);
}

static void write_character(FILE *out, const unsigned char *s, size_t length)
{
    if (length == 0) {
        put(out, "\\ufffd");
    } else if (*s == '"' || *s == '\\') {
        put(out, "\\%c", *s);
    } else if (*s == '\n') {
        put(out, "\\n");
    } else if (*s < 0x20 || *s == 0x7f || lac_hidden_length((const char *)s, length) > 0) {
        write_escaped(out, s, length);
    } else {
        (void)fwrite(s, 1, length, out);
    }
}

static void write_string(FILE *out, const char *text)
{
    put(out, "\"");
    for (const unsigned char *s = (const unsigned char *)text; *s != '\0';) {
        size_t length = lac_utf8_length(s);
        write_character(out, s, length);
        s += length > 0 ? length : 1;
    }
    put(out, "\"");
}

static void start_value(lac_json *json, const char *key)
{
    if (json->depth > 0) {
        put(json->out, "%s\n%*s", json->filled ? "," : "", 2 * json->depth, "");
    }
    if (key != NULL) {
        write_string(json->out, key);
        put(json->out, ": ");
    }
    json->filled = true;
}

void lac_json_open(lac_json *json, const char *key, char bracket)
{
    start_value(json, key);
    put(json->out, "%c", bracket);
    json->depth++;
    json->filled = false;
}

void lac_json_close(lac_json *json, char bracket)
{
    json->depth--;
    if (json->filled) {
        put(json->out, "\n%*s", 2 * json->depth, "");
    }
    put(json->out, "%c", bracket);
    if (json->depth == 0) {
        put(json->out, "\n");
    }
    json->filled = true;
}

void lac_json_number(lac_json *json, const char *key, double value)
{
    start_value(json, key);
    if (!isfinite(value)) {
        put(json->out, "null");
        return;
    }
    if (value == rint(value) && fabs(value) < 0x1p53) {
        put(json->out, "%.0f", value); // 80, not 8e+01
        return;
    }
    char text[40];
    put(json->out, "%s", lac_number_exact(value, 1, text, sizeof text));
}

void lac_json_integer(lac_json *json, const char *key, int64_t value)
{
    start_value(json, key);
    put(json->out, "%" PRId64, value);
}

void lac_json_boolean(lac_json *json, const char *key, bool value)
{
    start_value(json, key);
    put(json->out, "%s", value ? "true" : "false");
}

void lac_json_null(lac_json *json, const char *key)
{
    start_value(json, key);
    put(json->out, "null");
}

void lac_json_text(lac_json *json, const char *key, const char *text)
{
    if (text == NULL) {
        lac_json_null(json, key);
        return;
    }
    start_value(json, key);
    write_string(json->out, text);
}

void lac_json_texts(lac_json *json, const char *const *pair)
{
    lac_json_open(json, NULL, '{');
    for (; pair[0] != NULL; pair += 2) {
        lac_json_text(json, pair[0], pair[1]);
    }
    lac_json_close(json, '}');
}
