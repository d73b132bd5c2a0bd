// SPDX-License-Identifier: GPL-3.0-or-later
// A monitoring file: comments, a header, rows; then sorted, with repeated times taken once.
#include "base/date.h"
#include "base/units.h"
#include "series/parser.h"

enum {
    BELIEVED = 10, ///< of so many rows one may repeat a time with another value; one always
    UNIT_ROWS = 3, ///< that may stand between the header and the first reading
};

static lac_status prepare_column(lac_parser *p, lac_wanted *w, lac_error *err)
{
    *w = (lac_wanted){.name = w->name,
                      .unit = w->unit,
                      .si = w->si,
                      .taken = w->unit == NULL ? w->si : NULL,
                      .scale = 1.0,
                      .digit = INT_MAX};
    if (w->name == NULL || w->unit == NULL) {
        return LAC_OK;
    }
    const lac_status status =
        lac_units_convert(p->units, w->unit, w->si, &w->scale, &w->offset, err);
    return lac_fail_within(err, status, "%s: %s: unit \"%s\"", p->lines.path, w->name, w->unit);
}

static lac_status prepare_columns(lac_parser *p, const lac_series_def *def, lac_error *err)
{
    const lac_components *axes = &p->components;
    const lac_wanted table[COLUMNS] = {
        {.name = def->time, .si = "s"},
        {.name = def->displacement, .unit = def->displacement_unit, .si = "m"},
        {.name = def->velocity, .unit = def->velocity_unit, .si = "m/s"},
        {.name = def->value, .unit = def->value_unit, .si = def->value_si},
        {.name = def->sigma, .unit = def->sigma_unit, .si = "m"},
        {.name = axes->name[0], .unit = axes->unit[0], .si = "m"},
        {.name = axes->name[1], .unit = axes->unit[1], .si = "m"},
        {.name = axes->name[2], .unit = axes->unit[2], .si = "m"},
        {.name = def->velocity_sigma, .unit = def->velocity_sigma_unit, .si = "1"},
        {.name = def->velocity_most, .unit = def->velocity_most_unit, .si = "m/s"},
        {.name = def->within, .unit = def->within_unit, .si = "s"},
        {.name = def->clock}};
    lac_status read = lac_time_format_read(def->time_format, p->units, &p->format, err);
    LAC_TRY_RETURN(lac_fail_within(err, read, "%s", def->path));
    for (size_t c = 0; c < COLUMNS; c++) {
        p->wanted[c] = table[c];
        LAC_TRY_RETURN(prepare_column(p, &p->wanted[c], err));
    }
    p->time_named = def->time != NULL;
    if (!p->format.any && p->format.pattern == NULL && !p->format.decimal_year) {
        p->wanted[0].unit = def->time_format;
        p->wanted[0].scale = p->format.scale;
        p->wanted[0].taken = NULL;
    }
    return LAC_OK;
}

static lac_status prepare(lac_parser *p, FILE *stream, const lac_series_def *def,
                          const struct lac_units *units, lac_error *err)
{
    p->lines = (lac_lines){.stream = stream, .path = def->path};
    p->units = units;
    p->skip = def->skip > 0 ? (size_t)def->skip : 0;
    p->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    LAC_FAIL_MEMORY_IF(p->plain == (locale_t)0, err);
    p->callers = uselocale(p->plain);
    LAC_TRY_RETURN(lac_components_read(def, &p->components, err));
    return prepare_columns(p, def, err);
}

// What unit a column has that none was named for: that of its brackets, or perhaps SI.
static lac_status settle(lac_parser *p, size_t column, lac_error *err)
{
    char where[4096];
    bool known = false;
    lac_wanted *w = &p->wanted[column];
    const bool bracket = w->bracket[0] != '\0';
    if (w->name == NULL) {
        return LAC_OK;
    }
    if (bracket) {
        LAC_TRY_RETURN(lac_parser_unit(p, column, w->bracket, false, err));
    }
    if (w->taken == NULL) {
        return LAC_OK;
    }
    (void)snprintf(where, sizeof where, "%s:%zu", p->lines.path,
                   column > 0 ? p->header_line : p->lines.number);
    LAC_TRY_RETURN(lac_series_ask(p->units, where, w->name, w->taken, &known, err));
    w->taken = known ? NULL : w->taken;
    return bracket ? lac_parser_unit(p, column, w->bracket, true, err) : LAC_OK;
}

// Says what a time must be, and by which other formats this one would be.
static lac_status refuse_time(const lac_parser *p, const char *field, lac_error *err)
{
    char guess[2][LAC_TIME_GUESS], allowed[256];
    const size_t n = lac_time_format_guess(field, 2, guess);
    (void)snprintf(allowed, sizeof allowed, "%s%s%s%s%s%s%s%s", p->format.allowed,
                   n > 0 ? "; perhaps --time-format \"" : "", n > 0 ? guess[0] : "",
                   n > 0 ? "\"" : "", n > 1 ? " or \"" : "", n > 1 ? guess[1] : "",
                   n > 1 ? "\"" : "", n > 0 ? ", in a case time_format" : "");
    return lac_parser_fail(p, err, p->wanted[0].name, field, allowed);
}

static lac_status parse_time(lac_parser *p, const char *field, double *time, lac_error *err)
{
    lac_wanted *w = &p->wanted[0];
    if (lac_text_missing(field)) {
        return lac_parser_fail(p, err, w->name, field,
                               "must be a time: a row with values has none");
    }
    bool comma = p->separator != ',' && strchr(field, ',') != NULL;
    bool dated = false;
    if (!lac_time_format_take(&p->format, field, comma ? ',' : '.', time, &dated)) {
        return refuse_time(p, field, err);
    }
    if (p->time_known && dated != p->dated) {
        return lac_parser_fail(p, err, w->name, field,
                               p->dated ? "must be a date, as in the rows above"
                                        : "must be seconds, as in the rows above");
    }
    if (p->time_known) {
        return LAC_OK;
    }
    p->time_known = true;
    p->dated = dated;
    p->zoned = dated && lac_time_format_zoned(&p->format, field);
    w->taken = p->format.any && !dated ? w->taken : NULL;
    if (dated && w->unit == NULL) {
        return LAC_OK;
    }
    const bool open = w->taken != NULL;
    LAC_TRY_RETURN(settle(p, 0, err));
    if (open && w->taken == NULL && w->scale != 1.0) { // the header's unit
        p->format.scale = w->scale;
        (void)snprintf(p->format.unit, sizeof p->format.unit, "%s",
                       strlen(w->bracket) < sizeof p->format.unit ? w->bracket : "");
        *time *= w->scale;
    }
    return LAC_OK;
}

static lac_status check_form(const lac_parser *p, const char *name, const char *field, char mark,
                             double *value, lac_error *err)
{
    char plain[SHOWN], allowed[2 * SHOWN];
    const bool alien = mark == ',' && p->separator == ',';
    const bool number = !alien && lac_text_number(field, mark, value);
    if (!number && lac_text_thousands(field, plain, sizeof plain)) {
        (void)snprintf(allowed, sizeof allowed,
                       "has marks of thousands: export it without them, as %s", plain);
        return lac_parser_fail(p, err, name, field, allowed);
    }
    return number ? LAC_OK
                  : lac_parser_fail(p, err, name, field,
                                    alien ? "must have a decimal point in a file with commas"
                                          : "must be a number, or NA where there is none");
}

static lac_status parse_value(lac_parser *p, size_t column, const char *field, double *value,
                              double *last, lac_error *err)
{
    lac_wanted *w = &p->wanted[column];
    *value = NAN;
    if (lac_text_missing(field)) {
        p->missing++;
        return LAC_OK;
    }
    const char *used = strpbrk(field, ".,");
    char mark = (char)(used != NULL ? *used : '.');
    LAC_TRY_RETURN(check_form(p, w->name, field, mark, value, err));
    if (used != NULL && p->mark != '\0' && mark != p->mark) {
        return lac_parser_fail(p, err, w->name, field,
                               "must have the decimal mark of the rows above");
    }
    p->mark = used != NULL ? mark : p->mark;
    lac_parser_suspect(p, column, field, mark);
    const int digit = lac_text_digit(field, mark);
    *last = fabs(w->scale) * pow(10.0, digit);
    w->digit = digit < w->digit ? digit : w->digit;
    if (column == SIGMA && !(*value > 0.0)) {
        return lac_parser_fail(p, err, w->name, field,
                               "must be > 0: the standard error of a reading");
    }
    *value = *value * w->scale + w->offset;
    return lac_parser_check_size(p, column, field, *value, err);
}

static lac_status add_reading(lac_parser *p, const lac_row *reading, lac_error *err)
{
    LAC_TRY_RETURN(lac_grow(&p->readings, &p->capacity, p->count + 1, sizeof *p->readings, err));
    p->readings[p->count++] = *reading;
    return LAC_OK;
}

// A column of dates is remembered, in case that what is taken for the time is none.
static void note_date(lac_parser *p, size_t index, const char *field)
{
    char guess[1][LAC_TIME_GUESS];
    double ignored;
    const bool first = p->count == 0 && p->dated_name[0] == '\0';
    if (first && index != p->wanted[0].index && index < p->fields &&
        !lac_text_number(field, '.', &ignored) &&
        (lac_date_parse(field, &ignored) || lac_time_format_guess(field, 1, guess) > 0)) {
        (void)lac_text_show(p->column[index], p->dated_name, sizeof p->dated_name);
    }
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
            return lac_parser_fail(p, err, "row", p->lines.text,
                                   "has a quote that does not end, or ends within a field");
        }
        if (index >= p->fields && *field != '\0') {
            return lac_parser_fail(p, err, "row", field,
                                   "stands beyond the last column of the header");
        }
        *blank = *blank && *field == '\0';
        note_date(p, index, field);
        for (size_t c = 0; c < COLUMNS; c++) {
            if (p->wanted[c].name != NULL && p->wanted[c].index == index) {
                fields[c] = field;
            }
        }
    }
    return LAC_OK;
}

// Loggers write units below the header, and how they averaged: words without a digit.
static bool is_units(lac_parser *p, const char *const fields[COLUMNS])
{
    bool words = false;
    if (p->count > 0 || p->lines.number > p->header_line + UNIT_ROWS) {
        return false;
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        if (strpbrk(fields[c], "0123456789") != NULL) {
            return false;
        }
        words = words || !lac_text_missing(fields[c]);
    }
    return words;
}

static void take_units(lac_parser *p, const char *const fields[COLUMNS])
{
    p->unit_line = p->lines.number;
    for (size_t c = 0; c < COLUMNS; c++) {
        lac_wanted *w = &p->wanted[c];
        const char *unit = fields[c] + strspn(fields[c], "([");
        const size_t n = strcspn(unit, ")]");
        double scale, offset;
        char text[SHOWN];
        if (w->name == NULL || w->si == NULL || w->bracket[0] != '\0' || n >= sizeof text) {
            continue;
        }
        (void)snprintf(text, sizeof text, "%.*s", (int)n, unit);
        if ((n > 0 && lac_units_convert(p->units, text, w->si, &scale, &offset, NULL) == LAC_OK) ||
            (c > 0 && lac_parser_is_unit(p, text))) {
            (void)snprintf(w->bracket, sizeof w->bracket, "%s", text);
        }
    }
}

static lac_status parse_row(lac_parser *p, const char *const fields[COLUMNS], lac_error *err)
{
    lac_row reading = {.digit = {NAN, NAN}, .line = p->lines.number};
    double digit[1 + VALUES];
    const char *time = fields[0];
    char joined[2 * SHOWN];
    if (p->wanted[CLOCK].name != NULL && !lac_text_missing(fields[0])) {
        if (lac_text_missing(fields[CLOCK])) {
            return lac_parser_fail(p, err, p->wanted[CLOCK].name, fields[CLOCK],
                                   "must be a time of day: its row has a date");
        }
        (void)snprintf(joined, sizeof joined, "%.40s %.40s", fields[0], fields[CLOCK]);
        time = joined;
    }
    for (size_t c = 1; c <= VALUES && p->count == 0; c++) {
        LAC_TRY_RETURN(settle(p, c, err));
    }
    LAC_TRY_RETURN(parse_time(p, time, &reading.time, err));
    for (size_t c = 1; c <= VALUES; c++) {
        reading.value[c - 1] = digit[c] = NAN;
        if (p->wanted[c].name != NULL) {
            LAC_TRY_RETURN(parse_value(p, c, fields[c], &reading.value[c - 1], &digit[c], err));
        }
    }
    reading.digit[1] = digit[2];
    reading.digit[0] = digit[1]; // of components the coarsest
    for (size_t k = 0; k < p->components.count; k++) {
        reading.digit[0] = fmax(reading.digit[0], digit[COMPONENT + k]);
    }
    return add_reading(p, &reading, err);
}

static lac_status read_row(lac_parser *p, lac_error *err)
{
    const char *fields[COLUMNS];
    bool over = false;
    LAC_TRY_RETURN(lac_parser_again(p, &over, err));
    if (over) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(split_row(p, fields, &over, err));
    if (over) {
        return LAC_OK;
    }
    if (is_units(p, fields)) {
        take_units(p, fields);
        return LAC_OK;
    }
    return parse_row(p, fields, err);
}

static lac_status read_rows(lac_parser *p, lac_error *err)
{
    bool more = true;
    LAC_TRY_RETURN(lac_lines_next(&p->lines, &more, err));
    while (more) {
        if (p->lines.text[strspn(p->lines.text, " \t")] != '#') {
            LAC_TRY_RETURN(read_row(p, err));
        }
        LAC_TRY_RETURN(lac_lines_next(&p->lines, &more, err));
    }
    LAC_FAIL_IF(p->count == 0, err, LAC_EINPUT, "%s: has no readings", p->lines.path);
    return LAC_OK;
}

static lac_status check_any_value(const lac_parser *p, lac_error *err)
{
    for (size_t i = 0; i < p->count * VALUES; i++) {
        if (!isnan(p->readings[i / VALUES].value[i % VALUES])) {
            return LAC_OK;
        }
    }
    return lac_parser_fail_empty(p, err);
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
                          "%zu rows do: is the time of day in another column (--clock, in a case "
                          "clock), "
                          "or are there two instruments?",
                          p->lines.path, line, p->wanted[0].name, *conflicts, rows);
}

static double digit_of(const lac_wanted *w)
{
    return w->name != NULL && w->digit < INT_MAX ? fabs(w->scale) * pow(10.0, w->digit) : 0.0;
}

// What was taken for want of a word.
static void note_doubts(const lac_parser *p, lac_series *s)
{
    if (p->skip == 0 && p->header_line != p->first_line) {
        lac_series_doubt(s, "line %zu is taken as the header", p->header_line);
    }
    if (p->header_latin) {
        lac_series_doubt(s, "the header is not UTF-8: taken as Latin-1 (Windows-1252)");
    }
    if (p->unit_line > 0) {
        lac_series_doubt(s, "what stands below the header down to line %zu is taken as units",
                         p->unit_line);
    }
    if (p->headers_again > 0) {
        lac_series_doubt(s, "the header stands again in line %zu%s: taken as no reading",
                         p->again_line, p->headers_again > 1 ? " and others" : "");
    }
    if (p->format.monthly) {
        lac_series_doubt(s, "%.48s: months without a day: taken as their middle",
                         p->wanted[0].name);
    }
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

static void describe(const lac_parser *p, lac_series *s)
{
    s->dated = p->dated;
    s->missing = p->missing;
    s->displacement_digit = digit_of(&p->wanted[1]);
    for (size_t k = 0; k < p->components.count; k++) {
        s->displacement_digit = fmax(s->displacement_digit, digit_of(&p->wanted[COMPONENT + k]));
    }
    s->velocity_digit = digit_of(&p->wanted[2]);
    s->time_unit = p->dated ? 0.0 : p->format.scale;
    (void)snprintf(s->time_name, sizeof s->time_name, "%s",
                   p->zoned   ? "UTC"
                   : p->dated ? ""
                              : p->format.unit);
    note_doubts(p, s);
}

static void fill(const lac_parser *p, lac_series *s)
{
    double *const column[VALUES] = {
        s->displacement, s->velocity,     s->value,          s->sigma,         s->component[0],
        s->component[1], s->component[2], s->velocity_sigma, s->velocity_most, s->within};
    double *const digits[] = {s->displacement_digits, s->velocity_digits};
    for (size_t i = 0; i < s->n; i++) {
        s->time[i] = p->readings[i].time;
        s->line[i] = p->readings[i].line;
        for (size_t c = 0; c < VALUES; c++) {
            if (column[c] != NULL) {
                column[c][i] = p->readings[i].value[c];
            }
        }
        for (size_t c = 0; c < 2; c++) {
            if (digits[c] != NULL) {
                digits[c][i] = p->readings[i].digit[c];
            }
        }
    }
}

static lac_status build(lac_parser *p, const lac_series_def *def, lac_series **out, lac_error *err)
{
    const size_t rows = p->count;
    const size_t disordered = lac_rows_sort(rows, p->readings);
    size_t conflicts = 0;
    lac_series *s;
    LAC_TRY_RETURN(lac_parser_check(p, err));
    LAC_TRY_RETURN(merge_rows(p, &conflicts, err));
    LAC_TRY_RETURN(check_any_value(p, err));
    LAC_TRY_RETURN(lac_series_new(def, &p->components, p->count,
                                  p->attribution != NULL ? p->attribution : "", &s, err));
    fill(p, s);
    s->duplicates = rows - p->count;
    s->disordered = disordered;
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
    LAC_TRY(lac_parser_header(&p, err));
    LAC_TRY(read_rows(&p, err));
    LAC_TRY(build(&p, def, out, err));
out:
    if (p.plain != (locale_t)0) {
        (void)uselocale(p.callers);
        freelocale(p.plain);
    }
    free(p.column);
    free(p.header);
    free(p.components.owned);
    free(p.attribution);
    free(p.readings);
    free(p.lines.text);
    return status;
}
