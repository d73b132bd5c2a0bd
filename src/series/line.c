// SPDX-License-Identifier: GPL-3.0-or-later
// One line of a stream of readings: its fields by a header or a given order, its numbers as in a
// file.
#include "series/line.h"

#include <stdarg.h>

#include "base/units.h"
#include "series/text.h"

enum { STATION, TIME, CLOCK, DISPLACEMENT, SIGMA, COLUMNS, SHOWN = 48 };

struct lac_line_reader {
    const char *path;
    const char *name[COLUMNS]; // NULL: not there
    size_t index[COLUMNS];
    double scale[COLUMNS], offset[COLUMNS];
    lac_time_format format;
    char asked[LAC_LINE_TEXT]; // why bare numbers are no times; "": they are
    bool ready;                // the columns are known
    bool headed;               // by a line of the stream
    char *header;              // it, owned
    char *decoded;             // the last line that was no UTF-8; owned
    size_t fields;             // of it
    char separator;
    const struct lac_units *units;
};

static lac_line_kind say(lac_line *out, lac_line_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static lac_line_kind say(lac_line *out, lac_line_kind kind, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(out->text, sizeof out->text, format, args);
    va_end(args);
    return kind;
}

static lac_line_kind blame(lac_line *out, const char *name, const char *field, const char *allowed)
{
    char shown[SHOWN];
    return say(out, LAC_LINE_WRONG, "%s: \"%s\" %s", name,
               lac_text_show(field, shown, sizeof shown), allowed);
}

// The place of each column among the names.
static lac_line_kind place(lac_line_reader *r, const char *const *names, size_t n, lac_line *out)
{
    for (size_t c = 0; c < COLUMNS; c++) {
        size_t found = 0;
        for (size_t i = 0; i < n && r->name[c] != NULL; i++) {
            if (strcmp(names[i], r->name[c]) == 0) {
                r->index[c] = i;
                found++;
            }
        }
        if (r->name[c] != NULL && found != 1) {
            return say(out, LAC_LINE_LOST, "has %s column \"%s\"",
                       found == 0 ? "no" : "more than one", r->name[c]);
        }
    }
    r->fields = n;
    r->ready = true;
    return LAC_LINE_NOTHING;
}

static lac_line_kind read_header(lac_line_reader *r, char *text, lac_line *out)
{
    enum { MOST = 256 };
    const char *names[MOST];
    size_t n = 0;
    char *rest = text;
    char *kept = strdup(text);
    if (kept == NULL) {
        return say(out, LAC_LINE_LOST, "out of memory");
    }
    free(r->header);
    r->header = kept;
    r->separator = lac_text_separator(text);
    while (rest != NULL && n < MOST) {
        names[n] = lac_text_field(&rest, r->separator);
        if (names[n++] == NULL) {
            return say(out, LAC_LINE_LOST, "has a quoted name in its header that does not end");
        }
    }
    return place(r, names, n, out);
}

static lac_status set_unit(lac_line_reader *r, size_t c, const char *unit, lac_error *err)
{
    bool known = false;
    r->scale[c] = 1.0;
    if (r->name[c] == NULL || unit == NULL) {
        return r->name[c] == NULL ? LAC_OK
                                  : lac_series_ask(r->units, r->path, r->name[c], "m", &known, err);
    }
    const lac_status status =
        lac_units_convert(r->units, unit, "m", &r->scale[c], &r->offset[c], err);
    return lac_fail_within(err, status, "%s: %s: unit \"%s\"", r->path, r->name[c], unit);
}

lac_status lac_line_reader_create(const lac_line_def *def, const struct lac_units *units,
                                  lac_line_reader **out, lac_error *err)
{
    lac_error why = {""};
    lac_line line;
    bool known = false;
    lac_status status;
    lac_line_reader *r = *out = calloc(1, sizeof *r);
    LAC_FAIL_MEMORY_IF(r == NULL, err);
    r->path = def->path;
    r->units = units;
    r->separator = ',';
    r->headed = def->columns == 0;
    r->name[STATION] = def->station;
    r->name[TIME] = def->time;
    r->name[CLOCK] = def->clock;
    r->name[DISPLACEMENT] = def->displacement;
    r->name[SIGMA] = def->sigma;
    LAC_TRY(lac_time_format_read(def->time_format, units, &r->format, err));
    if (r->format.any && lac_series_ask(units, def->path, def->time, "s", &known, &why) != LAC_OK) {
        (void)snprintf(r->asked, sizeof r->asked, "%s", why.message + strlen(def->path) + 2);
    }
    LAC_TRY(set_unit(r, DISPLACEMENT, def->displacement_unit, err));
    LAC_TRY(set_unit(r, SIGMA, def->sigma_unit, err));
    LAC_LEAVE_IF(!r->headed && place(r, def->order, def->columns, &line) != LAC_LINE_NOTHING, err,
                 LAC_EINPUT, "%s: columns %s", def->path, line.text);
out:
    LAC_MADE(status, out, lac_line_reader_free);
}

void lac_line_reader_free(lac_line_reader *r)
{
    if (r != NULL) {
        free(r->header);
        free(r->decoded);
        free(r);
    }
}

const char *lac_line_header(const lac_line_reader *r) { return r->header; }

// The fields that are wanted; false where a quote is wrong or a field stands beyond the last.
static bool split(const lac_line_reader *r, char *text, const char *field[COLUMNS], bool *blank)
{
    char *rest = text;
    *blank = true;
    for (size_t c = 0; c < COLUMNS; c++) {
        field[c] = "";
    }
    for (size_t i = 0; rest != NULL; i++) {
        const char *one = lac_text_field(&rest, r->separator);
        if (one == NULL || (i >= r->fields && r->headed && *one != '\0')) {
            return false;
        }
        *blank = *blank && *one == '\0';
        for (size_t c = 0; c < COLUMNS; c++) {
            field[c] = r->name[c] != NULL && r->index[c] == i ? one : field[c];
        }
    }
    return true;
}

static bool read_value(const lac_line_reader *r, size_t c, const char *field, double *value,
                       double *digit)
{
    const char *used = r->separator != ',' ? strpbrk(field, ".,") : NULL;
    const char mark = (char)(used != NULL ? *used : '.');
    *value = NAN;
    *digit = NAN;
    if (lac_text_missing(field)) {
        return true;
    }
    if (!lac_text_number(field, mark, value)) {
        return false;
    }
    *value = *value * r->scale[c] + r->offset[c];
    *digit = fabs(r->scale[c]) * pow(10.0, lac_text_digit(field, mark));
    return fabs(*value) <= LAC_SERIES_MOST && (c != SIGMA || *value > 0.0);
}

static lac_line_kind read_fields(const lac_line_reader *r, const char *field[COLUMNS],
                                 lac_line *out)
{
    double unused;
    const char *station = field[STATION];
    const char *time = field[TIME];
    char joined[2 * SHOWN];
    if (r->name[STATION] != NULL && (*station == '\0' || strlen(station) >= LAC_LINE_STATION)) {
        return blame(out, r->name[STATION], station, "must be a name of 1 to 63 bytes");
    }
    if (strstr(station, "\xef\xbf\xbd") != NULL) { // what was lost once may be of two names
        return blame(out, r->name[STATION], station, "must be a name in UTF-8 or Latin-1");
    }
    (void)snprintf(out->station, sizeof out->station, "%s", station);
    if (r->name[CLOCK] != NULL && lac_text_missing(field[CLOCK])) {
        return blame(out, r->name[CLOCK], field[CLOCK], "must be a time of day");
    }
    if (r->name[CLOCK] != NULL) {
        (void)snprintf(joined, sizeof joined, "%.40s %.40s", time, field[CLOCK]);
        time = joined;
    }
    const bool comma = r->separator != ',' && strchr(time, ',') != NULL;
    if (lac_text_missing(field[TIME]) ||
        !lac_time_format_take(&r->format, time, comma ? ',' : '.', &out->time, &out->dated)) {
        return blame(out, r->name[TIME], time, r->format.allowed);
    }
    if (!out->dated && r->asked[0] != '\0') {
        return say(out, LAC_LINE_WRONG, "%s", r->asked);
    }
    if (!read_value(r, DISPLACEMENT, field[DISPLACEMENT], &out->displacement, &out->digit)) {
        return blame(out, r->name[DISPLACEMENT], field[DISPLACEMENT],
                     "must be a number, or NA where there is none");
    }
    if (r->name[SIGMA] != NULL && !read_value(r, SIGMA, field[SIGMA], &out->sigma, &unused)) {
        return blame(out, r->name[SIGMA], field[SIGMA], "must be > 0: the error of a reading");
    }
    return LAC_LINE_READING;
}

static bool is_text(const char *text)
{
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        if ((c < ' ' && c != '\t' && c != '\f') || c == 0x7f) {
            return false;
        }
    }
    return true;
}

lac_line_kind lac_line_read(lac_line_reader *r, char *text, lac_line *out)
{
    const char *field[COLUMNS];
    bool blank = false;
    *out = (lac_line){.time = NAN, .displacement = NAN, .sigma = NAN, .digit = NAN};
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0) {
        text += 3; // the mark that editors put before a text
    }
    text = lac_text_trim(text);
    if (*text == '#' || *text == '\0') {
        return LAC_LINE_NOTHING;
    }
    if (!is_text(text)) {
        return say(out, LAC_LINE_WRONG, "the line holds bytes that are not text");
    }
    if (!lac_text_is_utf8(text)) {
        free(r->decoded);
        text = r->decoded = lac_text_decode(text);
        if (text == NULL) {
            return say(out, LAC_LINE_WRONG, "out of memory");
        }
    }
    if (!r->ready) {
        return read_header(r, text, out);
    }
    if (!r->headed) {
        r->separator = lac_text_separator(text);
    } else if (strcmp(text, r->header) == 0) {
        return LAC_LINE_NOTHING; // a sender that begins again
    }
    if (!split(r, text, field, &blank)) {
        return say(out, LAC_LINE_WRONG,
                   "the line has a quote that does not end, or more fields than there are columns");
    }
    return blank ? LAC_LINE_NOTHING : read_fields(r, field, out);
}
