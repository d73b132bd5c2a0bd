// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "base/units.h"
#include "series/series.h"
#include "support/scratch.h"
#include "support/test.h"

static scratch folder;
static lac_units *units;

static int open_all(void **state)
{
    (void)state;
    scratch_create(&folder);
    return lac_units_create(&units, NULL) == LAC_OK ? 0 : -1;
}

static int close_all(void **state)
{
    (void)state;
    lac_units_free(units);
    scratch_remove(&folder);
    return 0;
}

// What a text must give, read for time `t` and displacement `d` in mm: the number of readings, what
// was missing and dropped, and the first and last values; or what the refusal says.
typedef struct mess {
    const char *name, *text;
    const char *refusal; // NULL: is read
    size_t n, missing, duplicates;
    double first, last; // displacement [mm]; NaN: missing
} mess;

#define D1 "2014-02-01"
#define D2 "2014-02-02"
#define D3 "2014-02-03"

static const mess messes[] = {
    {"plain", "t,d\n" D1 ",1\n" D2 ",2.5\n", NULL, 2, 0, 0, 1, 2.5},
    {"no newline at the end", "t,d\n" D1 ",1\n" D2 ",2.5", NULL, 2, 0, 0, 1, 2.5},
    {"CRLF", "t,d\r\n" D1 ",1\r\n" D2 ",2\r\n", NULL, 2, 0, 0, 1, 2},
    {"CR alone", "t,d\r" D1 ",1\r" D2 ",2\r", NULL, 2, 0, 0, 1, 2},
    {"byte order mark", "\xef\xbb\xbft,d\n" D1 ",1\n", NULL, 1, 0, 0, 1, 1},
    {"comments", "# by A\n#\n# B\nt,d\n# x\n" D1 ",1\n  # y\n" D2 ",2\n", NULL, 2, 0, 0, 1, 2},
    {"blank lines", "\n\nt,d\n\n" D1 ",1\n   \n" D2 ",2\n\n\n", NULL, 2, 0, 0, 1, 2},
    {"rows of separators", "t,d\n" D1 ",1\n,\n" D2 ",2\n , \n", NULL, 2, 0, 0, 1, 2},
    {"semicolons", "t;d\n" D1 ";1\n" D2 ";2.5\n", NULL, 2, 0, 0, 1, 2.5},
    {"decimal comma", "t;d\n" D1 ";1,25\n" D2 ";2\n", NULL, 2, 0, 0, 1.25, 2},
    {"seconds with decimal comma", "t;d\n0,5;1,25\n1,5;2\n", NULL, 2, 0, 0, 1.25, 2},
    {"tabs", "t\td\n" D1 "\t1\n" D2 "\t2\n", NULL, 2, 0, 0, 1, 2},
    {"tabs with a gap", "t\tx\td\n" D1 "\t\t1\n" D2 "\t7\t\n", NULL, 2, 1, 0, 1, NAN},
    {"other columns", "a,d,b,t\n9,1,8," D1 "\nx,2,y," D2 "\n", NULL, 2, 0, 0, 1, 2},
    {"blanks round fields", " t , d \n " D1 " , 1 \n", NULL, 1, 0, 0, 1, 1},
    {"quotes", "\"t\",\"d\"\n\"" D1 "\",\"1\"\n", NULL, 1, 0, 0, 1, 1},
    {"separator in quotes", "note,t,d\n\"a, b\"," D1 ",1\n", NULL, 1, 0, 0, 1, 1},
    {"quote in quotes", "note,t,d\n\"a \"\"b\"\" c\"," D1 ",1\n", NULL, 1, 0, 0, 1, 1},
    {"quote within a field", "note,t,d\n5\" pipe," D1 ",1\n", NULL, 1, 0, 0, 1, 1},
    {"missing marks", "t,d\n1,NA\n2,n/a\n3,NaN\n4,\n5,-\n6,---\n7,null\n8,None\n9,#N/A\n11,7\n",
     NULL, 10, 9, 0, NAN, 7},
    {"row that ends early", "t,d\n" D1 ",1\n" D2 "\n", NULL, 2, 1, 0, 1, NAN},
    {"separators at the end", "t,d\n" D1 ",1,\n" D2 ",2,,,\n", NULL, 2, 0, 0, 1, 2},
    {"out of order", "t,d\n" D3 ",3\n" D1 ",1\n" D2 ",2\n", NULL, 3, 0, 0, 1, 3},
    {"same time twice", "t,d\n" D1 ",1\n" D1 ",9\n" D2 ",2\n", NULL, 2, 0, 1, 1, 2},
    {"same time far apart", "t,d\n" D1 ",1\n" D2 ",2\n" D1 ",9\n", NULL, 2, 0, 1, 1, 2},
    {"same time, first missing", "t,d\n" D1 ",NA\n" D1 ",9\n" D2 ",2\n", NULL, 2, 1, 1, 9, 2},
    {"same time in two zones", "t,d\n2014-02-01T12:00Z,1\n2014-02-01T13:00+01:00,9\n", NULL, 1, 0,
     1, 1, 1},
    {"sensor reset and negative", "t,d\n" D1 ",100\n" D2 ",0\n" D3 ",-5\n", NULL, 3, 0, 0, 100, -5},
    {"seconds", "t,d\n0,1\n1e3,2\n+2500.5,3\n", NULL, 3, 0, 0, 1, 3},
    {"negative seconds", "t,d\n-10,1\n-5,2\n", NULL, 2, 0, 0, 1, 2},
    {"exponents", "t,d\n" D1 ",1.5e2\n" D2 ",-2E-1\n", NULL, 2, 0, 0, 150, -0.2},
    {"tiny", "t,d\n" D1 ",1e-320\n", NULL, 1, 0, 0, 1e-320, 1e-320},
    {"title lines", "Hang Nord\n\nP3, 2014\nt,d\n" D1 ",1\n" D2 ",2\n", NULL, 2, 0, 0, 1, 2},
    {"a title with the names", "t;d\nt,x,d\n" D1 ",7,1\n" D2 ",7,2\n", NULL, 2, 0, 0, 1, 2},
    {"a header in a comment", "# t,d\n" D1 ",1\n" D2 ",2\n", NULL, 2, 0, 0, 1, 2},
    {"rows of units", "t,d\nTS,mm\n,Avg\n" D1 ",1\n" D2 ",2\n", NULL, 2, 0, 0, 1, 2},
    {"the header again", "t,d\n" D1 ",1\nt,d\n" D2 ",2\n", NULL, 2, 0, 0, 1, 2},
    {"the header again, turned", "t,d\n" D1 ",1\nd,t\n2," D2 "\n", NULL, 2, 0, 0, 1, 2},
    {"blanks between columns", "t  d\n" D1 "   1\n" D2 " 2  \n", NULL, 2, 0, 0, 1, 2},
    {"a unit in brackets", "t,d [mm]\n" D1 ",1\n" D2 ",2\n", NULL, 2, 0, 0, 1, 2},
    {"three decimals", "t,d\n" D1 ",1.234\n" D2 ",99\n", NULL, 2, 0, 0, 1.234, 99},
    {"three decimals below 1", "t,d\n" D1 ",0.234\n" D2 ",999\n", NULL, 2, 0, 0, 0.234, 999},
    {"Latin-1 beside", "t,d,n\n" D1 ",1,Is\xe8re\n", NULL, 1, 0, 0, 1, 1},
    {"UTF-8 beside", "t,d,n\n" D1 ",1,Is\xc3\xa8re\n", NULL, 1, 0, 0, 1, 1},

    {"empty", "", "has no header line", 0, 0, 0, 0, 0},
    {"comments only", "# a\n# b\n", "has no header line", 0, 0, 0, 0, 0},
    {"header only", "t,d\n", "has no readings", 0, 0, 0, 0, 0},
    {"everything missing", "t,d\n1,NA\n2,\n", "every reading is missing", 0, 0, 0, 0, 0},
    {"no such column", "t,disp_mm,rain\n" D1 ",1,0\n",
     ":1: has no column \"d\"; its columns are t, disp_mm, rain", 0, 0, 0, 0, 0},
    {"column twice", "t,d,d\n" D1 ",1,2\n", "names two columns", 0, 0, 0, 0, 0},
    {"no time", "t,d\n" D1 ",1\n,2\n", ":3: t: \"\" must be a time", 0, 0, 0, 0, 0},
    {"a word for a time", "t,d\nsoon,1\n", ":2: t: \"soon\" must be a date like", 0, 0, 0, 0, 0},
    {"a day that is not", "t,d\n2014-02-30,1\n", ":2: t: \"2014-02-30\"", 0, 0, 0, 0, 0},
    {"another date format", "t,d\n01/02/2014,1\n", ":2: t: \"01/02/2014\"", 0, 0, 0, 0, 0},
    {"dates, then seconds", "t,d\n" D1 ",1\n86400,2\n", ":3: t: \"86400\" must be a date", 0, 0, 0,
     0, 0},
    {"seconds, then dates", "t,d\n0,1\n" D1 ",2\n", ":3: t: \"2014-02-01\" must be seconds", 0, 0,
     0, 0, 0},
    {"a word for a number", "t,d\n" D1 ",1\n" D2 ",lots\n", ":3: d: \"lots\" must be a number", 0,
     0, 0, 0, 0},
    {"a unit in a number", "t,d\n" D1 ",1mm\n", ":2: d: \"1mm\"", 0, 0, 0, 0, 0},
    {"hexadecimal", "t,d\n" D1 ",0x10\n", ":2: d: \"0x10\"", 0, 0, 0, 0, 0},
    {"infinity", "t,d\n" D1 ",inf\n", ":2: d: \"inf\"", 0, 0, 0, 0, 0},
    {"overflow", "t,d\n" D1 ",1e999\n", ":2: d: \"1e999\"", 0, 0, 0, 0, 0},
    {"a comma in a comma file", "t,d\n" D1 ",1,5\n", ":2: row: \"5\" stands beyond", 0, 0, 0, 0, 0},
    {"a comma in quotes", "t,d\n" D1 ",\"1,5\"\n", ":2: d: \"1,5\" must have a decimal point", 0, 0,
     0, 0, 0},
    {"two decimal marks", "t;d\n" D1 ";1,5\n" D2 ";2.5\n", ":3: d: \"2.5\" must have the decimal",
     0, 0, 0, 0, 0},
    {"thousands", "t;d\n" D1 ";1.234,5\n",
     ":2: d: \"1.234,5\" has marks of thousands: export it without them, as 1234,5", 0, 0, 0, 0, 0},
    {"thousands with blanks",
     "t;d\n" D1 ";12\xc2\xa0"
     "345\n",
     "as 12345", 0, 0, 0, 0, 0},
    {"thousands and decimals", "t;d\n" D1 ";998\n" D2 ";1,001\n", ":3: d: \"1,001\" is 1001 or", 0,
     0, 0, 0, 0},
    {"units that repeat", "t,d\na,b\na,b\na,b\na,b\n", ":5: t: \"a\" must be a date", 0, 0, 0, 0,
     0},
    {"UTF-16", "\xff\xfet", "is UTF-16: convert it", 0, 0, 0, 0, 0},
    {"a workbook", "PK\x03\x04", "is a workbook (xlsx, ods)", 0, 0, 0, 0, 0},
    {"open quote", "t,d\n\"" D1 ",1\n" D2 ",2\n", ":2: row: ", 0, 0, 0, 0, 0},
    {"text after a quote", "t,d\n\"" D1 "\"x,1\n", ":2: row: ", 0, 0, 0, 0, 0},
    {"open quote in the header", "t,\"d\n" D1 ",1\n", ":1: header: ", 0, 0, 0, 0, 0},
    {"control characters", "t,d\n" D1 ",\x01\n", ":2: byte 0x01 is not text", 0, 0, 0, 0, 0},
    {"a picture", "\x89PNG\r\n\x1a\n", ":2: byte 0x1a is not text", 0, 0, 0, 0, 0},
};

static lac_status read_text(const char *text, size_t size, lac_series **series, lac_error *err)
{
    lac_series_def def = {.path = scratch_write(&folder, "mess.csv", text, size),
                          .time = "t",
                          .displacement = "d",
                          .displacement_unit = "mm"};
    return lac_series_read(&def, units, series, err);
}

static bool is_close(double value, double expected)
{
    return isnan(expected) ? isnan(value) : fabs(value - expected) <= 1e-15 * fabs(expected);
}

static void messes_are_read_or_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof messes / sizeof messes[0]; i++) {
        const mess *m = &messes[i];
        lac_series *s = NULL;
        lac_error err = {{0}};
        lac_status status = read_text(m->text, strlen(m->text), &s, &err);
        if (m->refusal != NULL) {
            if (status != LAC_EINPUT || strstr(err.message, m->refusal) == NULL) {
                fail_msg("%s: %d %s", m->name, (int)status, err.message);
            }
            assert_null(s);
            assert_non_null(strstr(err.message, "mess.csv"));
            continue;
        }
        if (status != LAC_OK) {
            fail_msg("%s: %s", m->name, err.message);
        }
        if (s->n != m->n || s->missing != m->missing || s->duplicates != m->duplicates ||
            !is_close(s->displacement[0], m->first * 1e-3) ||
            !is_close(s->displacement[s->n - 1], m->last * 1e-3)) {
            fail_msg("%s: n %zu, missing %zu, duplicates %zu, %g to %g", m->name, s->n, s->missing,
                     s->duplicates, s->displacement[0], s->displacement[s->n - 1]);
        }
        for (size_t k = 1; k < s->n; k++) {
            assert_true(s->time[k] > s->time[k - 1]);
        }
        lac_series_free(s);
    }
}

static void nul_bytes_are_refused(void **state)
{
    (void)state;
    static const char text[] = "t,d\n2014-02-01,1\0\n";
    static const char wide[] = "\xff\xfet\0,\0d\0\n\0";
    lac_series *s = NULL;
    lac_error err = {{0}};
    assert_int_equal(read_text(text, sizeof text - 1, &s, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, ":2: byte 0x00"));
    assert_int_equal(read_text(wide, sizeof wide - 1, &s, &err), LAC_EINPUT);
    assert_null(s);
}

static void lines_are_remembered(void **state)
{
    (void)state;
    const char *text = "# Who, when\n#  CC BY\n\nt,d\n20,2\n# x\n10,1\n";
    lac_series *s = NULL;
    assert_int_equal(read_text(text, strlen(text), &s, NULL), LAC_OK);
    assert_string_equal(s->attribution, "Who, when CC BY");
    assert_int_equal(s->line[0], 7);
    assert_int_equal(s->line[1], 5);
    assert_false(s->dated);
    assert_null(s->velocity);
    lac_series_free(s);
    lac_series_free(NULL);
}

static void definitions_are_checked(void **state)
{
    (void)state;
    const char *path = scratch_write(&folder, "def.csv", "t,d,v\n0,1,2\n1,2,\n", 17);
    lac_series *s = NULL;
    lac_error err = {{0}};
    lac_series_def def = {.path = path, .time = "t"};
    assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EINPUT);
    def.displacement = "d";
    def.displacement_unit = "kg";
    assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "d: unit \"kg\""));
    def.displacement_unit = NULL;
    def.velocity = "v";
    def.velocity_unit = "cm/day";
    assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_OK);
    assert_true(s->displacement[1] == 2.0);
    assert_true(fabs(s->velocity[0] - 0.02 / 86400.0) < 1e-20);
    assert_true(isnan(s->velocity[1]));
    lac_series_free(s);
    def.path = "/nowhere/at/all.csv";
    assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EIO);
    def.path = folder.folder;
    assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EIO);
    assert_null(s);
}

// Rows in the worst order, every tenth twice.
static void write_rows(FILE *file, int count)
{
    (void)fprintf(file, "t,note,d\n");
    for (int i = 0; i < count; i++) {
        (void)fprintf(file, "%d,x,%d.5\n", count - i + (i % 10 == 0), i);
    }
}

// One row of many columns.
static void write_columns(FILE *file, int count)
{
    for (int i = 0; i < count; i++) {
        (void)fprintf(file, "c%d,", i);
    }
    (void)fprintf(file, "t,d\n");
    for (int i = 0; i < count; i++) {
        (void)fputs(",", file);
    }
    (void)fprintf(file, "5,6\n");
}

// Processor time that reading takes [s]; the readings kept and dropped.
static double time_reading(void (*write)(FILE *file, int count), int count, size_t *readings)
{
    lac_series_def def = {
        .path = scratch_path(&folder, "large.csv"), .time = "t", .displacement = "d"};
    FILE *file = fopen(def.path, "w");
    assert_non_null(file);
    write(file, count);
    (void)fclose(file);
    lac_series *s = NULL;
    clock_t start = clock();
    assert_int_equal(lac_series_read(&def, units, &s, NULL), LAC_OK);
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    *readings = s->n + s->duplicates;
    lac_series_free(s);
    return seconds;
}

static void cost_grows_with_size_only(void **state)
{
    (void)state;
    const int all = (int)test_some(500000);
    size_t readings = 0;
    double few = time_reading(write_rows, all / 10, &readings);
    assert_int_equal(readings, all / 10);
    double many = time_reading(write_rows, all, &readings);
    assert_int_equal(readings, all);
    print_message("%d rows in %.2f s\n", all, many);
    assert_true(many < 40.0 * few + 0.1);
    few = time_reading(write_columns, all / 10, &readings);
    many = time_reading(write_columns, all, &readings);
    assert_int_equal(readings, 1);
    assert_true(many < 40.0 * few + 0.1);
}

typedef struct real_file {
    const char *path, *time, *displacement, *unit;
    size_t n;
    double last; // [m]
} real_file;

#define CASES LACUNA_SOURCE_DIR "/cases/data/"
// Files that may not be shipped: read where they are at hand.
#define NEARBY LACUNA_SOURCE_DIR "/../shared/data/monitoring/"

static void real_files_are_read(void **state)
{
    (void)state;
    const real_file files[] = {
        {CASES "century_prism_31-2008.csv", "datetime_local", "displacement_mm", "mm", 69, 0.07597},
        {CASES "century_prism_31-2007_tail.csv", "datetime_local", "displacement_mm", "mm", 7,
         0.09393},
        {CASES "century_rain_2013-12_2014-02.csv", "date", "rain_mm", "mm", 16, 0.0},
        {NEARBY "chambon_2015_C15.csv", "datetime", "displacement_mm", "mm", 24, 1.7185},
        {NEARBY "baijiabao_daily_2017-10_2018-08.csv", "date", "displacement_mm", "mm", 300,
         0.0802},
        {NEARBY "lamosano_p5_rain_2015_2020.csv", "date", "p5", "mm", 161, 0.0003467097333333129},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (access(files[i].path, R_OK) != 0) {
            print_message("skipped: %s is not here\n", files[i].path);
            continue;
        }
        lac_series_def def = {.path = files[i].path,
                              .time = files[i].time,
                              .displacement = files[i].displacement,
                              .displacement_unit = files[i].unit};
        lac_series *s = NULL;
        lac_error err = {{0}};
        if (lac_series_read(&def, units, &s, &err) != LAC_OK) {
            fail_msg("%s", err.message);
        }
        assert_true(s->dated);
        assert_int_equal(s->n, files[i].n);
        assert_true(fabs(s->displacement[s->n - 1] - files[i].last) < 1e-12);
        lac_series_free(s);
    }
}

static void vajont_is_laid_out_as_a_series(void **state)
{
    (void)state;
    lac_series_def def = {.path = CASES "vajont_anchors.csv",
                          .time = "date",
                          .velocity = "rate_cm_per_day",
                          .velocity_unit = "cm/day"};
    lac_series *s = NULL;
    lac_error err = {{0}};
    if (lac_series_read(&def, units, &s, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    // both of the rates that are told of the last days
    bool paper = false;
    bool others = false;
    for (size_t i = 0; i < s->n; i++) {
        paper = paper || fabs(s->velocity[i] * 86400.0 - 0.8) < 1e-9;
        others = others || fabs(s->velocity[i] * 86400.0 - 0.2) < 1e-9;
    }
    assert_true(paper && others);
    assert_int_equal(s->duplicates, 0);
    assert_true(s->time[s->n - 1] == -196568460.0); // 1963-10-09T21:39Z, 22:39 in Italy
    lac_series_free(s);
}

// slip = 2 t, rate = e^t at whole t
static const double h_time[] = {0, 1, 2, 2, 4};
static const double h_slip[] = {0, 2, 4, 5, 8};
static const double h_rate[] = {1.0, 2.718281828459045, 7.38905609893065, 7.38905609893065, 0.0};
static const lac_history history = {.n = 5, .time = h_time, .slip = h_slip, .rate = h_rate};

static void history_is_interpolated(void **state)
{
    (void)state;
    double slip = 0.0;
    double rate = 0.0;
    assert_true(lac_history_eval(&history, 0.0, &slip, &rate));
    assert_true(slip == 0.0 && rate == 1.0);
    assert_true(lac_history_eval(&history, 0.25, &slip, &rate));
    assert_true(slip == 0.5 && fabs(rate - exp(0.25)) < 1e-15);
    assert_true(lac_history_eval(&history, 2.0, &slip, &rate)); // the later of two at one time
    assert_true(slip == 5.0);
    assert_true(lac_history_eval(&history, 3.0, &slip, &rate)); // a rate of 0 has no logarithm
    assert_true(slip == 6.5 && fabs(rate - 0.5 * exp(2.0)) < 1e-14);
    assert_true(lac_history_eval(&history, 4.0, &slip, &rate));
    assert_true(slip == 8.0 && rate == 0.0);
    assert_false(lac_history_eval(&history, -1e-9, &slip, &rate));
    assert_false(lac_history_eval(&history, 4.0001, &slip, &rate));
    assert_false(lac_history_eval(&history, NAN, &slip, &rate));
    const lac_history nothing = {0};
    assert_false(lac_history_eval(&nothing, 0.0, &slip, &rate));
}

static void misfit_is_what_it_says(void **state)
{
    (void)state;
    double time[] = {-1.0, 0.0, 0.5, 1.0, 1.5, 9.0};
    double displacement[] = {7.0, 10.0, 11.5, 11.5, NAN, NAN}; // 10 + slip + {0, 0.5, -0.5}
    double velocity[] = {1.0, 10.0, NAN, -1.0, 0.0, NAN};
    const lac_series series = {
        .n = 6, .time = time, .displacement = displacement, .velocity = velocity};
    lac_misfit misfit;
    lac_series_compare(&series, &history, &misfit);
    assert_int_equal(misfit.displacement_count, 3);
    assert_int_equal(misfit.velocity_count, 1); // rates that are not positive have no logarithm
    assert_int_equal(misfit.outside, 1);        // the last one is no reading at all
    assert_true(fabs(misfit.displacement_offset - 10.0) < 1e-14);
    assert_true(fabs(misfit.displacement_rms - sqrt(0.5 / 3.0)) < 1e-14);
    assert_true(fabs(misfit.log_rate_rms - 1.0) < 1e-14);
    const lac_history nothing = {0};
    lac_series_compare(&series, &nothing, &misfit);
    assert_true(isnan(misfit.displacement_rms) && isnan(misfit.log_rate_rms));
    assert_int_equal(misfit.outside, 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(messes_are_read_or_refused),     cmocka_unit_test(nul_bytes_are_refused),
        cmocka_unit_test(lines_are_remembered),           cmocka_unit_test(definitions_are_checked),
        cmocka_unit_test(cost_grows_with_size_only),      cmocka_unit_test(real_files_are_read),
        cmocka_unit_test(vajont_is_laid_out_as_a_series), cmocka_unit_test(history_is_interpolated),
        cmocka_unit_test(misfit_is_what_it_says),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
