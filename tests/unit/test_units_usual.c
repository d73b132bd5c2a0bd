// SPDX-License-Identifier: GPL-3.0-or-later
// The usual units against UDUNITS itself, and that they need nothing of its database.
#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>
#include <unistd.h>

#include "base/units.h"
#include "support/test.h"

static bool same_bits(double a, double b)
{
    uint64_t bits[2];
    memcpy(&bits[0], &a, sizeof a);
    memcpy(&bits[1], &b, sizeof b);
    return bits[0] == bits[1];
}

static void their_factors_are_those_of_udunits(void **state)
{
    (void)state;
    size_t count = 0;
    const lac_usual_unit *usual = lac_units_usual(&count);
    (void)ut_set_error_message_handler(ut_ignore);
    ut_system *system = ut_read_xml(NULL);
    assert_non_null(system);
    assert_true(count > 50);
    for (size_t i = 0; i < count; i++) {
        ut_unit *from = ut_parse(system, usual[i].from, UT_UTF8);
        ut_unit *to = ut_parse(system, usual[i].to, UT_UTF8);
        cv_converter *converter = from != NULL && to != NULL ? ut_get_converter(from, to) : NULL;
        if (converter == NULL) {
            fail_msg("UDUNITS does not take %s to %s", usual[i].from, usual[i].to);
        }
        double scale = cv_convert_double(converter, 1.0);
        if (!same_bits(scale, usual[i].scale) || cv_convert_double(converter, 0.0) != 0.0) {
            fail_msg("%s is %.17g %s, not %.17g", usual[i].from, scale, usual[i].to,
                     usual[i].scale);
        }
        cv_free(converter);
        ut_free(from);
        ut_free(to);
    }
    ut_free_system(system);
}

// "mm1/day" for "mm/day": the same unit, in a spelling that is not in the table.
static void spell_anew(const char *from, char *text, size_t size)
{
    size_t start = strcspn(from, "%abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
    size_t end = start + 1;
    while (isalpha((unsigned char)from[end])) {
        end++;
    }
    (void)snprintf(text, size, "%.*s1%s", (int)end, from, from + end);
}

static void another_spelling_gives_the_same(void **state)
{
    (void)state;
    size_t count = 0;
    const lac_usual_unit *usual = lac_units_usual(&count);
    lac_units *units = NULL;
    lac_error err = {""};
    assert_int_equal(lac_units_create(&units, &err), LAC_OK);
    for (size_t i = 0; i < count; i++) {
        char text[64];
        double scale[2] = {NAN, NAN};
        double offset[2] = {NAN, NAN};
        spell_anew(usual[i].from, text, sizeof text);
        assert_null(lac_units_usual_find(text, usual[i].to));
        assert_ptr_equal(lac_units_usual_find(usual[i].from, usual[i].to), &usual[i]);
        if (lac_units_convert(units, usual[i].from, usual[i].to, &scale[0], &offset[0], &err) !=
                LAC_OK ||
            lac_units_convert(units, text, usual[i].to, &scale[1], &offset[1], &err) != LAC_OK) {
            fail_msg("%s or %s: %s", usual[i].from, text, err.message);
        }
        assert_true(same_bits(scale[0], scale[1]) && same_bits(offset[0], offset[1]));
    }
    lac_units_free(units);
}

// A database that is there but cannot be read is met only where it is needed.
static void they_need_no_database(void **state)
{
    (void)state;
    char path[] = "/tmp/lacuna-units-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0 && write(fd, "no database\n", 12) == 12 && close(fd) == 0);
    assert_int_equal(setenv("UDUNITS2_XML_PATH", path, 1), 0);
    lac_units *units = NULL;
    lac_error err = {""};
    double value = NAN;
    assert_int_equal(lac_units_create(&units, &err), LAC_OK);
    assert_int_equal(lac_units_parse(units, "5 MPa", "Pa", &value, &err), LAC_OK);
    assert_true(value == 5e6);
    assert_int_equal(lac_units_parse(units, "0.5", "1", &value, &err), LAC_OK);
    assert_true(value == 0.5);
    assert_int_equal(lac_units_parse(units, "5 bar", "Pa", &value, &err), LAC_EIO);
    assert_string_equal(err.message, "the units database of UDUNITS-2 cannot be read");
    assert_true(value == 0.5);
    lac_units_free(units);

    assert_int_equal(unlink(path), 0);
    assert_int_equal(lac_units_create(&units, &err), LAC_EIO);
    assert_null(units);
    assert_int_equal(unsetenv("UDUNITS2_XML_PATH"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(their_factors_are_those_of_udunits),
        cmocka_unit_test(another_spelling_gives_the_same),
        cmocka_unit_test(they_need_no_database),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
