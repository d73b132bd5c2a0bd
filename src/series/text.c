// SPDX-License-Identifier: GPL-3.0-or-later
// Fields and numbers of text files, in the forms that loggers and spreadsheets write.
#include <stdarg.h>
#include <strings.h>

#include "base/hidden.h"
#include "base/units.h"
#include "series/text.h"

enum { NUMBER_MAX = 64 };
enum { POWER_MAX = 400 }; // beyond what a double holds

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f'; }

char *lac_text_trim(char *text)
{
    while (is_blank(*text)) {
        text++;
    }
    size_t length = strlen(text);
    while (length > 0 && is_blank(text[length - 1])) {
        length--;
    }
    text[length] = '\0';
    return text;
}

// A field in quotes, of which two stand for one; what follows up to the separator must be blank.
static char *quoted_field(char *at, char **rest, char separator)
{
    char *field = at + 1;
    char *to = field;
    for (at = field; *at != '\0'; at++) {
        if (*at == '"' && at[1] != '"') {
            break;
        }
        at += *at == '"';
        *to++ = *at;
    }
    if (*at != '"') {
        return NULL;
    }
    at++;
    while (is_blank(*at) && *at != separator) {
        at++;
    }
    if (*at != '\0' && *at != separator) {
        return NULL;
    }
    *rest = *at != '\0' ? at + 1 : NULL;
    *to = '\0';
    return lac_text_trim(field);
}

static size_t count_outside_quotes(const char *line, char wanted)
{
    size_t count = 0;
    bool quoted = false;
    for (; *line != '\0'; line++) {
        quoted = *line == '"' ? !quoted : quoted;
        count += !quoted && *line == wanted;
    }
    return count;
}

char lac_text_separator(const char *header)
{
    static const char choices[] = {';', ',', '\t'};
    char best = ',';
    size_t most = 0;
    for (size_t i = 0; i < sizeof choices; i++) {
        size_t count = count_outside_quotes(header, choices[i]);
        if (count > most) {
            most = count;
            best = choices[i];
        }
    }
    header += strspn(header, " ");
    return (char)(most == 0 && strchr(header, ' ') != NULL ? ' ' : best);
}

// Any number of blanks is one separator, and none stands at the ends.
static char *blank_field(char **rest)
{
    char *field = *rest + strspn(*rest, " \t\f");
    char *end = field + strcspn(field, " \t\f");
    char *next = end + strspn(end, " \t\f");
    *rest = *next != '\0' ? next : NULL;
    *end = '\0';
    return field;
}

char *lac_text_field(char **rest, char separator)
{
    char *field = *rest;
    while (is_blank(*field) && *field != separator) {
        field++;
    }
    if (*field == '"') {
        return quoted_field(field, rest, separator);
    }
    if (separator == ' ') {
        return blank_field(rest);
    }
    char *end = strchr(field, separator);
    *rest = end != NULL ? end + 1 : NULL;
    if (end != NULL) {
        *end = '\0';
    }
    return lac_text_trim(field);
}

bool lac_text_missing(const char *field)
{
    static const char *const marks[] = {"NA", "N/A", "#N/A", "NaN", "null", "none"};
    bool missing = field[strspn(field, "-")] == '\0'; // nothing, or dashes
    for (size_t i = 0; i < sizeof marks / sizeof marks[0]; i++) {
        missing = missing || strcasecmp(field, marks[i]) == 0;
    }
    return missing;
}

bool lac_text_number(const char *field, char mark, double *value)
{
    char text[NUMBER_MAX];
    size_t length = strlen(field);
    if (length == 0 || length >= sizeof text) {
        return false;
    }
    for (size_t i = 0; i <= length; i++) {
        char c = field[i];
        // strtod would also take hexadecimal, inf and nan.
        if (c != '\0' && strchr("0123456789+-eE", c) == NULL && c != mark) {
            return false;
        }
        text[i] = (char)(c == mark && c != '\0' ? '.' : c);
    }
    char *end = NULL;
    *value = strtod(text, &end);
    return *end == '\0' && end != text && isfinite(*value);
}

int lac_text_digit(const char *field, char mark)
{
    const char *at = strchr(field, mark);
    const char *power = strpbrk(field, "eE");
    const int decimals = at != NULL ? (int)strspn(at + 1, "0123456789") : 0;
    const long ten = power != NULL ? strtol(power + 1, NULL, 10) : 0;
    const long clamped = ten < -POWER_MAX ? -POWER_MAX : ten > POWER_MAX ? POWER_MAX : ten;
    return (int)clamped - decimals;
}

// The marks that stand between thousands: blanks of three widths, points, commas, apostrophes.
static size_t take_group_mark(const char *at, const char **mark)
{
    static const char *const marks[] = {" ", "\xc2\xa0", "\xe2\x80\xaf", "\xe2\x80\x89", ".",
                                        ",", "'",        "\xe2\x80\x99"};
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) {
        if (strncmp(at, marks[i], strlen(marks[i])) == 0) {
            *mark = marks[i];
            return strlen(marks[i]);
        }
    }
    return 0;
}

// Digits, of which three stand behind each mark, then other decimals.
bool lac_text_thousands(const char *field, char *plain, size_t size)
{
    const char *at = field, *mark = NULL, *other = NULL;
    size_t used = 0, groups = 0, digits = 0, length = 0;
    used += *at == '-' || *at == '+' ? 1 : 0;
    memcpy(plain, at, used);
    at += used;
    for (;;) {
        digits = strspn(at, "0123456789");
        if (digits == 0 || used + digits + 2 > size || (groups > 0 && digits != 3) || digits > 3) {
            return false;
        }
        memcpy(plain + used, at, digits);
        used += digits;
        at += digits;
        length = take_group_mark(at, &other);
        if (length == 0 || (mark != NULL && mark != other)) {
            break;
        }
        mark = other;
        at += length;
        groups++;
    }
    const bool decimals = length == 1 && (*at == '.' || *at == ',');
    digits = decimals ? strspn(at + 1, "0123456789") + 1 : 0;
    if (groups == 0 || at[digits] != '\0' || used + digits + 1 > size) {
        return false;
    }
    memcpy(plain + used, at, digits + 1);
    return true;
}

const char *lac_text_show(const char *field, char *shown, size_t size)
{
    size_t used = 0;
    uint32_t code;
    while (*field != '\0' && used + 8 < size) {
        size_t length = lac_utf8_length((const unsigned char *)field, &code);
        if (length == 0 || (unsigned char)*field < ' ') {
            shown[used++] = '?';
            field++;
            continue;
        }
        memcpy(shown + used, field, length);
        used += length;
        field += length;
    }
    memcpy(shown + used, *field != '\0' ? "..." : "", *field != '\0' ? 4 : 1);
    return shown;
}

// The rows of a file in the order of time, each time once.

static int compare(const void *left, const void *right)
{
    const lac_row *a = left, *b = right;
    if (a->time != b->time) {
        return a->time < b->time ? -1 : 1;
    }
    return a->line < b->line ? -1 : a->line > b->line;
}

size_t lac_rows_sort(size_t n, lac_row *rows)
{
    size_t disordered = 0;
    for (size_t i = 1; i < n; i++) {
        disordered += rows[i].time < rows[i - 1].time ? 1 : 0;
    }
    if (disordered > 0) {
        qsort(rows, n, sizeof *rows, compare);
    }
    return disordered;
}

// Whether a value of the later row is another one.
static bool merge(lac_row *first, const lac_row *later)
{
    bool differs = false;
    for (size_t c = 0; c < LAC_SERIES_VALUES; c++) {
        if (isnan(first->value[c])) {
            first->value[c] = later->value[c];
            if (c < 2) {
                first->digit[c] = later->digit[c];
            }
        }
        differs = differs || (!isnan(later->value[c]) && later->value[c] != first->value[c]);
    }
    return differs;
}

size_t lac_rows_merge(size_t *n, lac_row *rows, size_t *conflicts)
{
    size_t kept = 0, line = 0;
    *conflicts = 0;
    for (size_t i = 1; i < *n; i++) {
        if (rows[i].time != rows[kept].time) {
            rows[++kept] = rows[i];
        } else if (merge(&rows[kept], &rows[i])) {
            line = line == 0 || rows[i].line < line ? rows[i].line : line;
            (*conflicts)++;
        }
    }
    *n = kept + 1;
    return line;
}

// A column that is not what it seems is asked about.

enum { LONGEST_NAME = 64 };

void lac_series_doubt(lac_series *series, const char *format, ...)
{
    va_list args;
    if (series->doubts == LAC_SERIES_DOUBTS) {
        return;
    }
    va_start(args, format);
    (void)vsnprintf(series->doubt[series->doubts++], LAC_SERIES_DOUBT_TEXT, format, args);
    va_end(args);
}

// The end of a name as UDUNITS writes a unit: without brackets, blanks for underscores.
static void plain(const char *end, char *unit, size_t size)
{
    size_t n = 0;
    for (; *end != '\0' && n + 1 < size; end++) {
        if (strchr("()[]", *end) == NULL) {
            unit[n++] = (char)(*end == '_' ? ' ' : *end);
        }
    }
    unit[n] = '\0';
}

static bool is_month(const char *unit)
{
    return strcmp(unit, "month") == 0 || strcmp(unit, "months") == 0;
}

// The longest end of a name that is a unit of the dimension of `si`, or "month"; "" where none is.
static void find_unit(const struct lac_units *units, const char *name, const char *si, char *unit,
                      bool *same)
{
    double scale, offset;
    for (const char *at = name; strlen(name) < LONGEST_NAME && *at != '\0'; at++) {
        if (at > name && strchr("_ ([", at[-1]) == NULL) {
            continue;
        }
        plain(at, unit, LONGEST_NAME);
        if (strcmp(si, "s") == 0 && is_month(unit)) {
            *same = false;
            return;
        }
        if (lac_units_convert(units, unit, si, &scale, &offset, NULL) == LAC_OK) {
            *same = scale == 1.0 && offset == 0.0;
            return;
        }
    }
    *same = false;
    unit[0] = '\0';
}

lac_status lac_series_ask(const struct lac_units *units, const char *where, const char *name,
                          const char *si, bool *known, lac_error *err)
{
    char unit[LONGEST_NAME] = "";
    find_unit(units, name, si, unit, known);
    if (unit[0] == '\0' || *known) {
        return LAC_OK;
    }
    LAC_FAIL_IF(strcmp(si, "s") != 0, err, LAC_EINPUT,
                "%s: %s: has no unit, and its name says %s: which is it, \"%s:%s\" or \"%s:%s\"?",
                where, name, unit, name, unit, name, si);
    return lac_fail(
        err, LAC_EINPUT,
        "%s: %s: has bare numbers, and its name says %s: which time format is it, %s or s?", where,
        name, unit, is_month(unit) ? "dates (a month has no fixed length)" : unit);
}
