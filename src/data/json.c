// SPDX-License-Identifier: GPL-3.0-or-later
// JSON written piece by piece: numbers read back to the same value, texts are always valid UTF-8.
#include "data/json.h"

#include <stdarg.h>

#include "base/hidden.h"
#include "base/units.h"

// Text goes through here.
static void put(lac_json *json, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(lac_json *json, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    json->broken = vfprintf(json->out, format, args) < 0 || json->broken;
    va_end(args);
}

// By its number, in two halves where it is beyond 16 bits.
static void write_escaped(lac_json *json, uint32_t code)
{
    if (code > 0xffff) {
        put(json, "\\u%04x", 0xd7c0u + (code >> 10));
        code = 0xdc00u + (code & 0x3ffu);
    }
    put(json, "\\u%04x", code);
}

// In a page a '<' is escaped too, and hidden characters are '?'. @return bytes of it
static size_t write_character(lac_json *json, const unsigned char *s)
{
    uint32_t code;
    const size_t length = lac_utf8_length(s, &code);
    const bool hidden = lac_hidden_length((const char *)s, length) > 0;
    const bool quote = *s == '"' || *s == '\\';
    if (length == 0) {
        put(json, "\\ufffd");
    } else if (hidden && json->page) {
        put(json, "?");
    } else if (quote && !json->page) {
        put(json, "\\%c", *s);
    } else if (*s == '\n' && !json->page) {
        put(json, "\\n");
    } else if (*s < 0x20 || *s == 0x7f || hidden || quote || (*s == '<' && json->page)) {
        write_escaped(json, code);
    } else {
        json->broken = fwrite(s, 1, length, json->out) != length || json->broken;
    }
    return length > 0 ? length : 1;
}

static void write_string(lac_json *json, const char *text)
{
    put(json, "\"");
    for (const unsigned char *s = (const unsigned char *)text; *s != '\0';) {
        s += write_character(json, s);
    }
    put(json, "\"");
}

static void start_line(lac_json *json)
{
    if (!json->page && !json->line) {
        put(json, "\n%*s", 2 * json->depth, "");
    }
}

static void start_value(lac_json *json, const char *key)
{
    if (json->depth > 0) {
        put(json, "%s%s", json->filled ? "," : "", json->filled && json->line ? " " : "");
        start_line(json);
    }
    if (key != NULL) {
        write_string(json, key);
        put(json, json->page ? ":" : ": ");
    }
    json->filled = true;
}

void lac_json_open(lac_json *json, const char *key, char bracket)
{
    start_value(json, key);
    put(json, "%c", bracket);
    json->depth++;
    json->filled = false;
}

void lac_json_close(lac_json *json, char bracket)
{
    json->depth--;
    if (json->filled) {
        start_line(json);
    }
    put(json, "%c", bracket);
    if (json->depth == 0 && !json->page) {
        put(json, "\n");
    }
    json->filled = true;
}

void lac_json_number(lac_json *json, const char *key, double value)
{
    start_value(json, key);
    char text[40] = "null";
    if (isfinite(value) && value == rint(value) && fabs(value) < 0x1p53) {
        put(json, "%.0f", value); // 80, not 8e+01
    } else {
        put(json, "%s", isfinite(value) ? lac_number_exact(value, 1, text, sizeof text) : text);
    }
}

void lac_json_digits(lac_json *json, const char *key, double value, int digits)
{
    if (!isfinite(value)) {
        lac_json_null(json, key);
        return;
    }
    start_value(json, key);
    put(json, "%.*g", digits, value);
}

void lac_json_integer(lac_json *json, const char *key, int64_t value)
{
    start_value(json, key);
    put(json, "%" PRId64, value);
}

void lac_json_boolean(lac_json *json, const char *key, bool value)
{
    start_value(json, key);
    put(json, "%s", value ? "true" : "false");
}

void lac_json_null(lac_json *json, const char *key)
{
    start_value(json, key);
    put(json, "null");
}

void lac_json_text(lac_json *json, const char *key, const char *text)
{
    if (text == NULL) {
        lac_json_null(json, key);
        return;
    }
    start_value(json, key);
    write_string(json, text);
}

void lac_json_bytes(lac_json *json, const char *key, const uint8_t *bytes, size_t n)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    start_value(json, key);
    put(json, "\"");
    for (size_t i = 0; i < n; i += 3) {
        const size_t left = n - i;
        const uint32_t word = (uint32_t)bytes[i] << 16 |
                              (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                              (left > 2 ? bytes[i + 2] : 0);
        put(json, "%c%c%c%c", letters[word >> 18], letters[word >> 12 & 63],
            left > 1 ? letters[word >> 6 & 63] : '=', left > 2 ? letters[word & 63] : '=');
    }
    put(json, "\"");
}

void lac_json_texts(lac_json *json, const char *const *pair)
{
    lac_json_open(json, NULL, '{');
    for (; pair[0] != NULL; pair += 2) {
        lac_json_text(json, pair[0], pair[1]);
    }
    lac_json_close(json, '}');
}
