// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a monitoring file that may be something else than they were read as are asked about.
#include <strings.h>

#include "base/units.h"
#include "series/parser.h"

static const double whole_column = 900.0; // what stands alone in one is a code from here on

// To UDUNITS a newton, a volume, a minute, a megainch, a calorie: to a reader which column it is.
bool lac_parser_is_unit(const lac_parser *p, const char *text)
{
    static const char *const labels[] = {"min", "Min", "cal", "dN", "TS", "PS"};
    const size_t digits = text[0] != '\0' ? strspn(text + 1, "0123456789") : 0;
    double scale, offset;
    for (size_t i = 0; i < sizeof labels / sizeof *labels; i++) {
        if (strcmp(text, labels[i]) == 0) {
            return false;
        }
    }
    if (text[0] == '\0' || (text[1 + digits] == '\0' && strchr("mshdVK%", text[0]) == NULL)) {
        return false;
    }
    return lac_units_convert(p->units, text, text, &scale, &offset, NULL) == LAC_OK;
}

// 1.234 may be 1234 where thousands have a mark.
void lac_parser_suspect(lac_parser *p, size_t column, const char *field, char mark)
{
    lac_wanted *w = &p->wanted[column];
    field += *field == '-' || *field == '+' ? 1 : 0;
    const char *at = strchr(field, mark);
    const size_t before = strspn(field, "0123456789");
    const size_t after = at != NULL ? strspn(at + 1, "0123456789") : 0;
    if (at == NULL) {
        w->whole3 = w->whole3 || (before == 3 && field[3] == '\0');
    } else if (after == 3 && at[4] == '\0' && before >= 1 && before <= 3 && *field != '0') {
        if (w->doubtful_line == 0) {
            w->doubtful_line = p->lines.number;
            (void)lac_text_show(field, w->doubtful, sizeof w->doubtful);
        }
    } else {
        w->decimals = true;
    }
}

// Where whole numbers end at 999 and all marks stand before three digits, these are thousands.
static lac_status check_thousands(const lac_parser *p, const lac_wanted *w, lac_error *err)
{
    char plain[SHOWN];
    LAC_FAIL_IF(
        w->doubtful_line > 0 && w->whole3 && !w->decimals &&
            lac_text_thousands(w->doubtful, plain, sizeof plain),
        err, LAC_EINPUT,
        "%s:%zu: %s: \"%s\" is %s or one with three decimals: no other number of the column "
        "tells; export it without marks of thousands, or with decimals everywhere",
        p->lines.path, w->doubtful_line, w->name, w->doubtful, plain);
    return LAC_OK;
}

// Numbers by which a logger may mean that there is none.

enum { COUNTED = 5 }; // rows from which on 1, 2, 3 ... is no accident

enum { TENS = 7, LASTS = 3, CODES = 2 * TENS * LASTS };

// Which of -99 ... -99999999.99, 99 ... a number is, nines and nothing else; CODES: none.
static size_t code_of(double x)
{
    double ten = 100.0, last = 1.0;
    size_t k = x < 0.0 ? 0 : TENS * LASTS;
    for (size_t i = 0; i + 1 < TENS && fabs(x) >= ten; i++, k += LASTS) {
        ten *= 10.0;
    }
    for (size_t i = 0; i < LASTS && fabs(x) < ten; i++, last *= 0.1) {
        if (fabs(ten - last - fabs(x)) <=
            fmin(1e-7 * ten, 0.1 * last)) { // 1e-7: in single precision
            return k + i;
        }
    }
    return CODES;
}

size_t lac_series_find_code(const lac_column *c, double *code, size_t *count)
{
    size_t times[CODES + 1] = {0}, first[CODES + 1] = {0};
    double least = INFINITY, most = -INFINITY, step = 0.0, before = NAN, away = 0.0;
    for (size_t i = 0; i < c->n; i++) {
        const double x = lac_column_at(c, i);
        const size_t k = isfinite(x) ? code_of(x) : CODES;
        first[k] = times[k]++ == 0 ? i : first[k];
        if (k == CODES && isfinite(x)) {
            least = fmin(least, x);
            most = fmax(most, x);
            step = fmax(step, fabs(x - before));
            before = x;
        }
    }
    for (size_t k = 0; k < CODES; k++) {
        const double x = times[k] > 1 ? lac_column_at(c, first[k]) : NAN;
        away = isnan(before) ? fabs(x) - whole_column : fmax(least - x, x - most);
        if (away > step && away > 0.1 * fabs(x)) {
            *code = x;
            *count = times[k];
            return first[k];
        }
    }
    return c->n;
}

static lac_status check_codes(const lac_parser *p, size_t column, lac_error *err)
{
    const lac_wanted *w = &p->wanted[column];
    const lac_column c = {.n = p->count,
                          .first = &p->readings->value[column - 1],
                          .stride = sizeof *p->readings,
                          .scale = w->scale,
                          .offset = w->offset};
    double code = 0.0;
    size_t count = 0;
    const size_t at = w->name != NULL ? lac_series_find_code(&c, &code, &count) : p->count;
    LAC_FAIL_IF(at < p->count, err, LAC_EINPUT, "%s:%zu: %s: %.9g " LAC_CODE_IS, p->lines.path,
                p->readings[at].line, w->name, code, count, p->count);
    return LAC_OK;
}

// Bare numbers that are hardly seconds.

static bool is_day_in_digits(double x)
{
    const double month = floor(fmod(x, 1e4) / 100.0), day = fmod(x, 100.0);
    return x == floor(x) && month >= 1.0 && month <= 12.0 && day >= 1.0 && day <= 31.0;
}

static bool is_any(double x) { return isfinite(x); }

static const struct {
    double least, most;
    bool (*fits)(double x);
    const char *seems, *format;
} seconds_that_are_not[] = {
    {1950.0, 2100.0, is_any, "years", "decimal-year"},
    {36526.0, 51543.0, is_any, "days of Excel", "excel"}, // 2000 to 2041-02; MJD from here on 2000
    {51544.0, 62502.0, is_any, "modified Julian days", "days since 1858-11-17"},
    {19500101.0, 21000000.0, is_day_in_digits, "dates in digits", "%Y%m%d"},
    {6e11, 4.2e12, is_any, "milliseconds since 1970", "milliseconds since 1970-01-01"},
};

static lac_status check_range(const lac_parser *p, lac_error *err)
{
    for (size_t k = 0; k < sizeof seconds_that_are_not / sizeof *seconds_that_are_not; k++) {
        size_t fit = 0;
        while (fit < p->count && p->readings[fit].time >= seconds_that_are_not[k].least &&
               p->readings[fit].time <= seconds_that_are_not[k].most &&
               seconds_that_are_not[k].fits(p->readings[fit].time)) {
            fit++;
        }
        LAC_FAIL_IF(fit == p->count, err, LAC_EINPUT,
                    "%s:%zu: %s: %.10g has no unit, and seems to be of %s: --time-format \"%s\", "
                    "or s if these are seconds",
                    p->lines.path, p->readings[0].line, p->wanted[0].name, p->readings[0].time,
                    seconds_that_are_not[k].seems, seconds_that_are_not[k].format);
    }
    return LAC_OK;
}

static bool is_called_a_number(const char *name)
{
    static const char *const names[] = {
        "no",     "no.",    "nr",   "nr.",   "n",     "n.",  "#",    "id",     "index",
        "idx",    "row",    "line", "lfd",   "lfd.",  "num", "num.", "number", "nummer",
        "numero", "record", "rec",  "count", "point", "pt",  "seq",  "i"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcasecmp(name, names[i]) == 0) {
            return true;
        }
    }
    return name[0] == '\0';
}

// Whatever the column is called: numbers of rows, or of days, and hardly ever of seconds.
static lac_status check_rows(const lac_parser *p, lac_error *err)
{
    const char *name = p->wanted[0].name;
    bool counts = p->count > 1 && (p->readings[0].time == 0.0 || p->readings[0].time == 1.0);
    for (size_t i = 1; i < p->count && counts; i++) {
        counts = p->readings[i].time == p->readings[i - 1].time + 1.0;
    }
    if (!counts) {
        return LAC_OK;
    }
    LAC_FAIL_IF(p->dated_name[0] != '\0', err, LAC_EINPUT,
                "%s:%zu: %s: counts 1, 2, 3 ..., and \"%s\" holds dates: which one is the time? "
                "--time \"%s\", or --time-format s",
                p->lines.path, p->readings[0].line, name, p->dated_name, p->dated_name);
    LAC_FAIL_IF(!p->time_named && is_called_a_number(name), err, LAC_EINPUT,
                "%s:%zu: %s: counts rows: which column is the time? --time COLUMN; of this one "
                "--time-format says the unit",
                p->lines.path, p->readings[0].line, name);
    LAC_FAIL_IF(p->count >= COUNTED, err, LAC_EINPUT,
                "%s:%zu: %s: counts %.0f, %.0f, %.0f ..., and has no unit: which is it? "
                "--time-format day, hour, or s if these are seconds",
                p->lines.path, p->readings[0].line, name, p->readings[0].time, p->readings[1].time,
                p->readings[2].time);
    return LAC_OK;
}

lac_status lac_parser_check(const lac_parser *p, lac_error *err)
{
    for (size_t c = 1; c <= VALUES; c++) {
        LAC_TRY_RETURN(check_thousands(p, &p->wanted[c], err));
        LAC_TRY_RETURN(check_codes(p, c, err));
    }
    if (p->dated || !p->format.any || p->wanted[0].taken == NULL) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(check_rows(p, err));
    return check_range(p, err);
}

lac_status lac_parser_check_size(const lac_parser *p, size_t column, const char *field,
                                 double value, lac_error *err)
{
    char allowed[2 * SHOWN];
    const lac_wanted *w = &p->wanted[column];
    if (isfinite(value) && (column == OTHER || fabs(value) <= LAC_SERIES_MOST)) {
        return LAC_OK;
    }
    (void)snprintf(allowed, sizeof allowed, "is too large: at most 1e9 %s; NA where there is none",
                   w->si);
    return lac_parser_fail(p, err, w->name, field, column == OTHER ? "is too large" : allowed);
}

lac_status lac_parser_fail_empty(const lac_parser *p, lac_error *err)
{
    char names[4 * SHOWN] = "";
    for (size_t c = 1; c <= VALUES; c++) {
        char shown[SHOWN];
        if (p->wanted[c].name != NULL) {
            lac_append(names, sizeof names, "%s%s", names[0] != '\0' ? ", " : "",
                       lac_text_show(p->wanted[c].name, shown, sizeof shown));
        }
    }
    return lac_fail(err, LAC_EINPUT, "%s: %s: every reading is missing", p->lines.path, names);
}
