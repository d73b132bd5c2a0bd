// SPDX-License-Identifier: GPL-3.0-or-later
// Where the values of a run's file stand in it, and that no changed bit goes unseen there.
#define _GNU_SOURCE // memmem
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <netcdf.h>
#include <sys/wait.h>
#include <unistd.h>

#include "store/store.h"
#include "support/scratch_group.h"
#include "support/store_records.h"
#include "support/test.h"

#define VALUE 1.2345e6

enum { FEW = 3, MANY = 600 };

// A whole file with that many cells, two records and a snapshot.
static const char *write_file(const char *name, size_t cells)
{
    uint32_t index[MANY];
    double pressure[MANY];
    for (size_t i = 0; i < cells; i++) {
        index[i] = (uint32_t)i;
        pressure[i] = VALUE + (double)i;
    }
    lac_domain domain = {.grid = {.nx = MANY, .ny = 1, .dx = 0.5, .dy = 0.5},
                         .n = cells,
                         .index = index,
                         .pressure = pressure};
    lac_store_def def = store_def(scratch_path(&folder, name));
    def.of.domain = &domain;
    def.of.fields = LAC_FIELD_SLIP;
    def.compression = 1;
    lac_store *store = NULL;
    assert_int_equal(lac_store_create(&def, &store, NULL), LAC_OK);
    lac_sink sink = lac_store_sink(store);
    double slip[MANY] = {0};
    lac_snapshot snapshot = {.time = 1.0, .slip = slip};
    assert_int_equal(sink.snapshot(sink.context, &snapshot, NULL), LAC_OK);
    for (size_t i = 0; i < 2; i++) {
        lac_record record = record_of(i);
        assert_int_equal(sink.record(sink.context, &record, NULL), LAC_OK);
    }
    assert_int_equal(lac_store_finish(store, "complete", NULL, 1.0, NULL), LAC_OK);
    lac_store_free(store);
    return def.path;
}

static void expect_layout(int file, const char *name, int storage, bool deflated, bool summed)
{
    int id = 0;
    int found = 0;
    int deflate = 0;
    int fletcher = 0;
    assert_int_equal(nc_inq_varid(file, name, &id), NC_NOERR);
    assert_int_equal(nc_inq_var_chunking(file, id, &found, NULL), NC_NOERR);
    assert_int_equal(nc_inq_var_deflate(file, id, NULL, &deflate, NULL), NC_NOERR);
    assert_int_equal(nc_inq_var_fletcher32(file, id, &fletcher), NC_NOERR);
    if (found != storage || (deflate != 0) != deflated || (fletcher != 0) != summed) {
        fail_msg("%s: storage %d, deflate %d, Fletcher-32 %d", name, found, deflate, fletcher);
    }
}

static void small_variables_stand_in_their_headers(void **state)
{
    (void)state;
    int file = 0;
    assert_int_equal(nc_open(write_file("few.nc", FEW), NC_NOWRITE, &file), NC_NOERR);
    expect_layout(file, "x", NC_COMPACT, false, false);
    expect_layout(file, "pressure", NC_COMPACT, false, false);
    expect_layout(file, "time", NC_CHUNKED, false, false);
    expect_layout(file, "cell_slip", NC_CHUNKED, false, true);
    (void)nc_close(file);
    assert_int_equal(nc_open(write_file("many.nc", MANY), NC_NOWRITE, &file), NC_NOERR);
    expect_layout(file, "x", NC_CHUNKED, true, true);
    expect_layout(file, "pressure", NC_CHUNKED, true, true);
    expect_layout(file, "time", NC_CHUNKED, false, false);
    expect_layout(file, "cell_slip", NC_CHUNKED, true, true);
    (void)nc_close(file);
}

static bool read_pressure(const char *path)
{
    double pressure[FEW];
    int file = 0;
    int id = 0;
    return nc_open(path, NC_NOWRITE, &file) == NC_NOERR &&
           nc_inq_varid(file, "pressure", &id) == NC_NOERR &&
           nc_get_var_double(file, id, pressure) == NC_NOERR && pressure[0] == VALUE;
}

// In a process of its own: HDF5 keeps what it had read of a header that it refuses.
static bool reads(const char *path)
{
    int status = 0;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(read_pressure(path) ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status) == 0;
}

// Whichever bit of a value in a header is turned: HDF5's readers are told.
static void a_changed_bit_in_a_header_is_seen(void **state)
{
    (void)state;
    const double value = VALUE;
    size_t size = 0;
    unsigned char *bytes = scratch_read(write_file("sound.nc", FEW), &size);
    unsigned char *at = memmem(bytes, size, &value, sizeof value);
    assert_non_null(at);
    assert_true(reads(scratch_write(&folder, "same.nc", bytes, size)));
    for (unsigned bit = 0; bit < 8 * sizeof value; bit += 7) {
        at[bit / 8] ^= (unsigned char)(1U << bit % 8);
        assert_false(reads(scratch_write(&folder, "changed.nc", bytes, size)));
        at[bit / 8] ^= (unsigned char)(1U << bit % 8);
    }
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_variables_stand_in_their_headers),
        cmocka_unit_test(a_changed_bit_in_a_header_is_seen),
    };
    return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
