// SPDX-License-Identifier: GPL-3.0-or-later
#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "support/test.h"

static int open_units(void **state)
{
    lac_error err;
    return lac_units_create((lac_units **)state, &err) == LAC_OK ? 0 : -1;
}

static int close_units(void **state)
{
    lac_units_free(*state);
    return 0;
}

static void quantities_become_si(void **state)
{
    static const struct {
        const char *text, *unit;
        double value;
    } known[] = {
        {"3 km/s", "m/s", 3e3},
        {"1 cm/week", "m/s", 0.01 / 604800.0},
        {"0.1 mm", "m", 1e-4},
        {"-0.1 mm", "m", -1e-4},
        {"  2 mm ", "m", 2e-3},
        {"2mm", "m", 2e-3},
        {"200 day", "s", 200.0 * 86400.0},
        {"2 year", "s", 2.0 * 31556925.9747},
        {"20 GPa", "Pa", 2e10},
        {"1e-6 m/s", "m/s", 1e-6},
        {"1 m s-1", "m/s", 1.0},
        {"1 m.s^-1", "m/s", 1.0},
        {"5 um/s", "m/s", 5e-6},
        {"3 \xc2\xb5m", "m", 3e-6},
        {"3 \xce\xbcm", "m", 3e-6},
        {"1 ft", "m", 0.3048},
        {"1 bar", "Pa", 1e5},
        {"2700 kg/m3", "kg/m3", 2700.0},
        {"2.7 t/m3", "kg/m3", 2700.0},
        {"4 MPa/mm", "Pa/m", 4e9},
        {"1 kPa/day", "Pa/s", 1e3 / 86400.0},
        {"180 degree", "rad", 3.14159265358979},
        {"30 \xc2\xb0", "rad", 0.523598775598298},
        {"0.5 rad", "rad", 0.5},
        {"0.5", "rad", 0.5},
        {"12 %", "1", 0.12},
        {"1 mm/m", "1", 1e-3},
        {"0.25", "1", 0.25},
        {"+.5", "1", 0.5},
        {"5.", "1", 5.0},
        {"1e3", "Pa", 1e3},
        {"1E+3", "Pa", 1e3},
        {"0", "m", 0.0},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        lac_error err = {""};
        double value = NAN;
        if (lac_units_parse(*state, known[i].text, known[i].unit, &value, &err) != LAC_OK) {
            fail_msg("\"%s\": %s", known[i].text, err.message);
        }
        if (!(fabs(value - known[i].value) <= 1e-13 * fabs(known[i].value))) {
            fail_msg("\"%s\" is read as %.17g, not %.17g", known[i].text, value, known[i].value);
        }
    }
}

static const struct {
    const char *text, *unit, *message;
} refused[] = {
    {"", "m", "must be a length such as \"1 m\""},
    {"   ", "m", "must be a length such as \"1 m\""},
    {"m", "m", "must be a length such as \"1 m\""},
    {"3 MPa", "m", "must be a length such as \"1 m\""},
    {"3 m", "Pa", "must be a pressure such as \"1 MPa\""},
    {"3 m x", "m", "must be a length such as \"1 m\""},
    {"3 m 2", "m", "must be a length such as \"1 m\""},
    {"3 10 m", "m", "must be a length such as \"1 m\""},
    {"3 m/", "m", "must be a length such as \"1 m\""},
    {"3 /m", "m", "must be a length such as \"1 m\""},
    {"3 m**", "m", "must be a length such as \"1 m\""},
    {"3 m1.5", "m", "must be a length such as \"1 m\""},
    {"1 MPa m0.5", "Pa", "must be a pressure such as \"1 MPa\""},
    {"1 m^999", "m", "must be a length such as \"1 m\""},
    {"3 lg(re 1 m)", "m", "must be a length such as \"1 m\""},
    {"0x10", "1", "must be a number such as 0.5"},
    {"0.6x", "1", "must be a number such as 0.5"},
    {"1,5", "1", "must be a number such as 0.5"},
    {"nan", "1", "must be a number such as 0.5"},
    {"inf", "1", "must be a number such as 0.5"},
    {"-inf", "1", "must be a number such as 0.5"},
    {"true", "1", "must be a number such as 0.5"},
    {"--1", "1", "must be a number such as 0.5"},
    {".", "1", "must be a number such as 0.5"},
    {"e5", "1", "must be a number such as 0.5"},
    {"30 degree", "1", "must be a number such as 0.5"},
    {"2 rad", "1", "must be a number such as 0.5"},
    {"50 %", "rad", "must be an angle such as \"30 degree\""},
    {"30 deg", "rad", "must be an angle such as \"30 degree\""},
    {"1e400", "1", "must be a number such as 0.5; the number cannot be represented"},
    {"1e308 km", "m", "must be a length such as \"1 m\"; the number cannot be represented"},
    {"1e-400", "1", "must be a number such as 0.5; the number cannot be represented"},
    {"1 mm/a", "m/s",
     "must be a speed such as \"1 mm/day\"; \"a\" is the are, an area: write year"},
    {"1 mm/month", "m/s",
     "must be a speed such as \"1 mm/day\"; a month has no fixed length: write days"},
    {"3 months", "s", "must be a time such as \"1 day\"; a month has no fixed length: write days"},
    {"1 mm/dday", "m/s",
     "must be a speed such as \"1 mm/day\"; days, hours, minutes and weeks take no prefix"},
    {"1 kday", "s",
     "must be a time such as \"1 day\"; days, hours, minutes and weeks take no prefix"},
    {"1 ton/m3", "kg/m3",
     "must be a density such as \"2700 kg/m3\"; \"ton\" is ambiguous: write tonne"},
    {"1 s since 1970-01-01", "s",
     "must be a time such as \"1 day\"; a unit is needed, not a point in time"},
    {"3 m\tx", "m", "must be a length such as \"1 m\""},
    {"3 \xff", "m", "must be a length such as \"1 m\""},
};

static void what_is_no_such_quantity_is_refused(void **state)
{
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        lac_error err = {""};
        double value = 7.0;
        if (lac_units_parse(*state, refused[i].text, refused[i].unit, &value, &err) != LAC_EINPUT) {
            fail_msg("\"%s\" is accepted as %g %s", refused[i].text, value, refused[i].unit);
        }
        assert_string_equal(err.message, refused[i].message);
        assert_true(value == 7.0);
    }
}

static void a_long_text_is_refused(void **state)
{
    char text[5000] = "1 ";
    for (size_t i = 2; i + 2 < sizeof text; i += 2) {
        memcpy(text + i, "m ", 3);
    }
    double value;
    lac_error err;
    assert_int_equal(lac_units_parse(*state, text, "m", &value, &err), LAC_EINPUT);
}

static void columns_convert(void **state)
{
    double scale;
    double offset;
    lac_error err;
    assert_int_equal(lac_units_convert(*state, "mm/day", "m/s", &scale, &offset, &err), LAC_OK);
    assert_true(fabs(scale * 86400.0 * 1e3 - 1.0) < 1e-14 && offset == 0.0);
    assert_int_equal(lac_units_convert(*state, "degC", "K", &scale, &offset, &err), LAC_OK);
    assert_true(fabs(scale - 1.0) < 1e-12 && fabs(offset - 273.15) < 1e-12);
    assert_int_equal(lac_units_convert(*state, "mm", "m/s", &scale, &offset, &err), LAC_EINPUT);
    assert_int_equal(lac_units_convert(*state, "", "m", &scale, &offset, &err), LAC_EINPUT);
    assert_int_equal(lac_units_convert(*state, "mm/a", "m/s", &scale, &offset, &err), LAC_EINPUT);
}

static void values_are_written_readably(void **state)
{
    static const struct {
        double value;
        const char *unit, *text;
    } known[] = {
        {3e6, "Pa", "3 MPa"},
        {2e10, "Pa", "20 GPa"},
        {12.0, "Pa", "12 Pa"},
        {1e-4, "m", "100 um"},
        {1e-3, "m", "1 mm"},
        {0.01 / 604800.0, "m/s", "1 cm/week"},
        {1e-6, "m/s", "1 um/s"},
        {1.0, "m/s", "1 m/s"},
        {3000.0, "m/s", "3 km/s"},
        {12.5 * 86400.0, "s", "12.5 day"},
        {200.0 * 86400.0, "s", "200 day"},
        {2.0 * 31556925.9747, "s", "2 year"},
        {90.0, "s", "1.5 min"},
        {0.523598775598299, "rad", "30 degree"},
        {2700.0, "kg/m3", "2700 kg/m3"},
        {0.25, "1", "0.25"},
        {0.0, "m", "0 m"},
        {-2e3, "m", "-2 km"},
        {1e-15, "m", "1e-06 nm"},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        char text[64];
        assert_string_equal(lac_units_format(known[i].value, known[i].unit, text, sizeof text),
                            known[i].text);
    }
    static const char *const units[] = {"m", "s", "Pa", "m/s", "Pa/m", "Pa/s", "N", "rad", "1"};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        for (double x = 1.2345e-18; x < 1e18; x *= 3.7) {
            char text[64];
            double back = NAN;
            lac_units_format(x, units[i], text, sizeof text);
            assert_int_equal(lac_units_parse(*state, text, units[i], &back, NULL), LAC_OK);
            assert_true(fabs(back - x) <= 1e-5 * x);
        }
    }
}

static void the_locale_does_not_matter(void **state)
{
    static const char *const locales[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"};
    bool found = false;
    for (size_t i = 0; i < sizeof locales / sizeof locales[0] && !found; i++) {
        found = setlocale(LC_NUMERIC, locales[i]) != NULL;
    }
    if (!found) {
        skip();
    }
    double value = NAN;
    char text[32];
    assert_int_equal(lac_units_parse(*state, "0.25 km", "m", &value, NULL), LAC_OK);
    assert_true(value == 250.0);
    assert_string_equal(lac_units_format(0.25, "1", text, sizeof text), "0.25");
    (void)setlocale(LC_NUMERIC, "C");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantities_become_si),
        cmocka_unit_test(what_is_no_such_quantity_is_refused),
        cmocka_unit_test(a_long_text_is_refused),
        cmocka_unit_test(columns_convert),
        cmocka_unit_test(values_are_written_readably),
        cmocka_unit_test(the_locale_does_not_matter),
    };
    return cmocka_run_group_tests(tests, open_units, close_units);
}
