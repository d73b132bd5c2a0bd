// SPDX-License-Identifier: GPL-3.0-or-later
// Times as files write them, dates by a pattern or numbers since a date, made into seconds.
#include <ctype.h>
#include <strings.h>

#include "base/date.h"
#include "base/units.h"
#include "series/text.h"

enum { ZONE = 8, SHORT_YEARS = 69, SHORTEST_DATE = 6, LONGEST_DATE = 32 };

// What a pattern takes from a field.
typedef struct lac_clock {
    int year, month, day, day_of_year, hour, minute;
    double second;
    int afternoon; // -1: 24 hours
    bool twelve;   // hours go to 12
    char zone[ZONE];
} lac_clock;

static const char marks[] = "YmdyjbHIMSpz";

// Every mark once at most, a year, and either month and day or the day of the year.
static const char *pattern_fault(const char *pattern)
{
    char seen[sizeof marks] = "";
    for (const char *at = pattern; *at != '\0'; at++) {
        if (*at != '%') {
            continue;
        }
        at++;
        if (*at == '%') {
            continue;
        }
        const char *mark = *at != '\0' ? strchr(marks, *at) : NULL;
        if (mark == NULL || strchr(seen, *at) != NULL) {
            return "must have each of %Y %m %d %y %b %j %H %I %M %S %p %z once";
        }
        seen[strlen(seen)] = *at;
    }
    bool year = strchr(seen, 'Y') != NULL || strchr(seen, 'y') != NULL;
    bool month = strchr(seen, 'm') != NULL || strchr(seen, 'b') != NULL;
    const bool by_month = month && strpbrk(seen, "djHIMS") == NULL;
    bool day = strchr(seen, 'd') != NULL && month;
    return year && (day || by_month || strchr(seen, 'j') != NULL)
               ? NULL
               : "must have a year, a month and a day, or a year and a month alone";
}

// What a pattern writes of 31 December 2015, 14:05:09.
static void write_example(const char *pattern, char *text, size_t size)
{
    static const char *const parts[] = {"2015", "12", "31", "15", "365", "Dec",
                                        "14",   "02", "05", "09", "PM",  "+01:00"};
    size_t used = 0;
    text[0] = '\0';
    for (; *pattern != '\0' && used + 1 < size; pattern++) {
        const char *mark = *pattern == '%' ? strchr(marks, pattern[1]) : NULL;
        pattern += *pattern == '%' ? 1 : 0;
        const int n = mark != NULL ? snprintf(text + used, size - used, "%s", parts[mark - marks])
                                   : snprintf(text + used, size - used, "%c", *pattern);
        used += (size_t)n;
    }
}

static lac_status read_numeric(const char *text, const struct lac_units *units,
                               lac_time_format *out, lac_error *err)
{
    if (strcasecmp(text, "decimal-year") == 0) {
        out->decimal_year = out->dated = true;
        (void)snprintf(out->allowed, sizeof out->allowed, "must be a year like 2015.4932");
        return LAC_OK;
    }
    const char *unit = strcasecmp(text, "unix") == 0    ? "seconds since 1970-01-01 00:00:00 UTC"
                       : strcasecmp(text, "excel") == 0 ? "days since 1899-12-30 00:00:00 UTC"
                                                        : text;
    (void)snprintf(out->allowed, sizeof out->allowed, "must be a number (%.40s)", unit);
    (void)snprintf(out->unit, sizeof out->unit, "%s", strlen(unit) < sizeof out->unit ? unit : "");
    lac_status status = lac_units_time(units, unit, &out->scale, &out->offset, &out->dated, err);
    LAC_FAIL_IF(
        status == LAC_EINPUT, err, LAC_EINPUT,
        "time format \"%s\" must be iso, unix, excel, decimal-year, a pattern like \"%%d/%%m/%%Y "
        "%%H:%%M\", or a unit like \"days since 2015-06-07\"",
        text);
    return status;
}

lac_status lac_time_format_read(const char *text, const struct lac_units *units,
                                lac_time_format *out, lac_error *err)
{
    *out = (lac_time_format){.scale = 1.0, .unit = "s"};
    if (text == NULL || strcasecmp(text, "iso") == 0) {
        out->any = true;
        (void)snprintf(out->allowed, sizeof out->allowed,
                       "must be a date like 1963-10-09 or 1963-10-09T22:39:00Z, or seconds");
        return LAC_OK;
    }
    if (strchr(text, '%') == NULL) {
        return read_numeric(text, units, out, err);
    }
    char example[40];
    const char *fault = pattern_fault(text);
    LAC_FAIL_IF(fault != NULL, err, LAC_EINPUT, "time format \"%s\" %s", text, fault);
    out->pattern = text;
    out->monthly = strstr(text, "%d") == NULL && strstr(text, "%j") == NULL;
    write_example(text, example, sizeof example);
    (void)snprintf(out->allowed, sizeof out->allowed, "must be a date written as %.48s, like %s",
                   text, example);
    return LAC_OK;
}

static bool take_digits(const char **at, int most, int *value)
{
    int n = 0;
    *value = 0;
    for (; n < most && isdigit((unsigned char)**at); n++) {
        *value = *value * 10 + (*(*at)++ - '0');
    }
    return n > 0;
}

static bool take_second(const char **at, double *second)
{
    int whole = 0;
    double place = 0.1;
    if (!take_digits(at, 2, &whole)) {
        return false;
    }
    *second = whole;
    if ((**at == '.' || **at == ',') && isdigit((unsigned char)(*at)[1])) {
        for ((*at)++; isdigit((unsigned char)**at); (*at)++, place /= 10) {
            *second += place * (**at - '0');
        }
    }
    return true;
}

static bool take_month_name(const char **at, int *month)
{
    static const char names[] = "janfebmaraprmayjunjulaugsepoctnovdec";
    for (*month = 1; *month <= 12; (*month)++) {
        if (strncasecmp(*at, names + (ptrdiff_t)3 * (*month - 1), 3) == 0) {
            *at += 3;
            return true;
        }
    }
    return false;
}

static bool take_half_day(const char **at, int *afternoon)
{
    bool known = strncasecmp(*at, "am", 2) == 0 || strncasecmp(*at, "pm", 2) == 0;
    *afternoon = tolower((unsigned char)**at) == 'p';
    *at += known ? 2 : 0;
    return known;
}

// Z, +hh:mm or +hhmm, written as ISO 8601 has it.
static bool take_zone(const char **at, char zone[ZONE])
{
    int digit[4];
    if (**at == 'Z') {
        (*at)++;
        (void)snprintf(zone, ZONE, "Z");
        return true;
    }
    char sign = **at;
    if (sign != '+' && sign != '-') {
        return false;
    }
    (*at)++;
    for (int i = 0; i < 4; i++) {
        *at += i == 2 && **at == ':' ? 1 : 0;
        if (!isdigit((unsigned char)**at)) {
            return false;
        }
        digit[i] = *(*at)++ - '0';
    }
    (void)snprintf(zone, ZONE, "%c%d%d:%d%d", sign, digit[0] % 10, digit[1] % 10, digit[2] % 10,
                   digit[3] % 10);
    return true;
}

static bool take_short_year(const char **at, int *year)
{
    bool known = take_digits(at, 2, year);
    *year += *year < SHORT_YEARS ? 2000 : 1900;
    return known;
}

static bool take_mark(char mark, const char **at, lac_clock *c)
{
    switch (mark) {
    case 'Y':
        *at += strspn(*at, "0123456789") >= 4 ? 0 : strlen(*at); // "15" is not the year 15
        return take_digits(at, 4, &c->year);
    case 'y':
        return take_short_year(at, &c->year);
    case 'm':
        return take_digits(at, 2, &c->month);
    case 'b':
        return take_month_name(at, &c->month);
    case 'd':
        return take_digits(at, 2, &c->day);
    case 'j':
        return take_digits(at, 3, &c->day_of_year) && c->day_of_year > 0;
    case 'I':
        c->twelve = true;
        return take_digits(at, 2, &c->hour) && c->hour >= 1 && c->hour <= 12;
    case 'H':
        return take_digits(at, 2, &c->hour);
    case 'M':
        return take_digits(at, 2, &c->minute);
    case 'S':
        return take_second(at, &c->second);
    case 'p':
        return take_half_day(at, &c->afternoon);
    default:
        return take_zone(at, c->zone);
    }
}

static bool match(const char *pattern, const char *at, lac_clock *c)
{
    for (; *pattern != '\0'; pattern++) {
        if (*pattern == '%' && pattern[1] != '%') {
            if (!take_mark(*++pattern, &at, c)) {
                return false;
            }
        } else if (*pattern == ' ') {
            if (*at != ' ' && *at != '\t') {
                return false;
            }
            at += strspn(at, " \t");
        } else {
            pattern += *pattern == '%' ? 1 : 0;
            if (*at++ != *pattern) {
                return false;
            }
        }
    }
    return *at == '\0';
}

// Through ISO 8601, which knows the calendar.
static bool day_seconds(const lac_clock *c, double *seconds)
{
    char iso[96];
    int hour = c->twelve && c->afternoon >= 0 ? c->hour % 12 + 12 * c->afternoon : c->hour;
    bool by_day = c->day_of_year > 0;
    (void)snprintf(iso, sizeof iso, "%04d-%02d-%02dT%02d:%02d:00%s", c->year, by_day ? 1 : c->month,
                   by_day ? 1 : c->day, hour, c->minute, c->zone);
    if (!lac_date_parse(iso, seconds) || c->second >= 60) {
        return false;
    }
    if (by_day) {
        bool leap = (c->year % 4 == 0 && c->year % 100 != 0) || c->year % 400 == 0;
        *seconds += 86400.0 * (c->day_of_year - 1);
        if (c->day_of_year > (leap ? 366 : 365)) {
            return false;
        }
    }
    *seconds += c->second;
    return true;
}

// Of a month without a day its middle, from which no day is further than half a month.
static bool clock_seconds(const lac_clock *c, bool monthly, double *seconds)
{
    lac_clock first = *c, next = *c;
    double end = 0.0;
    if (!monthly) {
        return day_seconds(c, seconds);
    }
    first.day = next.day = 1;
    next.year += c->month == 12 ? 1 : 0;
    next.month = c->month % 12 + 1;
    if (!day_seconds(&first, seconds) || !day_seconds(&next, &end)) {
        return false;
    }
    *seconds = 0.5 * (*seconds + end);
    return true;
}

// Years and the part of the year that is over, as 2015.5: of 365 days or 366.
static bool year_seconds(double year, double *seconds)
{
    const lac_clock first = {.year = (int)floor(year), .month = 1, .day = 1};
    const lac_clock next = {.year = first.year + 1, .month = 1, .day = 1};
    double end = 0.0;
    if (!(year >= 1000.0 && year < 9999.0) || !day_seconds(&first, seconds) ||
        !day_seconds(&next, &end)) {
        return false;
    }
    *seconds += (year - first.year) * (end - *seconds);
    return true;
}

size_t lac_time_format_guess(const char *field, size_t most, char guess[][LAC_TIME_GUESS])
{
    static const char *const days[] = {"%d/%m/%Y", "%m/%d/%Y", "%d.%m.%Y", "%Y/%m/%d", "%d-%m-%Y",
                                       "%m-%d-%Y", "%Y.%m.%d", "%Y%m%d",   "%d %b %Y", "%d-%b-%Y",
                                       "%d/%m/%y", "%m/%d/%y", "%d.%m.%y", "%d-%b-%y", "%Y-%m-%d",
                                       "%Y/%m",    "%Y-%m",    "%m/%Y",    "%m.%Y",    "%b %Y"};
    static const char *const clocks[] = {"",          " %H:%M",    " %H:%M:%S", "T%H:%M",
                                         "T%H:%M:%S", " %H.%M",    " %I:%M %p", " %I:%M:%S %p",
                                         "%H%M%S",    " %H.%M.%S", "_%H%M%S"};
    size_t found = 0;
    const size_t length = strlen(field);
    if (length < SHORTEST_DATE || length > LONGEST_DATE || strpbrk(field, "0123456789") == NULL) {
        return 0;
    }
    for (size_t i = 0; i < sizeof days / sizeof *days * (sizeof clocks / sizeof *clocks); i++) {
        double ignored;
        lac_clock c = {.afternoon = -1};
        const char *day = days[i / (sizeof clocks / sizeof *clocks)];
        const char *clock = clocks[i % (sizeof clocks / sizeof *clocks)];
        const bool monthly = strpbrk(day, "dj") == NULL;
        if (found == most || (monthly && *clock != '\0')) {
            continue;
        }
        (void)snprintf(guess[found], LAC_TIME_GUESS, "%s%s", day, clock);
        found += match(guess[found], field, &c) && clock_seconds(&c, monthly, &ignored) ? 1 : 0;
    }
    return found;
}

bool lac_time_format_zoned(const lac_time_format *format, const char *field)
{
    enum { LONG = 6, SHORT = 3 }; // of "+01:00"
    const size_t n = strlen(field);
    if (format->pattern != NULL) {
        return strstr(format->pattern, "%z") != NULL;
    }
    if (!format->any) { // numbers since long ago are a spreadsheet's, whose zone nobody knows
        return format->offset >= 0.0 && !format->decimal_year;
    }
    return n > LONG && (field[n - 1] == 'Z' || (field[n - SHORT] == ':' && field[n - LONG] != 'T' &&
                                                field[n - LONG] != ' ' && field[n - LONG] != ':'));
}

bool lac_time_format_take(const lac_time_format *format, const char *field, char mark,
                          double *seconds, bool *dated)
{
    if (format->pattern != NULL) {
        lac_clock c = {.afternoon = -1};
        *dated = true;
        return match(format->pattern, field, &c) && clock_seconds(&c, format->monthly, seconds);
    }
    *dated = format->any ? lac_date_parse(field, seconds) : format->dated;
    if (format->any && *dated) {
        return true;
    }
    if (!lac_text_number(field, mark, seconds)) {
        return false;
    }
    if (format->decimal_year) {
        return year_seconds(*seconds, seconds);
    }
    *seconds = format->scale * *seconds + format->offset;
    return isfinite(*seconds);
}
