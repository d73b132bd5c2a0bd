// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <netcdf.h>
#include <sys/stat.h>

#include "lacuna/simulation.h"
#include "scene/scene.h"
#include "support/contact_file.h"
#include "support/scratch_group.h"
#include "support/store_records.h"
#include "support/test.h"

static lac_store *create(const lac_store_def *def)
{
    lac_error err = {{0}};
    lac_store *store = NULL;
    if (lac_store_create(def, &store, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return store;
}

static void write_records(lac_store *store, size_t count)
{
    lac_error err = {{0}};
    lac_sink sink = lac_store_sink(store);
    for (size_t i = 0; i < count; i++) {
        lac_record record = record_of(i);
        if (sink.record(sink.context, &record, &err) != LAC_OK) {
            fail_msg("%s", err.message);
        }
    }
}

static void expect_attribute(const char *path, const char *name, const char *expected)
{
    lac_error err = {{0}};
    char text[512];
    if (lac_store_read_attribute(path, name, text, sizeof text, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    assert_string_equal(text, expected);
}

static void expect_records(const char *path, size_t count)
{
    lac_error err = {{0}};
    size_t n = 0;
    if (check_records(path, &n, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    assert_int_equal(n, count);
}

// Every value comes back bit for bit, for batches that do and do not divide the number of records.
static void records_come_back(void **state)
{
    (void)state;
    const int64_t batches[] = {1, 7, 100, 512, 5000};
    for (size_t b = test_few() ? 3 : 0; b < sizeof batches / sizeof batches[0]; b++) {
        lac_store_def def = store_def(scratch_path(&folder, "round.nc"));
        def.sync_every = batches[b];
        def.force = true;
        lac_store *store = create(&def);
        write_records(store, 1301);
        lac_error err = {{0}};
        lac_run_result result = run_result();
        assert_int_equal(lac_store_finish(store, "complete", &result, 12.5, &err), LAC_OK);
        lac_store_free(store);
        expect_records(def.path, 1301);
    }
}

static void result_is_written(void **state)
{
    (void)state;
    lac_store_def def = store_def(scratch_path(&folder, "result.nc"));
    lac_store *store = create(&def);
    write_records(store, 3);
    lac_run_result result = run_result();
    assert_int_equal(lac_store_finish(store, "complete", &result, 12.5, NULL), LAC_OK);
    lac_store_free(store);
    expect_attribute(def.path, "status", "complete");
    expect_attribute(def.path, "failed", "1");
    expect_attribute(def.path, "failure_time_s", "8640000.75");
    expect_attribute(def.path, "failure_date", "1963-10-09T00:00:01Z"); // rounded to the second
    expect_attribute(def.path, "wall_time_s", "12.5");
    expect_attribute(def.path, "steps", "1234");
    expect_attribute(def.path, "seed", "-3");
    expect_attribute(def.path, "title", "A joint");
    expect_attribute(def.path, "Conventions", "CF-1.10 ACDD-1.3");
    expect_attribute(def.path, "date_created", "2001-09-09T01:46:40Z");
    expect_attribute(def.path, "history", "2001-09-09T01:46:40Z: lacuna run joint.yaml");
    expect_attribute(def.path, "case", "lacuna: 1\ntitle: A joint\n");
    char text[128];
    assert_int_equal(lac_store_read_attribute(def.path, "libraries", text, sizeof text, NULL),
                     LAC_OK);
    assert_non_null(strstr(text, "SUNDIALS 6.4.1, netCDF 4."));
    assert_int_equal(lac_store_read_attribute(def.path, "case", text, 8, NULL), LAC_EIO);
    assert_int_equal(lac_store_read_attribute(def.path, "nothing", text, sizeof text, NULL),
                     LAC_EIO);
}

static void missing_values_are_fill(void **state)
{
    (void)state;
    lac_store_def def = store_def(scratch_path(&folder, "fill.nc"));
    lac_store *store = create(&def);
    write_records(store, 2);
    lac_store_free(store);
    int id = 0;
    int step = 0;
    int order = 0;
    double first = 0.0;
    int first_order = 0;
    const size_t zero = 0;
    assert_int_equal(nc_open(def.path, NC_NOWRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "step_size", &step), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "order", &order), NC_NOERR);
    assert_int_equal(nc_get_var1_double(id, step, &zero, &first), NC_NOERR);
    assert_int_equal(nc_get_var1_int(id, order, &zero, &first_order), NC_NOERR);
    assert_true(first == NC_FILL_DOUBLE);
    assert_int_equal(first_order, NC_FILL_INT);
    (void)nc_close(id);
}

static void text_of(int id, int var, const char *name, char *text)
{
    size_t length = 0;
    assert_int_equal(nc_inq_attlen(id, var, name, &length), NC_NOERR);
    assert_true(length < 200);
    assert_int_equal(nc_get_att_text(id, var, name, text), NC_NOERR);
    text[length] = '\0';
}

static void expect_time_unit(bool dated, double date, const char *unit)
{
    lac_store_def def = store_def(scratch_path(&folder, "time.nc"));
    def.of.dated = dated;
    def.of.start_date = date;
    def.force = true;
    lac_store_free(create(&def));
    int id = 0;
    int var = 0;
    char text[200];
    assert_int_equal(nc_open(def.path, NC_NOWRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "time", &var), NC_NOERR);
    text_of(id, var, "units", text);
    assert_string_equal(text, unit);
    (void)nc_close(id);
}

static void time_has_its_unit(void **state)
{
    (void)state;
    expect_time_unit(false, 0.0, "s");
    expect_time_unit(true, 0.0, "seconds since 1970-01-01 00:00:00");
    expect_time_unit(true, -205286400.0, "seconds since 1963-07-01 00:00:00");
    expect_time_unit(true, -205286399.75, "seconds since 1963-07-01 00:00:00.250000");
    expect_time_unit(true, 59.9999997, "seconds since 1970-01-01 00:01:00");
    lac_store_def def = store_def(scratch_path(&folder, "far.nc"));
    def.of.dated = true;
    def.of.start_date = 1e15;
    lac_store *store = NULL;
    assert_int_equal(lac_store_create(&def, &store, NULL), LAC_EINPUT);
    assert_null(store);
}

static void existing_file_is_kept(void **state)
{
    (void)state;
    const char *path = scratch_write(&folder, "old.nc", "precious", 8);
    size_t files = scratch_count(&folder);
    lac_store_def def = store_def(path);
    lac_store *store = NULL;
    lac_error err = {{0}};
    assert_int_equal(lac_store_create(&def, &store, &err), LAC_EINPUT);
    assert_null(store);
    assert_non_null(strstr(err.message, "old.nc: exists"));
    // one that cannot be made leaves it too, and nothing beside it
    def.force = true;
    def.of.start_date = 1e15;
    assert_int_equal(lac_store_create(&def, &store, &err), LAC_EINPUT);
    size_t size = 0;
    unsigned char *bytes = scratch_read(path, &size);
    assert_int_equal(size, 8);
    assert_memory_equal(bytes, "precious", 8);
    free(bytes);
    assert_int_equal(scratch_count(&folder), files);
    def.of.start_date = 0.0;
    lac_store_free(create(&def));
    expect_records(path, 0);
    assert_int_equal(scratch_count(&folder), files);
}

static void bad_paths_are_refused(void **state)
{
    (void)state;
    const struct {
        const char *path, *says;
    } cases[] = {
        {"", "empty"},
        {folder.folder, "is a folder"},
        {"/dev/null", "not a regular file"},
        {"/nowhere/at/all/out.nc", "No such file or directory"},
        {"/dev/null/out.nc", "Not a directory"},
        {"http://127.0.0.1:9/out.nc", "is an address"},
        {"file:///tmp/out.nc#mode=zarr", "is an address"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        lac_store_def def = store_def(cases[i].path);
        def.force = true;
        lac_store *store = NULL;
        lac_error err = {{0}};
        assert_int_equal(lac_store_create(&def, &store, &err), LAC_EIO);
        assert_null(store);
        assert_non_null(strstr(err.message, cases[i].says));
        double *values = NULL;
        size_t n = 0;
        assert_int_equal(read_over_time(cases[i].path, "slip", &values, &n, &err), LAC_EIO);
        assert_null(values);
    }
    struct stat info;
    assert_int_equal(stat("/dev/null", &info), 0);
    assert_true(S_ISCHR(info.st_mode));
}

static void unfinished_store_is_running(void **state)
{
    (void)state;
    lac_store_def def = store_def(scratch_path(&folder, "unfinished.nc"));
    lac_store *store = create(&def);
    write_records(store, 150);
    lac_store_free(store);
    lac_store_free(NULL);
    expect_attribute(def.path, "status", "running");
    expect_records(def.path, 150);
}

static void bad_records_are_refused(void **state)
{
    (void)state;
    lac_store_def def = store_def(scratch_path(&folder, "bad.nc"));
    lac_store *store = create(&def);
    write_records(store, 3);
    lac_error err = {{0}};
    lac_sink sink = lac_store_sink(store);
    lac_record again = record_of(2);
    assert_int_equal(sink.record(sink.context, &again, &err), LAC_OK); // the same instant: dropped
    lac_record past = record_of(1);
    assert_int_equal(sink.record(sink.context, &past, &err), LAC_ENUMERIC);
    lac_record odd = record_of(4);
    odd.observation.mean_rate = NAN;
    assert_int_equal(sink.record(sink.context, &odd, &err), LAC_ENUMERIC);
    assert_non_null(strstr(err.message, "slip_rate"));
    lac_store_free(store);
    expect_records(def.path, 3);
}

// Fields that were not asked for do not exist; those that were are chunked one snapshot at a time.
static void snapshots_hold_what_was_asked(void **state)
{
    (void)state;
    uint32_t index[3] = {0, 5, 6};
    double pressure[3] = {1e6, 2e6, 3e6};
    lac_domain domain = {.grid = {.nx = 4, .ny = 4, .dx = 0.5, .dy = 0.5, .periodic = true},
                         .n = 3,
                         .index = index,
                         .pressure = pressure};
    lac_store_def def = store_def(scratch_path(&folder, "cells.nc"));
    def.of.domain = &domain;
    def.of.fields = LAC_FIELD_SLIP | LAC_FIELD_TRACTION;
    lac_store *store = create(&def);
    lac_sink sink = lac_store_sink(store);
    for (int i = 0; i < 4; i++) {
        double slip[3] = {i + 0.25, i + 0.5, i + 0.75};
        double traction[3] = {-i - 0.25, -i - 0.5, -i - 0.75};
        lac_snapshot snapshot = {.time = 10.0 * i, .slip = slip, .traction = traction};
        assert_int_equal(sink.snapshot(sink.context, &snapshot, NULL), LAC_OK);
    }
    assert_int_equal(lac_store_finish(store, "complete", NULL, 1.0, NULL), LAC_OK);
    lac_store_free(store);

    int id = 0;
    int var = 0;
    int storage = 0;
    size_t chunk[2] = {0, 0};
    double values[12];
    assert_int_equal(nc_open(def.path, NC_NOWRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "cell_state", &var), NC_ENOTVAR);
    assert_int_equal(nc_inq_varid(id, "cell_traction", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_true(values[11] == -3.75 && values[1] == -0.5);
    assert_int_equal(nc_inq_varid(id, "cell_slip", &var), NC_NOERR);
    assert_int_equal(nc_inq_var_chunking(id, var, &storage, chunk), NC_NOERR);
    assert_true(storage == NC_CHUNKED && chunk[0] == 1 && chunk[1] == 3);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_true(values[0] == 0.25 && values[11] == 3.75);
    assert_int_equal(nc_inq_varid(id, "snapshot_time", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_true(values[3] == 30.0);
    assert_int_equal(nc_inq_varid(id, "x", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_true(values[0] == 0.25 && values[1] == 0.75 && values[2] == 1.25);
    assert_int_equal(nc_inq_varid(id, "y", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_true(values[0] == 0.25 && values[1] == 0.75 && values[2] == 0.75);
    (void)nc_close(id);
}

static void levels_are_named(void **state)
{
    (void)state;
    uint32_t index[3] = {0, 5, 6};
    double pressure[3] = {1e6, 2e6, 3e6};
    lac_domain domain = {.grid = {.nx = 4, .ny = 4, .dx = 0.5, .dy = 0.5, .periodic = true},
                         .n = 3,
                         .index = index,
                         .pressure = pressure};
    lac_hierarchy *hierarchy = NULL;
    assert_int_equal(lac_hierarchy_create(&domain, &hierarchy, NULL), LAC_OK);
    lac_store_def def = store_def(scratch_path(&folder, "levels.nc"));
    def.of.domain = &domain;
    def.of.hierarchy = hierarchy;
    lac_store_free(create(&def));
    lac_hierarchy_free(hierarchy);

    // cells (0,0) and (1,1) share a block of two, (2,1) stands alone: 3, 2, 1 blocks
    const long long blocks[3] = {3, 2, 1};
    const double sides[3] = {0.5, 1.0, 2.0};
    int id = 0;
    int var = 0;
    long long total[3];
    double size[3];
    assert_int_equal(nc_open(def.path, NC_NOWRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "n_tot", &var), NC_NOERR);
    assert_int_equal(nc_get_var_longlong(id, var, total), NC_NOERR);
    assert_memory_equal(total, blocks, sizeof blocks);
    assert_int_equal(nc_inq_varid(id, "block_size", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, size), NC_NOERR);
    assert_memory_equal(size, sides, sizeof sides);
    (void)nc_close(id);
}

static void contact_maps_come_back(void **state)
{
    (void)state;
    enum { NX = 6, NY = 4 };
    double heights[NX * NY];
    double gap[NX * NY];
    double pressure[NX * NY];
    for (size_t i = 0; i < NX * NY; i++) {
        heights[i] = (double)i;
        gap[i] = 0.5 * (double)i;
        pressure[i] = i % 3 == 0 ? 1e6 : 0.0;
    }
    const lac_grid grid = {.nx = NX, .ny = NY, .dx = 2.0, .dy = 2.0, .periodic = true};
    const lac_contact_stats report = {
        .n_cells = 8, .iterations = 17, .max_pressure = 1e6, .approach = -0.5};
    const lac_box_count boxes = {.sizes = 3,
                                 .side = {1, 2, 4},
                                 .count = {8, 5, 2},
                                 .minimum = {8, 4, 2},
                                 .fit_last = 2,
                                 .dimension = 1.5,
                                 .error = 0.1};
    const char *path = scratch_path(&folder, "contact.nc");
    lac_scene_contact contact = {.grid = grid,
                                 .heights = heights,
                                 .gap = gap,
                                 .pressure = pressure,
                                 .solved = true,
                                 .report = report,
                                 .counted = true,
                                 .boxes = boxes};
    assert_int_equal(contact_file(&contact, path, false, NULL, NULL), LAC_OK);
    assert_int_equal(contact_file(&contact, path, false, NULL, NULL), LAC_EINPUT);
    expect_attribute(path, "status", "complete");
    expect_attribute(path, "iterations", "17");
    expect_attribute(path, "d_box", "1.5");
    int id = 0;
    int var = 0;
    double values[NX * NY];
    assert_int_equal(nc_open(path, NC_NOWRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "pressure", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_memory_equal(values, pressure, sizeof pressure);
    assert_int_equal(nc_inq_varid(id, "heights", &var), NC_NOERR);
    assert_int_equal(nc_get_var_double(id, var, values), NC_NOERR);
    assert_memory_equal(values, heights, sizeof heights);
    (void)nc_close(id);

    // a domain without a surface
    path = scratch_path(&folder, "domain.nc");
    contact = (lac_scene_contact){.grid = grid, .pressure = pressure};
    assert_int_equal(contact_file(&contact, path, false, NULL, NULL), LAC_OK);
    assert_int_equal(nc_open(path, NC_NOWRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "heights", &var), NC_ENOTVAR);
    (void)nc_close(id);
}

// Other programs may add to a file: HDF5 then takes the seal off.
static void edited_file_is_read(void **state)
{
    (void)state;
    lac_store_def def = store_def(scratch_path(&folder, "edited.nc"));
    lac_store *store = create(&def);
    write_records(store, 50);
    assert_int_equal(lac_store_finish(store, "complete", NULL, 1.0, NULL), LAC_OK);
    lac_store_free(store);
    int id = 0;
    assert_int_equal(nc_open(def.path, NC_WRITE, &id), NC_NOERR);
    assert_int_equal(nc_put_att_text(id, NC_GLOBAL, "note", 4, "mine"), NC_NOERR);
    assert_int_equal(nc_close(id), NC_NOERR);
    expect_attribute(def.path, "note", "mine");
    expect_records(def.path, 50);
}

static void long_case_text_is_whole(void **state)
{
    (void)state;
    enum { LONG = 300000 };
    char *text = malloc(LONG + 1);
    char *back = malloc(LONG + 1);
    assert_true(text != NULL && back != NULL);
    memset(text, 'y', LONG);
    text[LONG] = '\0';
    lac_store_def def = store_def(scratch_path(&folder, "long.nc"));
    def.provenance.case_text = text;
    lac_store_free(create(&def));
    assert_int_equal(lac_store_read_attribute(def.path, "case", back, LONG + 1, NULL), LAC_OK);
    assert_string_equal(back, text);
    free(text);
    free(back);
}

static void other_files_are_refused(void **state)
{
    (void)state;
    double *values = NULL;
    size_t n = 0;
    lac_error err = {{0}};
    const char *text = scratch_write(&folder, "text.nc", "time,slip\n", 10);
    assert_int_equal(read_over_time(text, "slip", &values, &n, &err), LAC_EIO);
    const char *empty = scratch_write(&folder, "empty.nc", "", 0);
    assert_int_equal(read_over_time(empty, "slip", &values, &n, &err), LAC_EIO);
    const char *other = scratch_path(&folder, "other.nc");
    int id = 0;
    assert_int_equal(nc_create(other, NC_NETCDF4, &id), NC_NOERR);
    assert_int_equal(nc_close(id), NC_NOERR);
    assert_int_equal(read_over_time(other, "slip", &values, &n, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "not a file of Lacuna"));
    lac_store_def def = store_def(scratch_path(&folder, "mine.nc"));
    lac_store_free(create(&def));
    assert_int_equal(read_over_time(def.path, "slop", &values, &n, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "no variable slop"));
    assert_null(values);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(records_come_back),
        cmocka_unit_test(result_is_written),
        cmocka_unit_test(missing_values_are_fill),
        cmocka_unit_test(time_has_its_unit),
        cmocka_unit_test(existing_file_is_kept),
        cmocka_unit_test(bad_paths_are_refused),
        cmocka_unit_test(unfinished_store_is_running),
        cmocka_unit_test(bad_records_are_refused),
        cmocka_unit_test(snapshots_hold_what_was_asked),
        cmocka_unit_test(levels_are_named),
        cmocka_unit_test(contact_maps_come_back),
        cmocka_unit_test(edited_file_is_read),
        cmocka_unit_test(long_case_text_is_whole),
        cmocka_unit_test(other_files_are_refused),
    };
    return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
