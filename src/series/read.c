// SPDX-License-Identifier: GPL-3.0-or-later
// A monitoring file: comments, a header, rows; then sorted, with repeated times taken once.
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "series/text.h"

enum {
    VALUES = LAC_SERIES_VALUES,
    COLUMNS = 1 + VALUES,
    SIGMA = 4,
    SHOWN = 48,
    ATTRIBUTION_MAX = 1 << 16,
    BELIEVED = 10, ///< of so many rows one may repeat a time with another value; one always
};

// Of time, displacement, velocity, any other value, and the error of a displacement: 0 ... 4.
typedef struct lac_wanted {
    const char *name;  ///< NULL: not asked for
    const char *taken; ///< the SI unit, for want of another; NULL: one was named
    size_t index;      ///< in the header
    double scale, offset;
    int digit; ///< smallest exponent of a last digit
} lac_wanted;

typedef struct lac_parser {
    lac_lines lines;
    lac_wanted wanted[COLUMNS];
    char separator;
    size_t fields; ///< of the header
    char first_name[SHOWN];
    char mark; ///< decimal mark: '.', ',' or 0 while none has been seen
    lac_time_format format;
    bool time_known, dated;
    const struct lac_units *units;
    locale_t plain, callers; ///< the "C" locale, and the one of the thread before
    lac_row *readings;
    size_t count, capacity, missing, disordered;
    char *attribution;
    size_t attribution_length;
} lac_parser;

static lac_status fail_at(const lac_parser *p, lac_error *err, const char *column,
                          const char *value, const char *allowed)
{
    char shown[SHOWN];
    return lac_fail(err, LAC_EINPUT, "%s:%zu: %s: \"%s\" %s", p->lines.path, p->lines.number,
                    column, lac_text_show(value, shown, sizeof shown), allowed);
}

static lac_status prepare_units(lac_parser *p, const lac_series_def *def,
                                const struct lac_units *units, lac_error *err)
{
    const struct {
        const char *unit, *si;
    } table[COLUMNS] = {{NULL, "s"},
                        {def->displacement_unit, "m"},
                        {def->velocity_unit, "m/s"},
                        {def->value_unit, def->value_si},
                        {def->sigma_unit, "m"}};
    lac_status read = lac_time_format_read(def->time_format, units, &p->format, err);
    if (read != LAC_OK) {
        return lac_fail_within(err, read, "%s", def->path);
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        p->wanted[c].scale = 1.0;
        p->wanted[c].digit = INT_MAX;
        p->wanted[c].taken = table[c].unit == NULL ? table[c].si : NULL;
        if (p->wanted[c].name == NULL || table[c].unit == NULL) {
            continue;
        }
        lac_status status = lac_units_convert(units, table[c].unit, table[c].si,
                                              &p->wanted[c].scale, &p->wanted[c].offset, err);
        if (status != LAC_OK) {
            return lac_fail_within(err, status, "%s: %s: unit \"%s\"", def->path, p->wanted[c].name,
                                   table[c].unit);
        }
    }
    return LAC_OK;
}

static lac_status prepare(lac_parser *p, FILE *stream, const lac_series_def *def,
                          const struct lac_units *units, lac_error *err)
{
    p->lines = (lac_lines){.stream = stream, .path = def->path};
    p->units = units;
    p->wanted[0].name = def->time;
    p->wanted[1].name = def->displacement;
    p->wanted[2].name = def->velocity;
    p->wanted[3].name = def->value;
    p->wanted[4].name = def->sigma;
    p->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    LAC_FAIL_MEMORY_IF(p->plain == (locale_t)0, err);
    p->callers = uselocale(p->plain);
    return prepare_units(p, def, units, err);
}

static lac_status add_attribution(lac_parser *p, const char *comment, lac_error *err)
{
    size_t length = strlen(comment);
    if (length == 0 || p->attribution_length + length + 2 > ATTRIBUTION_MAX) {
        return LAC_OK;
    }
    char *text = realloc(p->attribution, p->attribution_length + length + 2);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    if (p->attribution_length > 0) {
        text[p->attribution_length++] = ' ';
    }
    memcpy(text + p->attribution_length, comment, length + 1);
    p->attribution = text;
    p->attribution_length += length;
    return LAC_OK;
}

// The first line that is neither blank nor a comment; comments before it are the attribution.
static lac_status find_header(lac_parser *p, char **header, lac_error *err)
{
    *header = NULL;
    while (*header == NULL) {
        bool more = false;
        lac_status status = lac_lines_next(&p->lines, &more, err);
        if (status != LAC_OK) {
            return status;
        }
        LAC_FAIL_IF(!more, err, LAC_EINPUT, "%s: has no header line", p->lines.path);
        char *line = lac_text_trim(p->lines.text);
        if (*line == '#') {
            status = add_attribution(p, lac_text_trim(line + strspn(line, "#")), err);
        } else if (*line != '\0') {
            *header = p->lines.text;
        }
        if (status != LAC_OK) {
            return status;
        }
    }
    return LAC_OK;
}

// Adds `, name` to the list of the columns there are, while it fits.
static void list_column(char *list, size_t size, const char *name)
{
    char shown[SHOWN];
    size_t used = strlen(list);
    (void)snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "",
                   lac_text_show(name, shown, sizeof shown));
}

static lac_status match_column(lac_parser *p, bool found[COLUMNS], const char *name, lac_error *err)
{
    for (size_t c = 0; c < COLUMNS; c++) {
        if (p->wanted[c].name == NULL || strcmp(p->wanted[c].name, name) != 0) {
            continue;
        }
        if (found[c]) {
            return fail_at(p, err, "header", name, "names two columns");
        }
        found[c] = true;
        p->wanted[c].index = p->fields;
    }
    return LAC_OK;
}

// Whether a column without a unit may be SI.
static lac_status ask(lac_parser *p, size_t column, lac_error *err)
{
    char where[4096];
    bool known = false;
    lac_wanted *w = &p->wanted[column];
    if (w->name == NULL || w->taken == NULL) {
        return LAC_OK;
    }
    (void)snprintf(where, sizeof where, "%s:%zu", p->lines.path, p->lines.number);
    const lac_status status = lac_series_ask(p->units, where, w->name, w->taken, &known, err);
    w->taken = known ? NULL : w->taken;
    return status;
}

static lac_status read_header(lac_parser *p, lac_error *err)
{
    char *rest = NULL;
    char list[512] = "";
    bool found[COLUMNS] = {false};
    lac_status status = find_header(p, &rest, err);
    if (status != LAC_OK) {
        return status;
    }
    p->separator = lac_text_separator(rest);
    while (rest != NULL) {
        char *name = lac_text_field(&rest, p->separator);
        if (name == NULL) {
            return fail_at(p, err, "header", p->lines.text, "has a quoted name that does not end");
        }
        if (p->fields == 0) {
            (void)lac_text_show(name, p->first_name, sizeof p->first_name);
        }
        LAC_TRY_RETURN(match_column(p, found, name, err));
        list_column(list, sizeof list, name);
        p->fields++;
    }
    if (p->wanted[0].name == NULL) { // the first column is the time then
        p->wanted[0].name = p->first_name;
        found[0] = true;
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        LAC_FAIL_IF(p->wanted[c].name != NULL && !found[c], err, LAC_EINPUT,
                    "%s:%zu: has no column \"%s\"; its columns are %s", p->lines.path,
                    p->lines.number, p->wanted[c].name, list);
        status = c > 0 && status == LAC_OK ? ask(p, c, err) : status;
    }
    return status;
}

static lac_status parse_time(lac_parser *p, const char *field, double *time, lac_error *err)
{
    const char *name = p->wanted[0].name;
    if (lac_text_missing(field)) {
        return fail_at(p, err, name, field, "must be a time: a row with values has none");
    }
    bool comma = p->separator != ',' && strchr(field, ',') != NULL;
    bool dated = false;
    if (!lac_time_format_take(&p->format, field, comma ? ',' : '.', time, &dated)) {
        return fail_at(p, err, name, field, p->format.allowed);
    }
    if (p->time_known && dated != p->dated) {
        return fail_at(p, err, name, field,
                       p->dated ? "must be a date, as in the rows above"
                                : "must be seconds, as in the rows above");
    }
    const bool first = !p->time_known;
    p->time_known = true;
    p->dated = dated;
    p->wanted[0].taken = p->format.any && !dated ? p->wanted[0].taken : NULL;
    return first ? ask(p, 0, err) : LAC_OK;
}

static lac_status parse_value(lac_parser *p, size_t column, const char *field, double *value,
                              lac_error *err)
{
    const lac_wanted *w = &p->wanted[column];
    *value = NAN;
    if (lac_text_missing(field)) {
        p->missing++;
        return LAC_OK;
    }
    const char *used = strpbrk(field, ".,");
    char mark = (char)(used != NULL ? *used : '.');
    if (used != NULL && mark == ',' && p->separator == ',') {
        return fail_at(p, err, w->name, field, "must have a decimal point in a file with commas");
    }
    if (!lac_text_number(field, mark, value)) {
        return fail_at(p, err, w->name, field, "must be a number, or NA where there is none");
    }
    if (used != NULL && p->mark != '\0' && mark != p->mark) {
        return fail_at(p, err, w->name, field, "must have the decimal mark of the rows above");
    }
    p->mark = used != NULL ? mark : p->mark;
    const int digit = lac_text_digit(field, mark);
    p->wanted[column].digit = digit < p->wanted[column].digit ? digit : p->wanted[column].digit;
    if (column == SIGMA && !(*value > 0.0)) {
        return fail_at(p, err, w->name, field, "must be > 0: the standard error of a reading");
    }
    *value = *value * w->scale + w->offset;
    return isfinite(*value) ? LAC_OK : fail_at(p, err, w->name, field, "is too large");
}

static lac_status add_reading(lac_parser *p, const lac_row *reading, lac_error *err)
{
    if (p->count == p->capacity) {
        size_t capacity = p->capacity > 0 ? p->capacity * 2 : 256;
        lac_row *readings = realloc(p->readings, capacity * sizeof *readings);
        LAC_FAIL_MEMORY_IF(readings == NULL, err);
        p->readings = readings;
        p->capacity = capacity;
    }
    p->readings[p->count++] = *reading;
    return LAC_OK;
}

// The wanted fields of a row; a row that ends early lacks its last values.
static lac_status split_row(lac_parser *p, const char *fields[COLUMNS], bool *blank, lac_error *err)
{
    char *rest = p->lines.text;
    size_t index = 0;
    *blank = true;
    for (size_t c = 0; c < COLUMNS; c++) {
        fields[c] = "";
    }
    for (; rest != NULL; index++) {
        const char *field = lac_text_field(&rest, p->separator);
        if (field == NULL) {
            return fail_at(p, err, "row", p->lines.text,
                           "has a quote that does not end, or ends within a field");
        }
        if (index >= p->fields && *field != '\0') {
            return fail_at(p, err, "row", field, "stands beyond the last column of the header");
        }
        *blank = *blank && *field == '\0';
        for (size_t c = 0; c < COLUMNS; c++) {
            if (p->wanted[c].name != NULL && p->wanted[c].index == index) {
                fields[c] = field;
            }
        }
    }
    return LAC_OK;
}

static lac_status read_row(lac_parser *p, lac_error *err)
{
    const char *fields[COLUMNS];
    lac_row reading = {.value = {NAN, NAN, NAN, NAN}, .line = p->lines.number};
    bool blank = false;
    lac_status status = LAC_OK;
    LAC_TRY(split_row(p, fields, &blank, err));
    if (blank) {
        goto out;
    }
    LAC_TRY(parse_time(p, fields[0], &reading.time, err));
    for (size_t c = 1; c < COLUMNS; c++) {
        if (p->wanted[c].name != NULL) {
            LAC_TRY(parse_value(p, c, fields[c], &reading.value[c - 1], err));
        }
    }
    LAC_TRY(add_reading(p, &reading, err));
out:
    return status;
}

static lac_status read_rows(lac_parser *p, lac_error *err)
{
    lac_status status = LAC_OK;
    bool more = true;
    LAC_TRY(lac_lines_next(&p->lines, &more, err));
    while (more) {
        const char *line = p->lines.text;
        line += strspn(line, " \t");
        if (*line != '#') {
            LAC_TRY(read_row(p, err));
        }
        LAC_TRY(lac_lines_next(&p->lines, &more, err));
    }
    if (p->count == 0) {
        LAC_TRY(lac_fail(err, LAC_EINPUT, "%s: has no readings", p->lines.path));
    }
out:
    return status;
}

static lac_status check_any_value(const lac_parser *p, lac_error *err)
{
    for (size_t i = 0; i < p->count; i++) {
        for (size_t c = 0; c < VALUES; c++) {
            if (!isnan(p->readings[i].value[c])) {
                return LAC_OK;
            }
        }
    }
    return lac_fail(err, LAC_EINPUT, "%s: every reading is missing", p->lines.path);
}

// One column of values over the readings kept.
static double *copy_values(const lac_parser *p, size_t column)
{
    double *values = malloc(p->count * sizeof *values);
    for (size_t i = 0; values != NULL && i < p->count; i++) {
        values[i] = p->readings[i].value[column];
    }
    return values;
}

static lac_status fill_series(lac_series *s, const lac_parser *p)
{
    double **const target[VALUES] = {&s->displacement, &s->velocity, &s->value, &s->sigma};
    s->time = malloc(p->count * sizeof *s->time);
    s->line = malloc(p->count * sizeof *s->line);
    s->attribution = strdup(p->attribution != NULL ? p->attribution : "");
    bool whole = s->time != NULL && s->line != NULL && s->attribution != NULL;
    for (size_t c = 0; c < VALUES; c++) {
        if (p->wanted[c + 1].name != NULL) {
            *target[c] = copy_values(p, c);
            whole = whole && *target[c] != NULL;
        }
    }
    for (size_t i = 0; whole && i < p->count; i++) {
        s->time[i] = p->readings[i].time;
        s->line[i] = p->readings[i].line;
    }
    return whole ? LAC_OK : LAC_ENOMEM;
}

// Several instruments in one file, or a column that is not the time, are no repeated rows.
static lac_status merge_rows(lac_parser *p, size_t *conflicts, lac_error *err)
{
    const size_t rows = p->count;
    const size_t line = lac_rows_merge(&p->count, p->readings, conflicts);
    return *conflicts <= 1 || BELIEVED * *conflicts <= rows
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT,
                          "%s:%zu: %s: a row above has the same time and another value, as %zu of "
                          "%zu rows do: is it the time, and the file of one instrument?",
                          p->lines.path, line, p->wanted[0].name, *conflicts, rows);
}

static double digit_of(const lac_wanted *w)
{
    return w->name != NULL && w->digit < INT_MAX ? fabs(w->scale) * pow(10.0, w->digit) : 0.0;
}

// What is not a column of numbers.
static void describe(const lac_parser *p, lac_series *s)
{
    s->dated = p->dated;
    s->missing = p->missing;
    s->displacement_digit = digit_of(&p->wanted[1]);
    s->velocity_digit = digit_of(&p->wanted[2]);
    s->time_unit = p->dated ? 0.0 : p->format.scale;
    (void)snprintf(s->time_name, sizeof s->time_name, "%s", p->dated ? "" : p->format.unit);
    for (size_t c = 0; c < COLUMNS; c++) {
        const lac_wanted *w = &p->wanted[c];
        if (w->name != NULL && w->taken != NULL) {
            lac_series_doubt(s, "%.48s: no unit is named: taken as %s", w->name, w->taken);
        }
    }
    if (s->conflicts > 0) {
        lac_series_doubt(s, "%zu of %zu rows repeat a time with another value: the first is kept",
                         s->conflicts, s->n + s->duplicates);
    }
}

static lac_status build(lac_parser *p, lac_series **out, lac_error *err)
{
    const size_t rows = p->count;
    size_t conflicts = 0;
    p->disordered = lac_rows_sort(rows, p->readings);
    lac_status status = merge_rows(p, &conflicts, err);
    LAC_TRY_RETURN(status == LAC_OK ? check_any_value(p, err) : status);
    lac_series *s = calloc(1, sizeof *s);
    if (s == NULL || fill_series(s, p) != LAC_OK) {
        lac_series_free(s);
        return lac_fail_memory(err);
    }
    s->n = p->count;
    s->duplicates = rows - p->count;
    s->disordered = p->disordered;
    s->conflicts = conflicts;
    describe(p, s);
    *out = s;
    return LAC_OK;
}

lac_status lac_series_read_stream(FILE *stream, const lac_series_def *def,
                                  const struct lac_units *units, lac_series **out, lac_error *err)
{
    *out = NULL;
    lac_parser p = {.plain = (locale_t)0};
    lac_status status = LAC_OK;
    LAC_TRY(prepare(&p, stream, def, units, err));
    LAC_TRY(read_header(&p, err));
    LAC_TRY(read_rows(&p, err));
    LAC_TRY(build(&p, out, err));
out:
    if (p.plain != (locale_t)0) {
        (void)uselocale(p.callers);
        freelocale(p.plain);
    }
    free(p.attribution);
    free(p.readings);
    free(p.lines.text);
    return status;
}
