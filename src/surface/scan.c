// SPDX-License-Identifier: GPL-3.0-or-later
// Words and numbers of heights that are text, with decimal points or commas; errors name the line.
#include "surface/read.h"

#include <strings.h>

enum { NUMBER_MAX = 64, SHOWN = 40 };

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

static bool ends_line(char c) { return c == '\n' || c == '\r'; }

lac_scan lac_scan_begin(const lac_bytes *bytes)
{
    const char *text = (const char *)bytes->data;
    size_t mark = lac_bytes_begin(bytes, "\xef\xbb\xbf") ? 3 : 0;
    return (lac_scan){.path = bytes->path,
                      .at = text + mark,
                      .end = text + bytes->size,
                      .line = 1,
                      .decimal = '.'};
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

void lac_scan_decimal(lac_scan *scan, const char *remarks)
{
    lac_scan text = *scan;
    bool comma = false;
    do {
        lac_word line = lac_scan_rest(&text);
        if (line.length == 0 || strchr(remarks, line.text[0]) != NULL) {
            continue;
        }
        if (memchr(line.text, '.', line.length) != NULL) {
            return;
        }
        for (size_t i = 1; !comma && i + 1 < line.length; i++) {
            comma = line.text[i] == ',' && is_digit(line.text[i - 1]) && is_digit(line.text[i + 1]);
        }
    } while (lac_scan_line(&text));
    scan->decimal = comma ? ',' : '.';
}

bool lac_scan_word(lac_scan *scan, lac_word *word)
{
    while (scan->at < scan->end && is_blank(*scan->at)) {
        scan->at++;
    }
    *word = (lac_word){.text = scan->at};
    while (scan->at < scan->end && !is_blank(*scan->at) && !ends_line(*scan->at)) {
        scan->at++;
    }
    word->length = (size_t)(scan->at - word->text);
    return word->length > 0;
}

lac_word lac_scan_rest(lac_scan *scan)
{
    while (scan->at < scan->end && is_blank(*scan->at)) {
        scan->at++;
    }
    lac_word rest = {.text = scan->at};
    while (scan->at < scan->end && !ends_line(*scan->at)) {
        scan->at++;
    }
    rest.length = (size_t)(scan->at - rest.text);
    while (rest.length > 0 && is_blank(rest.text[rest.length - 1])) {
        rest.length--;
    }
    return rest;
}

bool lac_scan_line(lac_scan *scan)
{
    (void)lac_scan_rest(scan);
    if (scan->at == scan->end) {
        return false;
    }
    bool pair = *scan->at == '\r' && scan->end - scan->at > 1 && scan->at[1] == '\n';
    scan->at += pair ? 2 : 1;
    scan->line++;
    return true;
}

bool lac_word_is(lac_word word, const char *text)
{
    return strlen(text) == word.length && strncasecmp(word.text, text, word.length) == 0;
}

const char *lac_word_show(lac_word word, char *shown, size_t size)
{
    size_t used = 0;
    while (used < word.length && used + 4 < size) {
        char c = word.text[used];
        shown[used++] = c >= ' ' && c < 0x7f ? c : '?';
    }
    bool cut = used < word.length;
    memcpy(shown + used, cut ? "..." : "", cut ? 4 : 1);
    return shown;
}

static lac_status refuse(const lac_scan *scan, lac_word word, const char *why, lac_error *err)
{
    char shown[SHOWN];
    return lac_fail(err, LAC_EINPUT, "%s:%zu: \"%s\" %s", scan->path, scan->line,
                    lac_word_show(word, shown, sizeof shown), why);
}

static bool is_nan(lac_word word)
{
    if (word.length > 0 && (word.text[0] == '-' || word.text[0] == '+')) {
        word.text++;
        word.length--;
    }
    return lac_word_is(word, "nan") || lac_word_is(word, "na");
}

lac_status lac_scan_number(const lac_scan *scan, lac_word word, double *value, lac_error *err)
{
    char text[NUMBER_MAX];
    if (is_nan(word)) {
        *value = NAN;
        return LAC_OK;
    }
    if (scan->decimal != ',' && word.length > 0 && memchr(word.text, ',', word.length) != NULL) {
        return refuse(scan, word,
                      "has a comma; numbers must have a decimal point, as in 1.5, where any has",
                      err);
    }
    size_t length = word.length < sizeof text ? word.length : 0;
    for (size_t i = 0; i < length; i++) {
        // strtod would also take hexadecimal and infinity
        text[i] = word.text[i] == scan->decimal ? '.' : word.text[i];
        if (text[i] == '\0' || strchr("0123456789+-.eE", text[i]) == NULL) {
            length = 0;
        }
    }
    text[length] = '\0';
    char *end = text;
    *value = strtod(text, &end);
    if (end == text || *end != '\0') {
        return refuse(scan, word, "is not a number, such as 1.5 or 2e-6", err);
    }
    if (!isfinite(*value)) {
        return refuse(scan, word, "is too large; must be a finite number", err);
    }
    return LAC_OK;
}

lac_status lac_scan_field(const lac_scan *scan, const lac_field *field, lac_word word,
                          lac_error *err)
{
    double number = NAN;
    char shown[SHOWN];
    if (field->unit != NULL) {
        LAC_FAIL_IF(word.length >= LAC_UNIT_SIZE, err, LAC_EINPUT,
                    "%s:%zu: %s must be shorter than %d bytes", scan->path, scan->line, field->key,
                    LAC_UNIT_SIZE);
        (void)snprintf(field->unit, LAC_UNIT_SIZE, "%.*s", (int)word.length, word.text);
        return LAC_OK;
    }
    lac_status status = lac_scan_number(scan, word, &number, err);
    bool whole = number >= 1.0 && number <= 0x1p53 && number == floor(number);
    if (status == LAC_OK &&
        (field->count != NULL ? !whole : field->length != NULL && !(number > 0.0))) {
        status =
            lac_fail(err, LAC_EINPUT, "%s:%zu: %s must be a %s, not \"%s\"", scan->path, scan->line,
                     field->key, field->count != NULL ? "whole number >= 1" : "number > 0",
                     lac_word_show(word, shown, sizeof shown));
    }
    if (field->count != NULL) {
        *field->count = status == LAC_OK ? (uint64_t)number : 0;
    } else {
        *(field->length != NULL ? field->length : field->number) = number;
    }
    return status;
}
