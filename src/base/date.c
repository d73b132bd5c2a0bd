// SPDX-License-Identifier: GPL-3.0-or-later
// Dates of ISO 8601 to seconds since 1970 and back, without the clock and zones of the C library.
#include "base/date.h"

#include <ctype.h>

enum { SECONDS_A_DAY = 86400, DAYS_A_CENTURY4 = 146097, MAX_FRACTION_DIGITS = 15 };
enum { SINCE_0 = 719468, MONTHS_5 = 153 }; // days to 1970, and of five months from March on

// Years that begin in March have their leap day last. The calendar is older than year 0 by 400
// years, so that nothing is divided below 0.
static int64_t days_since_1970(int64_t year, int64_t month, int64_t day)
{
    const int64_t y = year + 400 - (month < 3 ? 1 : 0);
    const int64_t of_year = (MONTHS_5 * ((month + 9) % 12) + 2) / 5 + day - 1;
    return y * 365 + y / 4 - y / 100 + y / 400 + of_year - DAYS_A_CENTURY4 - SINCE_0;
}

static void date_of(int64_t days, int64_t *year, int64_t *month, int64_t *day)
{
    const int64_t all = days + SINCE_0 + DAYS_A_CENTURY4;
    const int64_t of_400 = all % DAYS_A_CENTURY4; // the last day of 4, 100 and 400 years is theirs
    const int64_t y =
        (of_400 - of_400 / 1460 + of_400 / 36524 - of_400 / (DAYS_A_CENTURY4 - 1)) / 365;
    const int64_t of_year = of_400 - (y * 365 + y / 4 - y / 100);
    const int64_t m = (5 * of_year + 2) / MONTHS_5;
    *day = of_year - (MONTHS_5 * m + 2) / 5 + 1;
    *month = m < 10 ? m + 3 : m - 9;
    *year = y + all / DAYS_A_CENTURY4 * 400 - 400 + (*month < 3 ? 1 : 0);
}

// Exactly n digits.
static bool read_digits(const char **at, int n, int64_t *value)
{
    *value = 0;
    for (int i = 0; i < n; i++) {
        if (!isdigit((unsigned char)(*at)[i])) {
            return false;
        }
        *value = *value * 10 + ((*at)[i] - '0');
    }
    *at += n;
    return true;
}

static bool read_mark(const char **at, char mark)
{
    if (**at != mark) {
        return false;
    }
    (*at)++;
    return true;
}

static bool read_day(const char **at, int64_t *days)
{
    int64_t year, month, day, same[3];
    if (!read_digits(at, 4, &year) || !read_mark(at, '-') || !read_digits(at, 2, &month) ||
        !read_mark(at, '-') || !read_digits(at, 2, &day)) {
        return false;
    }
    *days = days_since_1970(year, month, day);
    date_of(*days, &same[0], &same[1], &same[2]); // another where there is no such day
    return month >= 1 && same[0] == year && same[1] == month && same[2] == day;
}

// Digits after the point; those that no double holds are read over.
static bool read_fraction(const char **at, double *fraction)
{
    int64_t digits = 0;
    double scale = 1.0;
    const char *start = *at;
    for (; isdigit((unsigned char)**at); (*at)++) {
        if (*at - start < MAX_FRACTION_DIGITS) {
            digits = digits * 10 + (**at - '0');
            scale *= 10.0;
        }
    }
    *fraction = (double)digits / scale;
    return *at > start;
}

// hh:mm[:ss[.fraction]]; a leap second (:60) is refused: seconds since 1970 have none.
static bool read_clock(const char **at, double *seconds)
{
    int64_t hour, minute, second = 0;
    double fraction = 0.0;
    if (!read_digits(at, 2, &hour) || !read_mark(at, ':') || !read_digits(at, 2, &minute)) {
        return false;
    }
    if (read_mark(at, ':') &&
        (!read_digits(at, 2, &second) || (read_mark(at, '.') && !read_fraction(at, &fraction)))) {
        return false;
    }
    *seconds = (double)(hour * 3600 + minute * 60 + second) + fraction;
    return hour <= 23 && minute <= 59 && second <= 59;
}

// Z, +hh:mm, -hh:mm or nothing.
static bool read_zone(const char **at, double *offset)
{
    *offset = 0.0;
    if (**at == '\0' || read_mark(at, 'Z')) {
        return true;
    }
    double sign = **at == '-' ? -1.0 : 1.0;
    int64_t hour, minute;
    if ((!read_mark(at, '+') && !read_mark(at, '-')) || !read_digits(at, 2, &hour) ||
        !read_mark(at, ':') || !read_digits(at, 2, &minute)) {
        return false;
    }
    *offset = sign * (double)(hour * 3600 + minute * 60);
    return hour <= 23 && minute <= 59;
}

bool lac_date_parse(const char *text, double *seconds)
{
    const char *at = text;
    int64_t days;
    double clock = 0.0, offset = 0.0;
    if (!read_day(&at, &days)) {
        return false;
    }
    const char *day = at; // ends here
    const bool timed = (read_mark(&at, 'T') || read_mark(&at, ' ')) && read_clock(&at, &clock) &&
                       read_zone(&at, &offset);
    if (*at != '\0' || (at > day && !timed)) {
        return false;
    }
    *seconds = (double)(days * SECONDS_A_DAY) + clock - offset;
    return true;
}

const char *lac_date_format(double seconds, char *text, size_t size)
{
    double rounded = floor(seconds + 0.5);
    double first = (double)days_since_1970(0, 1, 1) * SECONDS_A_DAY;
    double end = (double)days_since_1970(10000, 1, 1) * SECONDS_A_DAY;
    if (size > 0) {
        text[0] = '\0';
    }
    if (size < sizeof "YYYY-MM-DDThh:mm:ssZ" || !(rounded >= first && rounded < end)) {
        return size > 0 ? text : "";
    }
    int64_t since_0 = (int64_t)(rounded - first);
    int64_t clock = since_0 % SECONDS_A_DAY;
    int64_t year, month, day;
    date_of(since_0 / SECONDS_A_DAY + days_since_1970(0, 1, 1), &year, &month, &day);
    (void)snprintf(text, size, "%04d-%02d-%02dT%02d:%02d:%02dZ", (int)year, (int)month, (int)day,
                   (int)(clock / 3600), (int)(clock / 60 % 60), (int)(clock % 60));
    return text;
}
