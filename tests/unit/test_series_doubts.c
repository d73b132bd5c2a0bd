// SPDX-License-Identifier: GPL-3.0-or-later
// What a file does not say: what is taken, doubted, asked about.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <netcdf.h>
#include <stdio.h>

#include "base/units.h"
#include "series/field.h"
#include "series/series.h"
#include "series/text.h"
#include "support/scratch_group.h"
#include "support/test.h"

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
        {"t,Weg (cm)", "t", "Weg (cm)", NULL, NULL, "t: no unit is named: taken as s", 1},
        {"t,Weg (cm)", "t", "Weg", NULL, "day", NULL, 0},
        {"t,Weg (cm)", "t", "Weg", "centimeter", "day", NULL, 0},
        {"t,Weg (cm)", "t", "Weg", "mm", "day", ":1: Weg: the file says cm, and mm was named", 9},
        {"t,Weg [mm/day]", "t", "Weg", "mm", "day",
         ":1: Weg: the file says mm/day, and mm was named, a unit of another kind", 9},
        {"t,Weg (mm/day)", "t", "Weg", "mm", "day", "the file says mm/day, and mm was named", 9},
        {"t,Weg [mm/day] (Ost)", "t", "Weg [mm/day] (Ost)", "mm", "day", "says mm/day, and mm", 9},
        {"t,Weg [mV]", "t", "Weg", "mm", "day", "says mV, and mm was named", 9},
        {"t,Weg\n,[mm/day]", "t", "Weg", "mm", "day", "says mm/day, and mm was named", 9},
        {"t,Weg [N]", "t", "Weg", "mm", "day", NULL, 0},
        {"t,Weg (min)", "t", "Weg", "mm", "day", NULL, 0},
        {"t,Weg (Ost) [cm]", "t", "Weg (Ost)", NULL, "day", NULL, 0},
        {"t,Weg [Ost]", "t", "Weg", NULL, "day", "\"Ost\" is no unit of this kind (m)", 9},
        {"t [h],d", "t", "d", "mm", NULL, NULL, 0},
        {"t [h],d", "t [h]", "d", "mm", "hour", NULL, 0},
        {"t [h],d", "t", "d", "mm", "day", "t: the file says h, and day was named", 9},
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

// No power of ten that a file may state overflows.
static void last_digit_of_any_power(void **state)
{
    (void)state;
    assert_int_equal(lac_text_digit("1,70", ','), -2);
    assert_int_equal(lac_text_digit("3e2", '.'), 2);
    assert_int_equal(lac_text_digit("1.5e-400", '.'), -401);
    assert_int_equal(lac_text_digit("0.0e-2147483648", '.'), -401);
    assert_int_equal(lac_text_digit("0.0e99999999999", '.'), 399);
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

// Counts of a slope that creeps and shakes, and curves that are no counts, at hour i.
static double creeps(int i) { return (double)(5 * i / 7 + (7919 * i) % 5); }
static double runs_on_a_line(int i) { return 1000.0 + 0.7 * i; }
static double runs_on_a_parabola(int i) { return 1000.0 + 0.02 * i * i; }

enum { HOURS = 60 };

// Counts of 0.5 mm, also in single precision, are seen; lines, parabolas and few readings are not.
static void steps_of_the_sensor_are_found(void **state)
{
    (void)state;
    static const struct {
        double (*count)(int hour);
        double step;
        const char *format;
        bool single;
        int hours, off; // one reading, of this hour, is off the steps
        double digit;   // of a column in mm [m]
    } columns[] = {{creeps, 0.5, "%.1f", false, HOURS, -1, 5e-4},
                   {creeps, 0.5, "%.3f", false, HOURS, -1, 5e-4},
                   {creeps, 0.5, "%.1f", false, HOURS, 30, 1e-4},
                   {creeps, 0.5, "%.1f", false, 12, -1, 1e-4},
                   {creeps, 0.1, "%.12g", true, HOURS, -1, 1e-4},
                   {creeps, 0.1, "%.1f", false, HOURS, -1, 1e-4},
                   {runs_on_a_line, 1.0, "%.3f", false, HOURS, -1, 1e-6},
                   {runs_on_a_parabola, 1.0, "%.3f", false, HOURS, -1, 1e-6}};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
        char text[4096] = "t,d\n";
        for (int i = 0; i < columns[k].hours; i++) {
            const size_t used = strlen(text);
            double d = columns[k].step * columns[k].count(i);
            d = columns[k].single ? (double)(float)d : d;
            (void)snprintf(text + used, sizeof text - used, "%d,",
                           3600 * i + (columns[k].count == creeps ? 60 * (i % 3) : 0));
            (void)snprintf(text + strlen(text), sizeof text - strlen(text), columns[k].format,
                           i == columns[k].off ? d + 0.1 : d);
            (void)strcat(text, "\n");
        }
        lac_series *s = NULL;
        assert_int_equal(read_text(text, strlen(text), &s, NULL), LAC_OK);
        assert_true(fabs(s->displacement_digit / columns[k].digit - 1.0) < 1e-6);
        lac_series_free(s);
    }
}

// Of noise in full precision nothing is a step, however many of its numbers are close.
static void noise_has_no_steps(void **state)
{
    (void)state;
    for (int seed = 0; seed < 300; seed++) {
        const int n = 12 + seed % 90;
        char text[4096] = "t,d\n";
        for (int i = 0; i < n; i++) {
            const size_t used = strlen(text);
            const double u = fmod(1e4 * fabs(sin(12.9898 * i + 78.233 * seed)), 1.0);
            (void)snprintf(text + used, sizeof text - used, "%d,%.14f\n", 10 * i,
                           1.0 + u + 0.01 * i);
        }
        lac_series *s = NULL;
        assert_int_equal(read_text(text, strlen(text), &s, NULL), LAC_OK);
        assert_true(s->displacement_digit < 1e-16);
        lac_series_free(s);
    }
}

// Of numbers in netCDF: single precision's 0.1, a double's 0.5; what has no steps has its type's.
static void steps_of_numbers_are_found(void **state)
{
    (void)state;
    static const struct {
        nc_type type;
        double step, noise, digit; // [mm, mm, m]
    } columns[] = {{NC_FLOAT, 0.1, 0.0, 1e-4},
                   {NC_DOUBLE, 0.5, 0.0, 5e-4},
                   {NC_DOUBLE, 0.1, 1e-5, 0.0},
                   {NC_FLOAT, 0.1, 0.05, 0x1p-23 * 4.6e-3}};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
        int id = 0, dim = 0, time = 0, var = 0;
        double t[HOURS], d[HOURS];
        const char *path = scratch_path(&folder, "steps.nc");
        for (int i = 0; i < HOURS; i++) {
            t[i] = i;
            d[i] = columns[k].step * creeps(i) + columns[k].noise * sin(i * i);
        }
        assert_int_equal(nc_create(path, NC_NETCDF4 | NC_CLOBBER, &id), NC_NOERR);
        (void)nc_def_dim(id, "t", HOURS, &dim);
        (void)nc_def_var(id, "t", NC_DOUBLE, 1, &dim, &time);
        (void)nc_def_var(id, "d", columns[k].type, 1, &dim, &var);
        (void)nc_put_att_text(id, time, "units", 4, "hour");
        (void)nc_put_att_text(id, var, "units", 2, "mm");
        (void)nc_enddef(id);
        (void)nc_put_var_double(id, time, t);
        assert_int_equal(nc_put_var_double(id, var, d), NC_NOERR);
        assert_int_equal(nc_close(id), NC_NOERR);
        const lac_series_def def = {.path = path, .time = "t", .displacement = "d"};
        lac_series *s = NULL;
        assert_int_equal(lac_series_read(&def, units, &s, NULL), LAC_OK);
        assert_true(fabs(s->displacement_digit - columns[k].digit) <= 0.1 * columns[k].digit);
        lac_series_free(s);
        s = NULL;
        lac_series_def named = def;
        lac_error err = {""};
        named.displacement_unit = k == 0 ? "cm" : "day";
        assert_int_equal(lac_series_read(&named, units, &s, &err), LAC_EINPUT);
        assert_non_null(strstr(err.message, ": d: the file says mm, and "));
        d[3] = d[9] = -9999.9; // a fill that no attribute names
        assert_int_equal(nc_open(path, NC_WRITE, &id), NC_NOERR);
        assert_int_equal(nc_put_var_double(id, var, d), NC_NOERR);
        assert_int_equal(nc_close(id), NC_NOERR);
        assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EINPUT);
        assert_non_null(strstr(err.message, "d[3] = -9999.9"));
        assert_non_null(strstr(err.message, "stands in 2 of 60 rows"));
    }
}

// netCDF allocates what the header of a classic file says: here 2^31 - 1 dimensions in 64 bytes.
static void a_header_is_held_against_the_file(void **state)
{
    (void)state;
    const unsigned char bytes[64] = {'C', 'D', 'F', 1,  0,    0,    0,    0,
                                     0,   0,   0,   10, 0x7f, 0xff, 0xff, 0xff};
    const char *path = scratch_write(&folder, "short.nc", bytes, sizeof bytes);
    const lac_series_def def = {.path = path, .time = "t", .displacement = "d"};
    lac_series *s = NULL;
    lac_field field;
    lac_error err = {""};
    assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message,
                           "short.nc: byte 16: netCDF cannot read the file: its header "
                           "says what its 64 bytes cannot hold"));
    assert_int_equal(lac_field_read(path, "d", "m", units, &field, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "64 bytes cannot hold"));
}

// A slope in millimetres of which every so many rows hold another text.
static void write_slope(char *text, size_t size, double rate, const char *code, int every)
{
    (void)snprintf(text, size, "t,d\n");
    for (int i = 0; i < HOURS; i++) {
        const size_t used = strlen(text);
        if (i % every == every - 1) {
            (void)snprintf(text + used, size - used, "%d,%s\n", 3600 * i, code);
        } else {
            (void)snprintf(text + used, size - used, "%d,%.2f\n", 3600 * i,
                           3.0 + rate * i + 0.5 * sin(i * i));
        }
    }
}

// Nines for "no value" are asked about wherever they cannot be readings; where they can, not.
static void nines_are_asked_about(void **state)
{
    (void)state;
    static const struct {
        const char *code;
        double rate; // mm an hour
        int every;
        bool asked;
    } columns[] = {
        {"-9999", 0.1, 5, true},      {"-9999.0", 0.1, 7, true},  {"-999", 0.1, 5, true},
        {"9999", 0.1, 5, true},       {"-99999", 100.0, 5, true}, {"99999", 0.1, 30, true},
        {"-9999.9", 0.1, 5, true},    {"-99.99", 0.1, 5, true},   {"9999999", 0.1, 5, true},
        {"-9.999E+03", 0.1, 5, true}, {"-9999", 0.1, 60, false}, // once
        {"-9990", 0.1, 5, false},     {"NA", 0.1, 5, false},      {"99.9", 2.0, 10, false},
        {"-9999", 0.1, 1, true},      {"99.9", 0.1, 1, false},    {"999", 17.0, 10, false}};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
        char text[4096], says[96];
        lac_series *s = NULL;
        lac_error err = {""};
        write_slope(text, sizeof text, columns[k].rate, columns[k].code, columns[k].every);
        const lac_status status = read_text(text, strlen(text), &s, &err);
        (void)snprintf(says, sizeof says, ":%d: d: %.9g stands in %d of %d rows",
                       columns[k].every + 1, atof(columns[k].code), HOURS / columns[k].every,
                       HOURS);
        assert_int_equal(status, columns[k].asked ? LAC_EINPUT : LAC_OK);
        if (columns[k].asked && strstr(err.message, says) == NULL) {
            fail_msg("%s: %s", says, err.message);
        }
        lac_series_free(s);
    }
}

// Numbers of rows are asked about whatever their column is called, unless a format says what they
// count.
static void counts_of_rows_are_asked_about(void **state)
{
    (void)state;
    static const struct {
        const char *name, *format;
        int first, step, rows;
        bool asked;
    } columns[] = {{"t", NULL, 0, 1, 12, true},        {"time", NULL, 1, 1, 12, true},
                   {"nr", NULL, 1, 1, 12, true},       {"t", NULL, 2, 1, 12, false},
                   {"t", NULL, 0, 2, 12, false},       {"t", NULL, 0, 1, 4, false},
                   {"t", "s", 0, 1, 12, false},        {"t", "day", 0, 1, 12, false},
                   {"t [day]", NULL, 0, 1, 12, false}, {"time_s", NULL, 0, 1, 12, false}};
    for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
        for (int named = 0; named < 2; named++) {
            char text[512], says[64];
            lac_series *s = NULL;
            lac_error err = {""};
            (void)snprintf(text, sizeof text, "%s,d\n", columns[k].name);
            for (int i = 0; i < columns[k].rows; i++) {
                (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%d,%.1f\n",
                               columns[k].first + i * columns[k].step, 0.3 * i);
            }
            const lac_series_def def = {.path =
                                            scratch_write(&folder, "rows.csv", text, strlen(text)),
                                        .time = named != 0 ? columns[k].name : NULL,
                                        .time_format = columns[k].format,
                                        .displacement = "d",
                                        .displacement_unit = "mm"};
            (void)snprintf(says, sizeof says, "rows.csv:2: %s: counts", columns[k].name);
            assert_int_equal(lac_series_read(&def, units, &s, &err),
                             columns[k].asked ? LAC_EINPUT : LAC_OK);
            assert_true(!columns[k].asked || strstr(err.message, says) != NULL);
            lac_series_free(s);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_of_rows_are_asked_about),
        cmocka_unit_test(doubts_are_told),
        cmocka_unit_test(rows_that_contradict_are_counted),
        cmocka_unit_test(nines_are_asked_about),
        cmocka_unit_test(last_digit_of_any_power),
        cmocka_unit_test(last_digits_are_known),
        cmocka_unit_test(steps_of_the_sensor_are_found),
        cmocka_unit_test(noise_has_no_steps),
        cmocka_unit_test(steps_of_numbers_are_found),
        cmocka_unit_test(a_header_is_held_against_the_file),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
