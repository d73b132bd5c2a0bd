// SPDX-License-Identifier: GPL-3.0-or-later
// What a file does not say: what is taken, doubted, asked about.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "base/units.h"
#include "lacuna/series.h"
#include "support/scratch_group.h"

static lac_units *units;

static int open_all(void **state)
{
    (void)open_scratch(state);
    return lac_units_create(&units, NULL) == LAC_OK ? 0 : -1;
}

static int close_all(void **state)
{
    lac_units_free(units);
    return close_scratch(state);
}

// A text read for time `t` and displacement `d` in mm.
static lac_status read_text(const char *text, size_t size, lac_series **series, lac_error *err)
{
    const lac_series_def def = {.path = scratch_write(&folder, "mess.csv", text, size),
                                .time = "t",
                                .displacement = "d",
                                .displacement_unit = "mm"};
    return lac_series_read(&def, units, series, err);
}

// What is taken for want of a word is doubted; what a name contradicts is asked about.
static void doubts_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *header, *time, *displacement, *unit, *format, *says;
        size_t doubts;
    } cases[] = {
        {"t,d", "t", "d", NULL, NULL, "t: no unit is named: taken as s", 2},
        {"t,d", "t", "d", "mm", NULL, "t: no unit is named: taken as s", 1},
        {"t,d", "t", "d", NULL, "day", "d: no unit is named: taken as m", 1},
        {"t,d", "t", "d", "mm", "day", NULL, 0},
        {"time_s,disp_m", "time_s", "disp_m", NULL, NULL, NULL, 0},
        {"t,disp_mm", "t", "disp_mm", NULL, NULL, ":1: disp_mm: has no unit, and its name says mm",
         9},
        {"t,Weg (cm)", "t", "Weg (cm)", NULL, NULL, "its name says cm", 9},
        {"t,disp_mm", "t", "disp_mm", "m", "s", NULL, 0},
        {"month,d", "month", "d", "mm", NULL,
         ":2: month: has bare numbers, and its name says month", 9},
        {"elapsed_day,d", "elapsed_day", "d", "mm", NULL, "which time format is it, day or s?", 9},
        {"hour,d", "hour", "d", "mm", "hour", NULL, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[128];
        const int n = snprintf(text, sizeof text, "%s\n1,1\n2,2.5\n", cases[i].header);
        const lac_series_def def = {.path = scratch_write(&folder, "doubt.csv", text, (size_t)n),
                                    .time = cases[i].time,
                                    .time_format = cases[i].format,
                                    .displacement = cases[i].displacement,
                                    .displacement_unit = cases[i].unit};
        lac_series *s = NULL;
        lac_error err = {""};
        const lac_status status = lac_series_read(&def, units, &s, &err);
        assert_int_equal(status, cases[i].doubts == 9 ? LAC_EINPUT : LAC_OK);
        if (status == LAC_OK) {
            assert_int_equal(s->doubts, cases[i].doubts);
        }
        const char *said = status != LAC_OK ? err.message : s->doubts > 0 ? s->doubt[0] : "";
        if (cases[i].says != NULL && strstr(said, cases[i].says) == NULL) {
            fail_msg("%s: %s", cases[i].header, said);
        }
        lac_series_free(s);
    }
}

// One repeated time in ten rows, or one in any number, is believed; two in nineteen are not.
static void rows_that_contradict_are_counted(void **state)
{
    (void)state;
    for (size_t rows = 2; rows <= 21; rows++) {
        for (size_t twice = 1; twice <= 2 && twice < rows; twice++) {
            char text[512] = "t,d\n";
            for (size_t i = 0; i < rows; i++) { // the last rows repeat the first time
                const size_t used = strlen(text);
                (void)snprintf(text + used, sizeof text - used, "%zu,%zu\n",
                               i + twice < rows ? i : 0, i);
            }
            lac_series *s = NULL;
            lac_error err = {""};
            const lac_status status = read_text(text, strlen(text), &s, &err);
            const bool believed = twice == 1 || rows >= 20;
            assert_int_equal(status, believed ? LAC_OK : LAC_EINPUT);
            if (believed) {
                assert_int_equal(s->conflicts, twice);
                assert_int_equal(s->duplicates, twice);
                assert_non_null(
                    strstr(s->doubt[s->doubts - 1], "repeat a time with another value"));
            } else {
                char says[64]; // the line of the first that contradicts
                (void)snprintf(says, sizeof says, "mess.csv:%zu: t: a row above", rows);
                assert_non_null(strstr(err.message, says));
            }
            lac_series_free(s);
        }
    }
}

// What the last digit counts, of the finest number of a column.
static void last_digits_are_known(void **state)
{
    (void)state;
    static const struct {
        const char *values[3];
        double digit; // of a column in mm [m]
    } columns[] = {{{"1", "20", "300"}, 1e-3},       {{"1.5", "2.25", "3"}, 1e-5},
                   {{"1.50", "2.5", "3.500"}, 1e-6}, {{"1e3", "2.5e4", "3e3"}, 1.0},
                   {{"1.25e-2", "2", "NA"}, 1e-7},   {{"-0.1", "+.2", "7."}, 1e-4}};
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        char text[96];
        const int n = snprintf(text, sizeof text, "t,d\n1,%s\n2,%s\n3,%s\n", columns[i].values[0],
                               columns[i].values[1], columns[i].values[2]);
        lac_series *s = NULL;
        assert_int_equal(read_text(text, (size_t)n, &s, NULL), LAC_OK);
        assert_true(fabs(s->displacement_digit / columns[i].digit - 1.0) < 1e-12);
        assert_true(s->velocity_digit == 0.0 && s->time_unit == 1.0);
        assert_string_equal(s->time_name, "s");
        lac_series_free(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doubts_are_told),
        cmocka_unit_test(rows_that_contradict_are_counted),
        cmocka_unit_test(last_digits_are_known),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
