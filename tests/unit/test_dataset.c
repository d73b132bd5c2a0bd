// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset of a made-up result: what a file has of it, and where JSON has it.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <netcdf.h>
#include <unistd.h>

#include "data/dataset.h"
#include "data/describe.h"
#include "store/store.h"
#include "support/test.h"

enum { ROWS = 2, COLUMNS = 3 };

typedef struct part {
    const char *key;
    double best;
    int64_t seed;
    bool good;
} part;

typedef struct result {
    double number, nothing;
    size_t count;
    const char *text;
    const double *table; // [ROWS][COLUMNS]
    const double *absent;
    part part[ROWS];
} result;

static const double table[ROWS * COLUMNS] = {1, 2, NAN, 4, 5, 6};
static const result made = {.number = 0.5,
                            .nothing = NAN,
                            .count = 3,
                            .text = "word",
                            .table = table,
                            .part = {{"a.b", 7, INT64_MIN, true}, {"c", 8, 9, false}}};

#define WHOLE const result *r = of
LAC_GETTER(double, product, WHOLE, r->number *(double)(10 * (at[0] + 1) + at[1]))
LAC_GETTER(double, number_of, WHOLE, r->part[at[0]].best)
LAC_GETTER(bool, never, WHOLE, r == NULL)
LAC_GETTER(bool, second, WHOLE; (void)r, at[0] == 1)
LAC_TEXT_GETTER(numeral, WHOLE; (void)r, at[0] == 0 ? "1e-05" : "1e")
LAC_TEXT_GETTER(key_of, WHOLE, r->part[at[0]].key)

#define R(kind, field) LAC_HELD(kind, result, field)
#define P(kind, field) LAC_HELD(kind, part, field)
static const lac_variable of_result[] = {
    {.name = "number", .json = "number", R(REAL, number)},
    {.name = "nothing", .json = "nothing", R(REAL, nothing)},
    {.name = "count", .json = "deep/count", R(COUNT, count), .flags = LAC_WHOLE},
    {.name = "text", .json = "text", R(TEXT, text)},
    {.json = "pair", R(REAL, number)},
    {.json = "pair", R(REAL, nothing)},
    LAC_ROW("table", "row column", "m", "a table", .json = "rows[]/columns[]", R(REALS, table),
            .flags = LAC_MISSING),
    LAC_ROW("absent", "row column", "m", "is not there", R(REALS, absent)),
    LAC_ROW("hollow", "none", "m", "over an empty dimension", R(REALS, table)),
    {.json = "products[][]", .dims = "row column", .value = product},
    {.json = "left_out/one", .value = product, .has = never},
    {.json = "left_out/two", R(REAL, number)},
    {.json = "not_there", R(REAL, number), .has = never},
    {.json = "powers{}", .dims = "row", .value = number_of, .label = key_of},
    {.json = "some{}", .dims = "row", .value = number_of, .label = key_of, .has = second},
    {.json = "no_pair", R(REAL, number), .has = never},
    {.json = "no_pair", R(REAL, nothing)},
    {.json = "numerals[]", .dims = "row", .text = numeral, .flags = LAC_NUMERAL},
    {.json = "deep/again", R(REAL, number)},
};
static const lac_variable of_parts[] = {
    {.json = "parts[]/key", P(TEXT, key)},
    {.json = "parts[]/seed", P(INT64, seed)},
    {.json = "parts[]/good", P(BOOL, good)},
    LAC_ROW("key", NULL, NULL, "keys", P(TEXT, key), .flags = LAC_CHARS),
    LAC_ROW("row", NULL, NULL, "flags", P(TEXT, key), .flags = LAC_MEANINGS),
};
static const lac_variable beside[] = {{.name = "best", P(REAL, best)},
                                      {.name = "case_key", P(TEXT, key)}};

// Laid on nothing: a result that is not there.
static const lac_variable of_missing[] = {
    {.name = "gone", .json = "gone", R(REAL, number)},
    {.name = "gone_text", .json = "gone_text", R(TEXT, text)},
    {.json = "gone_object/one", R(REAL, number)},
    {.json = "gone_lists[]", .dims = "none", R(REALS, table)},
};

static lac_dataset *make(void)
{
    static const lac_variable drawn = {.dims = "column", .value = product, .comment = "unused"};
    const lac_extent dims[] = {{"row", ROWS}, {"column", COLUMNS}, {"none", 0}};
    const lac_laid laid[] = {{LAC_VARIABLES(of_result, "", 0), &made},
                             {LAC_VARIABLES(of_parts, "row", sizeof(part)), made.part},
                             {LAC_VARIABLES(of_missing, "", 0), NULL}};
    const lac_named named = {.name = "drawn",
                             .long_name = "its long name",
                             .unit = "s",
                             .comment = "its comment",
                             .which = 1};
    const lac_laid own = {LAC_VARIABLES(beside, "", sizeof(part)), made.part};
    lac_dataset *d = NULL;
    lac_error err;
    assert_int_equal(lac_dataset_create("made up", &d, &err), LAC_OK);
    assert_int_equal(lac_dataset_dims(d, dims, 3, &err), LAC_OK);
    assert_int_equal(lac_dataset_add(d, laid, 3, &err), LAC_OK);
    assert_int_equal(lac_dataset_add_named(d, &drawn, &named, &made, &err), LAC_OK);
    lac_dataset_attributes(d, &own);
    return d;
}

// Without the spaces, which are the writer's.
static void squeeze(char *text)
{
    char *to = text;
    for (const char *from = text; *from != '\0'; from++) {
        if (*from != ' ' && *from != '\n') {
            *to++ = *from;
        }
    }
    *to = '\0';
}

static void assert_json(const lac_dataset *d, const char *wanted)
{
    char *text = NULL;
    size_t size = 0;
    lac_json json = {.out = open_memstream(&text, &size)};
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(d, &json);
    lac_json_close(&json, '}');
    (void)fclose(json.out);
    squeeze(text);
    assert_string_equal(text, wanted);
    free(text);
}

static void test_json(void **state)
{
    static const char *const wanted =
        "{\"number\":0.5,\"nothing\":null,\"deep\":{\"count\":3,\"again\":0.5},\"text\":\"word\","
        "\"pair\":[0.5,null],\"rows\":[{\"columns\":[1,2,null]},{\"columns\":[4,5,6]}],"
        "\"products\":[[5,5.5,6],[10,10.5,11]],\"left_out\":null,\"powers\":{\"a.b\":7,\"c\":8},"
        "\"some\":{\"c\":8},\"no_pair\":null,\"numerals\":[1e-05,\"1e\"],"
        "\"parts\":[{\"key\":\"a.b\",\"seed\":null,\"good\":true},"
        "{\"key\":\"c\",\"seed\":9,\"good\":false}],"
        "\"gone\":null,\"gone_text\":null,\"gone_object\":null,\"gone_lists\":[]}";
    (void)state;
    lac_dataset *d = make();
    assert_json(d, wanted);
    lac_dataset_free(d);
}

static void test_items(void **state)
{
    (void)state;
    lac_dataset *d = make();
    lac_item item = {0};
    lac_attribute attribute = {0};
    double values[ROWS * COLUMNS];
    char room[LAC_TEXT_ROOM];
    assert_false(lac_dataset_find(d, "absent", &item));
    assert_false(lac_dataset_find(d, "hollow", &item));
    assert_true(lac_dataset_find(d, "table", &item));
    assert_int_equal(item.rank, 2);
    assert_string_equal(item.dim[1], "column");
    lac_item_values(&item, values);
    assert_true(values[1] == 2 && isnan(values[2]) && values[3] == 4);
    assert_true(lac_dataset_find(d, "key", &item));
    assert_string_equal(lac_item_text(&item, 1, room), "c");
    assert_true(lac_dataset_find(d, "drawn", &item));
    assert_string_equal(item.row->comment, "its comment");
    lac_item_values(&item, values);
    assert_true(values[0] == 0.5 * 11 && values[2] == 0.5 * 31); // at[1] is `which`
    assert_true(lac_item_next_attribute(&item, &attribute));
    assert_true(attribute.text == NULL && attribute.number == 8);
    assert_true(lac_item_next_attribute(&item, &attribute));
    assert_string_equal(attribute.text, "c");
    lac_dataset_free(d);
}

static void test_file(void **state)
{
    (void)state;
    char path[] = "/tmp/lacuna-dataset-XXXXXX";
    const lac_provenance provenance = {.title = "made up"};
    double values[ROWS * COLUMNS], number;
    char keys[ROWS][3], meanings[8] = "";
    int file, id, dims, fd = mkstemp(path);
    lac_error err = {""};
    lac_dataset *d = make();
    assert_true(fd >= 0 && close(fd) == 0);
    assert_int_equal(lac_store_dataset(path, true, &provenance, d, &err), LAC_OK);
    assert_int_equal(nc_open(path, NC_NOWRITE, &file), NC_NOERR);
    assert_int_equal(nc_get_att_double(file, NC_GLOBAL, "number", &number), NC_NOERR);
    assert_true(number == 0.5);
    assert_int_not_equal(nc_inq_att(file, NC_GLOBAL, "nothing", NULL, NULL), NC_NOERR);
    assert_int_equal(nc_inq_varid(file, "table", &id), NC_NOERR);
    assert_int_equal(nc_get_var_double(file, id, values), NC_NOERR);
    assert_true(values[2] == NC_FILL_DOUBLE && values[5] == 6);
    assert_int_equal(nc_inq_varid(file, "key", &id), NC_NOERR);
    assert_int_equal(nc_get_var_text(file, id, keys[0]), NC_NOERR);
    assert_memory_equal(keys, "a.bc\0\0", 6);
    assert_int_equal(nc_inq_varid(file, "row", &id), NC_NOERR);
    assert_int_equal(nc_get_att_text(file, id, "flag_meanings", meanings), NC_NOERR);
    assert_string_equal(meanings, "a.b c");
    assert_int_not_equal(nc_inq_varid(file, "hollow", &id), NC_NOERR);
    assert_int_equal(nc_inq_dimid(file, "none", &dims), NC_EBADDIM);
    (void)nc_close(file);
    (void)unlink(path);
    lac_dataset_free(d);
}

static void test_what_cannot_be(void **state)
{
    static const lac_variable wrong[] = {
        {.name = "a", .dims = "nosuch", .value = product},
        {.name = "b", .dims = "row row row row", .value = product},
        {.json = "a_name_of_sixty_four_bytes_______________________________________",
         .value = product},
    };
    (void)state;
    const lac_extent row = {"row", 1};
    lac_error err = {""};
    lac_dataset *d = NULL;
    assert_int_equal(lac_dataset_create("wrong", &d, &err), LAC_OK);
    assert_int_equal(lac_dataset_dims(d, &row, 0, &err), LAC_OK);
    assert_int_equal(lac_dataset_dims(d, &row, 0, &err), LAC_OK);
    assert_int_equal(lac_dataset_dims(d, &row, 1, &err), LAC_OK);
    lac_dataset_attributes(d, &(lac_laid){LAC_VARIABLES(beside, "", 0), made.part});
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const lac_laid laid = {{.row = &wrong[i], .rows = 1, .over = ""}, &made};
        assert_int_equal(lac_dataset_add(d, &laid, 1, &err), LAC_EINPUT);
    }
    const lac_laid many = {LAC_VARIABLES(of_parts, "row", 0), made.part};
    lac_status status = LAC_OK;
    for (size_t i = 0; i < LAC_MOST_ROWS && status == LAC_OK; i++) {
        status = lac_dataset_add(d, &many, 1, &err);
    }
    assert_int_equal(status, LAC_EINPUT);
    assert_non_null(strstr(err.message, "320"));
    lac_dataset_free(d);
}

static void test_empty_and_kept(void **state)
{
    static const lac_variable rows[] = {
        LAC_ROW("kept", "kept", "m", "", .value = product, .flags = LAC_EMPTY),
        LAC_ROW("left", "left", "m", "", .value = product)};
    (void)state;
    const lac_extent dims[] = {{"kept", 0}, {"left", 0}};
    const lac_laid laid = {LAC_VARIABLES(rows, "", 0), &made};
    lac_error err = {""};
    lac_dataset *d = NULL;
    lac_item item = {0};
    assert_int_equal(lac_dataset_create("empty", &d, &err), LAC_OK);
    assert_int_equal(lac_dataset_dims(d, dims, 2, &err), LAC_OK);
    assert_int_equal(lac_dataset_add(d, &laid, 1, &err), LAC_OK);
    assert_true(lac_dataset_find(d, "kept", &item) && item.count == 0);
    assert_false(lac_dataset_find(d, "left", &item));
    lac_dataset_free(d);
}

// Laid on many along two dimensions: words, dates and arrays of each.
static void test_many(void **state)
{
    typedef struct cell {
        char name[4];
        int kind;
        double when, pair[2];
    } cell;
    static const char *const kinds[] = {"open", NULL};
    static const cell cells[] = {{"a", 0, 0.0, {1, 2}},
                                 {"", 1, NAN, {3, 4}},
                                 {"c", 0, 86400.0, {5, 6}},
                                 {"d", 0, 1e15, {7, 8}}};
    static const lac_variable rows[] = {
        LAC_ROW("name", NULL, NULL, "", .json = "r[]/c[]/name", LAC_HELD(CHARS, cell, name),
                .flags = LAC_MISSING),
        {.json = "r[]/c[]/plain", LAC_HELD(CHARS, cell, name)},
        {.json = "r[]/c[]/kind", LAC_HELD(INT, cell, kind), .names = kinds},
        {.json = "r[]/c[]/number", LAC_HELD(INT, cell, kind)},
        {.json = "r[]/c[]/when", LAC_HELD(REAL, cell, when), .flags = LAC_DATE},
        LAC_ROW("pair", "row column two", "m", "", .json = "r[]/c[]/pair[]",
                LAC_HELD(REAL, cell, pair)),
    };
    static const char wanted[] =
        "{\"r\":[{\"c\":[{\"name\":\"a\",\"plain\":\"a\",\"kind\":\"open\",\"number\":0,"
        "\"when\":\"1970-01-02T00:00:00Z\",\"pair\":[1,2]},"
        "{\"name\":null,\"plain\":\"\",\"kind\":null,\"number\":1,\"when\":null,\"pair\":[3,4]}]},"
        "{\"c\":[{\"name\":\"c\",\"plain\":\"c\",\"kind\":\"open\",\"number\":0,"
        "\"when\":\"1970-01-03T00:00:00Z\",\"pair\":[5,6]},"
        "{\"name\":\"d\",\"plain\":\"d\",\"kind\":\"open\",\"number\":0,\"when\":null,"
        "\"pair\":[7,8]}]}]}";
    (void)state;
    const lac_extent dims[] = {{"row", 2}, {"column", 2}, {"two", 2}};
    const lac_laid laid = {LAC_VARIABLES(rows, "row column", sizeof(cell)), cells};
    double values[8];
    lac_error err = {""};
    lac_dataset *d = NULL;
    lac_item item = {0};
    assert_int_equal(lac_dataset_create("many", &d, &err), LAC_OK);
    d->clock = LAC_CLOCK_START;
    d->start = 86400.0;
    assert_int_equal(lac_dataset_dims(d, dims, 3, &err), LAC_OK);
    assert_int_equal(lac_dataset_add(d, &laid, 1, &err), LAC_OK);
    assert_true(lac_dataset_find(d, "pair", &item));
    lac_item_values(&item, values);
    for (size_t i = 0; i < 8; i++) {
        assert_true(values[i] == (double)i + 1.0);
    }
    assert_json(d, wanted);
    lac_dataset_free(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_json),           cmocka_unit_test(test_many),
        cmocka_unit_test(test_items),          cmocka_unit_test(test_file),
        cmocka_unit_test(test_what_cannot_be), cmocka_unit_test(test_empty_and_kept)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
