// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/date.h"
#include "series/text.h"
#include "support/test.h"

static void known_dates_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double seconds;
    } known[] = {
        {"1970-01-01", 0.0},
        {"1970-01-01T00:00:00Z", 0.0},
        {"1963-10-09T22:39", -196564860.0},
        {"1963-10-09 22:39:00Z", -196564860.0},
        {"1963-10-09T23:39:00+01:00", -196564860.0},
        {"1963-10-09T17:09:00-05:30", -196564860.0},
        {"2000-02-29", 951782400.0},
        {"2000-02-29T12:00:00.25Z", 951825600.25},
        {"0000-01-01", -62167219200.0},
        {"9999-12-31T23:59:59Z", 253402300799.0},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        double seconds = NAN;
        assert_true(lac_date_parse(known[i].text, &seconds));
        assert_true(seconds == known[i].seconds);
    }
}

static void what_is_no_date_is_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        "",
        "1963",
        "1963-10",
        "63-10-09",
        "1963-13-01",
        "1963-00-01",
        "1963-02-29",
        "1900-02-29",
        "2000-02-30",
        "1963-10-00",
        "1963-10-09T",
        "1963-10-09T22",
        "1963-10-09T24:00",
        "1963-10-09T22:60",
        "2016-12-31T23:59:60Z",
        "1963-10-09T22:39:05.",
        "1963-10-09T22:39:05.2x",
        "1963-10-09T22:39:05ZZ",
        "1963-10-09T22:39+1:00",
        "1963-10-09T22:39+24:00",
        "1963-10-09T22:39+01:60",
        "1963-10-09Z",
        " 1963-10-09",
        "1963-10-09 ",
        "1963/10/09",
        "-963-10-09",
        "1963-1\xd9\xa0-09",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        double seconds = 7.0;
        assert_false(lac_date_parse(wrong[i], &seconds));
        assert_true(seconds == 7.0);
    }
}

static void agrees_with_the_calendar_of_libc(void **state)
{
    (void)state;
    uint64_t random = 88172645463325252u;
    for (int i = 0; i < 20000; i++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        time_t t = (time_t)((int64_t)(random >> 20) % 253402300799 * (i % 5 == 0 ? -1 : 1));
        if (t < -62167219200) {
            continue;
        }
        struct tm parts;
        char expected[64];
        char text[64];
        assert_non_null(gmtime_r(&t, &parts));
        (void)snprintf(expected, sizeof expected, "%04d-%02d-%02dT%02d:%02d:%02dZ",
                       parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday, parts.tm_hour,
                       parts.tm_min, parts.tm_sec);
        assert_string_equal(lac_date_format((double)t, text, sizeof text), expected);
        double back;
        assert_true(lac_date_parse(text, &back));
        assert_true(back == (double)t);
    }
}

static void what_does_not_fit_is_empty(void **state)
{
    (void)state;
    char text[21];
    assert_string_equal(lac_date_format(0.4, text, sizeof text), "1970-01-01T00:00:00Z");
    assert_string_equal(lac_date_format(0.6, text, sizeof text), "1970-01-01T00:00:01Z");
    assert_string_equal(lac_date_format(0.0, text, 20), "");
    assert_string_equal(lac_date_format(NAN, text, sizeof text), "");
    assert_string_equal(lac_date_format(INFINITY, text, sizeof text), "");
    assert_string_equal(lac_date_format(253402300800.0, text, sizeof text), "");
    assert_string_equal(lac_date_format(-62167219201.0, text, sizeof text), "");
}

// Every mark of a pattern, on the 29th of February 2024 and on days that are not.
static void patterns_are_followed(void **state)
{
    (void)state;
    static const struct {
        const char *pattern, *text;
        double seconds; // NAN: refused
    } cases[] = {
        {"%d.%m.%Y %H:%M:%S", "29.02.2024 06:07:08.25", 1709186828.25},
        {"%d.%m.%Y %H:%M:%S", "29.2.2024\t06:07:08,375", 1709186828.375},
        {"%d.%m.%Y %H:%M:%S", "29.02.2024 06:07:60", NAN},
        {"%d.%m.%Y %H:%M:%S", "29.02.2024 06:07:08.", NAN},
        {"%y-%j %I:%M:%S %p %z", "24-060 06:07:08 PM +0200", 1709222828.0},
        {"%y-%j %I:%M:%S %p %z", "24-060 4:07:08 pm Z", 1709222828.0},
        {"%y-%j %I:%M:%S %p %z", "24-060 13:07:08 PM Z", NAN},
        {"%Y%b%d %I%p", "2024Feb29 12AM", 1709164800.0},
        {"%y%b%d %I%p", "71DEC31 12pm", 63028800.0},
        {"%Y/%j", "2023/365", 1703980800.0},
        {"%Y/%j", "2023/366", NAN},
        {"%Y/%j", "2000/366", 978220800.0},
        {"%Y/%j", "2100/366", NAN},
        {"%%%Y/%j", "%2023/365", 1703980800.0},
        {"%%%Y/%j", "2023/365", NAN},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double seconds = NAN;
        bool dated = false;
        lac_time_format format;
        assert_int_equal(lac_time_format_read(cases[i].pattern, NULL, &format, NULL), LAC_OK);
        bool taken = lac_time_format_take(&format, cases[i].text, '.', &seconds, &dated);
        if (taken != !isnan(cases[i].seconds) || (taken && seconds != cases[i].seconds)) {
            fail_msg("%s, %s: %.17g", cases[i].pattern, cases[i].text, seconds);
        }
    }
    const char *const wrong[] = {"%% %H", "%Y/%j %%%Y", "%Y/%j %q", "%Y/%j %"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        lac_time_format format;
        assert_int_equal(lac_time_format_read(wrong[i], NULL, &format, NULL), LAC_EINPUT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_dates_are_read),
        cmocka_unit_test(what_is_no_date_is_refused),
        cmocka_unit_test(agrees_with_the_calendar_of_libc),
        cmocka_unit_test(what_does_not_fit_is_empty),
        cmocka_unit_test(patterns_are_followed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
