// SPDX-License-Identifier: GPL-3.0-or-later
// Dates of ISO 8601 to seconds since 1970 and back, without the clock and zones of the C library.
#include "base/date.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>

enum { SECONDS_A_DAY = 86400, DAYS_A_CENTURY4 = 146097, MAX_FRACTION_DIGITS = 15 };

static bool is_leap(int64_t year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

static int64_t days_in_month(int64_t year, int64_t month)
{
    static const int64_t days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return days[month - 1] + (month == 2 && is_leap(year) ? 1 : 0);
}

// Days from year 0 to the first of January of a year >= 0.
static int64_t days_before_year(int64_t year)
{
    int64_t past = year - 1; // years whose leap days lie behind, year 0 apart
    return year == 0 ? 0 : year * 365 + past / 4 - past / 100 + past / 400 + 1;
}

static int64_t days_since_1970(int64_t year, int64_t month, int64_t day)
{
    int64_t days = days_before_year(year) - days_before_year(1970);
    for (int64_t m = 1; m < month; m++) {
        days += days_in_month(year, m);
    }
    return days + day - 1;
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
    int64_t year;
    int64_t month;
    int64_t day;
    if (!read_digits(at, 4, &year) || !read_mark(at, '-') || !read_digits(at, 2, &month) ||
        !read_mark(at, '-') || !read_digits(at, 2, &day)) {
        return false;
    }
    if (month < 1 || month > 12 || day < 1 || day > days_in_month(year, month)) {
        return false;
    }
    *days = days_since_1970(year, month, day);
    return true;
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
    int64_t hour;
    int64_t minute;
    int64_t second = 0;
    double fraction = 0.0;
    if (!read_digits(at, 2, &hour) || !read_mark(at, ':') || !read_digits(at, 2, &minute)) {
        return false;
    }
    if (read_mark(at, ':')) {
        if (!read_digits(at, 2, &second)) {
            return false;
        }
        if (read_mark(at, '.') && !read_fraction(at, &fraction)) {
            return false;
        }
    }
    if (hour > 23 || minute > 59 || second > 59) {
        return false;
    }
    *seconds = (double)(hour * 3600 + minute * 60 + second) + fraction;
    return true;
}

// Z, +hh:mm, -hh:mm or nothing.
static bool read_zone(const char **at, double *offset)
{
    *offset = 0.0;
    if (**at == '\0' || read_mark(at, 'Z')) {
        return true;
    }
    double sign = **at == '-' ? -1.0 : 1.0;
    int64_t hour;
    int64_t minute;
    if (!read_mark(at, '+') && !read_mark(at, '-')) {
        return false;
    }
    if (!read_digits(at, 2, &hour) || !read_mark(at, ':') || !read_digits(at, 2, &minute)) {
        return false;
    }
    *offset = sign * (double)(hour * 3600 + minute * 60);
    return hour <= 23 && minute <= 59;
}

bool lac_date_parse(const char *text, double *seconds)
{
    const char *at = text;
    int64_t days;
    double clock = 0.0;
    double offset = 0.0;
    if (!read_day(&at, &days)) {
        return false;
    }
    if (*at != '\0') {
        if (!read_mark(&at, 'T') && !read_mark(&at, ' ')) {
            return false;
        }
        if (!read_clock(&at, &clock) || !read_zone(&at, &offset)) {
            return false;
        }
    }
    if (*at != '\0') {
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
    int64_t day = since_0 / SECONDS_A_DAY;
    int64_t clock = since_0 % SECONDS_A_DAY;
    int64_t year = day * 400 / DAYS_A_CENTURY4; // right or one too many
    while (days_before_year(year) > day) {
        year--;
    }
    while (days_before_year(year + 1) <= day) {
        year++;
    }
    day -= days_before_year(year);
    int64_t month = 1;
    while (day >= days_in_month(year, month)) {
        day -= days_in_month(year, month++);
    }
    (void)snprintf(text, size, "%04d-%02d-%02dT%02d:%02d:%02dZ", (int)year, (int)month,
                   (int)day + 1, (int)(clock / 3600), (int)(clock / 60 % 60), (int)(clock % 60));
    return text;
}
