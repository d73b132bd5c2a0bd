// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of other people's netCDF files share.
#include <math.h>
#include <netcdf.h>
#include <stdio.h>
#include <string.h>

#include "base/netcdf.h"
#include "support/test.h"

// A file in memory with one variable of three numbers, of which the first two are written.
static int open_file(nc_type type, int *var)
{
    int id = 0;
    int dim = 0;
    const size_t start = 0, two = 2;
    assert_int_equal(nc_create("memory.nc", NC_NETCDF4 | NC_DISKLESS, &id), NC_NOERR);
    assert_int_equal(nc_def_dim(id, "x", 3, &dim), NC_NOERR);
    assert_int_equal(nc_def_var(id, "v", type, 1, &dim, var), NC_NOERR);
    assert_int_equal(nc_enddef(id), NC_NOERR);
    assert_int_equal(nc_put_vara_double(id, *var, &start, &two, (double[]){1.0, 7.0}), NC_NOERR);
    return id;
}

static void what_was_never_written_is_missing(void **state)
{
    (void)state;
    static const nc_type types[] = {NC_SHORT,  NC_INT,  NC_FLOAT, NC_DOUBLE,
                                    NC_USHORT, NC_UINT, NC_INT64, NC_UINT64};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        int var = 0;
        double x[3];
        int id = open_file(types[i], &var);
        assert_int_equal(nc_get_var_double(id, var, x), NC_NOERR);
        lac_netcdf_unpack(id, var, x, 3);
        assert_true(x[0] == 1.0 && x[1] == 7.0 && isnan(x[2]));
        assert_int_equal(nc_close(id), NC_NOERR);
    }
}

static void attributes_unpack(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double value;
    } numbers[] = {{"missing_value", 7.0}, {"scale_factor", 0.5}, {"add_offset", -3.0}};
    int var = 0;
    double x[3];
    int id = open_file(NC_DOUBLE, &var);
    for (size_t i = 0; i < 3; i++) {
        (void)nc_put_att_double(id, var, numbers[i].name, NC_FLOAT, 1, &numbers[i].value);
    }
    assert_int_equal(nc_get_var_double(id, var, x), NC_NOERR);
    lac_netcdf_unpack(id, var, x, 3);
    assert_true(x[0] == -2.5 && isnan(x[1]) && isnan(x[2]));
    assert_true(lac_netcdf_number(id, var, "scale_factor", 9.0) == 0.5);
    assert_true(lac_netcdf_number(id, var, "absent", 9.0) == 9.0);
    (void)nc_put_att_double(id, var, "two", NC_DOUBLE, 2, (double[]){1.0, 2.0});
    assert_true(lac_netcdf_number(id, var, "two", 9.0) == 9.0);
    assert_int_equal(nc_close(id), NC_NOERR);
}

static void texts_are_characters_or_strings_that_fit(void **state)
{
    (void)state;
    const char *string = "mm/day";
    char text[8] = "before";
    int var = 0;
    int id = open_file(NC_DOUBLE, &var);
    lac_netcdf_text(id, var, "absent", text, sizeof text);
    assert_string_equal(text, "");
    (void)nc_put_att_text(id, var, "units", 3, "kPa");
    lac_netcdf_text(id, var, "units", text, sizeof text);
    assert_string_equal(text, "kPa");
    (void)nc_put_att_string(id, var, "string", 1, &string);
    lac_netcdf_text(id, var, "string", text, sizeof text);
    assert_string_equal(text, "mm/day");
    lac_netcdf_text(id, var, "string", text, 6); // one short of it
    assert_string_equal(text, "");
    (void)nc_put_att_text(id, var, "long", 8, "12345678");
    lac_netcdf_text(id, var, "long", text, sizeof text);
    assert_string_equal(text, "");
    assert_int_equal(nc_close(id), NC_NOERR);
}

static void files_begin_so(void **state)
{
    (void)state;
    assert_true(lac_netcdf_begins("\x89HDF", 4) && lac_netcdf_begins("CDF\x05...", 7));
    assert_false(lac_netcdf_begins("CDF\x03", 4) || lac_netcdf_begins("CDF", 3));
    assert_false(lac_netcdf_begins("", 0) || lac_netcdf_begins("lacu", 4));
}

// Of many variables, or of long names, whole ones are named: a part would be no name, nor UTF-8.
static void names_that_are_said_are_whole(void **state)
{
    (void)state;
    char name[NC_MAX_NAME + 1];
    int id = 0, var = 0;
    lac_error err;
    assert_int_equal(nc_create("memory.nc", NC_NETCDF4 | NC_DISKLESS, &id), NC_NOERR);
    assert_int_equal(nc_def_var(id, "v", NC_INT, 0, NULL, &var), NC_NOERR);
    for (int i = 0; i < 100; i++) {
        (void)snprintf(name, sizeof name, "variable_%03d", i);
        assert_int_equal(nc_def_var(id, name, NC_INT, 0, NULL, &var), NC_NOERR);
    }
    assert_int_equal(lac_netcdf_find("many.nc", id, "variable_099", &var, &err), LAC_OK);
    assert_int_equal(lac_netcdf_find("many.nc", id, "w", &var, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "its variables are v, "));
    const char *end = err.message + strlen(err.message) - strlen(", ...");
    assert_string_equal(end, ", ...");
    const char *last = end - strlen("variable_000");
    assert_int_equal(strncmp(last, "variable_", 9), 0);
    assert_int_equal(nc_close(id), NC_NOERR);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_never_written_is_missing),
        cmocka_unit_test(attributes_unpack),
        cmocka_unit_test(texts_are_characters_or_strings_that_fit),
        cmocka_unit_test(files_begin_so),
        cmocka_unit_test(names_that_are_said_are_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
