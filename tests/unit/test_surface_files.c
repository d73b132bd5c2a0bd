// SPDX-License-Identifier: GPL-3.0-or-later
// Files of heights: every format against heights known beforehand, and what is refused.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>
#include <netcdf.h>

#include "lacuna/surface.h"
#include "support/scratch.h"

static scratch files;

// The map of every test: 3 columns, 2 rows; y upwards.
//    4 5 6   y = 1
//    1 2 3   y = 0
static const double known[6] = {1, 2, 3, 4, 5, 6};

static lac_height_map *read_bytes(const void *bytes, size_t size)
{
    lac_error err = {""};
    lac_height_map *map = NULL;
    if (lac_height_map_read(scratch_write(&files, "heights", bytes, size), &map, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return map;
}

static lac_height_map *read_text(const char *text) { return read_bytes(text, strlen(text)); }

static void holds_known(lac_height_map *map, double dx, double dy)
{
    assert_int_equal(map->nx, 3);
    assert_int_equal(map->ny, 2);
    assert_true(isnan(dx) ? isnan(map->dx) : fabs(map->dx - dx) < 1e-12 * dx);
    assert_true(isnan(dy) ? isnan(map->dy) : fabs(map->dy - dy) < 1e-12 * dy);
    for (size_t i = 0; i < 6; i++) {
        assert_true(fabs(map->heights[i] - known[i]) < 1e-12);
    }
    assert_int_equal(map->masked, 0);
    lac_height_map_free(map);
}

// A .npy of version 1 with the header padded as NumPy pads it.
static size_t npy(unsigned char *file, const char *header, const void *data, size_t size)
{
    memcpy(file, "\x93NUMPY\x01\x00\x76\x00", 10);
    memset(file + 10, ' ', 118);
    memcpy(file + 10, header, strlen(header));
    file[127] = '\n';
    memcpy(file + 128, data, size);
    return 128 + size;
}

static void npy_of_every_type(void **state)
{
    (void)state;
    unsigned char file[256] = {0};
    size_t n = npy(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", known, 48);
    holds_known(read_bytes(file, n), NAN, NAN);
    const double columns[6] = {1, 4, 2, 5, 3, 6};
    n = npy(file, "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", columns, 48);
    holds_known(read_bytes(file, n), NAN, NAN);
    const float narrow[6] = {1, 2, 3, 4, 5, 6};
    n = npy(file, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", narrow, 24);
    holds_known(read_bytes(file, n), NAN, NAN);
    n = npy(file, "{'descr': '>i2', 'fortran_order': False, 'shape': (2, 3), }",
            "\0\1\0\2\0\3\0\4\0\5\0\6", 12);
    holds_known(read_bytes(file, n), NAN, NAN);
    n = npy(file, "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }", "\1\2\3\4\5\6", 6);
    holds_known(read_bytes(file, n), NAN, NAN);
    n = npy(file, "{'descr': '|i1', 'fortran_order': False, 'shape': (2,), }", "\xff\x80", 2);
    lac_height_map *map = read_bytes(file, n);
    assert_int_equal(map->ny, 1);
    assert_true(map->heights[0] == -1.0 && map->heights[1] == -128.0);
    lac_height_map_free(map);
}

// NumPy itself writes; the heights are a formula that this file repeats.
static void npy_written_by_numpy(void **state)
{
    (void)state;
    const char *types[] = {"<f8", ">f8", "<f4", ">f4", "<i8", ">i4", "<u2", "|i1"};
    char command[512];
    for (size_t t = 0; t < 16; t++) {
        char path[160];
        (void)snprintf(path, sizeof path, "%s", scratch_path(&files, "numpy.npy"));
        (void)snprintf(command, sizeof command,
                       "/usr/bin/python3 -c \"import numpy as n; a = n.add.outer(7 * n.arange(5), "
                       "n.arange(4)).astype('%s'); n.save('%s', a.copy('%s'))\" 2>/dev/null",
                       types[t % 8], path, t < 8 ? "C" : "F");
        if (system(command) != 0) {
            skip();
        }
        lac_error err = {""};
        lac_height_map *map = NULL;
        assert_int_equal(lac_height_map_read(path, &map, &err), LAC_OK);
        assert_true(map->nx == 4 && map->ny == 5);
        for (size_t i = 0; i < 20; i++) {
            assert_true(map->heights[i] == (double)(7 * (i / 4) + i % 4));
        }
        lac_height_map_free(map);
    }
}

#define ASC "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0.5\nNODATA_value -9999\n"

static void ascii_grid(void **state)
{
    (void)state;
    holds_known(read_text(ASC "4 5 6\n1 2 3\n"), 0.5, 0.5);
    holds_known(read_text(ASC "4 5 6\n1 2 3"), 0.5, 0.5);
    holds_known(read_text("\xef\xbb\xbf" ASC "  4.0e0 +5. 60e-1\n\n1 2\n3\n\n"), 0.5, 0.5);
    holds_known(read_text("NCOLS 3\r\nNROWS 2\r\ndx 0.5\r\ndy 2\r\n4 5 6\r\n1 2 3\r\n"), 0.5, 2.0);
    lac_height_map *map = read_text(ASC "-9999 5 nan\n1 2 -9999.0\n");
    assert_int_equal(map->masked, 3);
    assert_true(isnan(map->heights[2]) && isnan(map->heights[3]) && map->heights[4] == 5.0);
    lac_height_map_free(map);
}

static void gridded_points(void **state)
{
    (void)state;
    const char *shuffled = "# x y z\n1 10 2\n0 12 4\n2 10 3\n0 10 1\n2 12 6\n1 12 5\n";
    holds_known(read_text(shuffled), 1.0, 2.0);
    holds_known(read_text("x,y,z\r\n0,0,1\r\n1,0,2\r\n2,0,3\r\n0,1,4\r\n1,1,5\r\n2,1,6\r\n"), 1.0,
                1.0);
    holds_known(read_text("0;0;1\n1;0;2\n2;0;3\n0;1;4\n1;1;5\n2;1;6"), 1.0, 1.0);
    // thirds, rounded
    holds_known(read_text("0 0 1\n.33 0 2\n.67 0 3\n0 1 4\n.33 1 5\n.67 1 6\n"), 0.335, 1.0);
    lac_height_map *map = read_text("0 0 1\n1 0 2\n3 0 4\n0 1 nan\n1 1 6\n3 1 8\n");
    assert_true(map->nx == 4 && map->ny == 2 && map->masked == 3 && map->dx == 1.0);
    assert_true(isnan(map->heights[2]) && map->heights[3] == 4.0 && map->heights[7] == 8.0);
    lac_height_map_free(map);
}

static size_t gsf(unsigned char *file, const char *header, size_t heights)
{
    static const float rows[6] = {4, 5, 6, 1, 2, 3};
    size_t n = strlen(header);
    size_t start = n + 4 - n % 4;
    memset(file, 0, start);
    memcpy(file, header, n);
    memcpy(file + start, rows, heights * sizeof(float));
    return start + heights * sizeof(float);
}

#define GSF "Gwyddion Simple Field 1.0\nXRes = 3\nYRes = 2\n"

static void gwyddion_field(void **state)
{
    (void)state;
    unsigned char file[512] = {0};
    for (size_t pad = 0; pad < 4; pad++) {
        char header[256];
        (void)snprintf(header, sizeof header, GSF "XReal = 1.5e-6\nYReal=1e-6\nTitle = %.*s\n",
                       (int)pad + 1, "abcd");
        holds_known(read_bytes(file, gsf(file, header, 6)), 0.5e-6, 0.5e-6);
    }
    lac_height_map *map =
        read_bytes(file, gsf(file, GSF "XYUnits = um\nZUnits = nm\nXReal = 3\nYReal = 2\n", 6));
    assert_string_equal(map->lateral_unit, "um");
    assert_string_equal(map->height_unit, "nm");
    lac_height_map_free(map);
    holds_known(read_bytes(file, gsf(file, GSF, 6)), NAN, NAN);
}

#define SDF_HEAD                                                                                 \
    "aBCR-1.0\nManufacID = test\nNumPoints = 3\nNumProfiles = 2\nXscale = 1e-3\nYscale = 2e-3\n" \
    "Zscale = 0.5\nZresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n"
#define SDF SDF_HEAD "*\n"

static size_t binary_sdf(unsigned char *file, unsigned type, const void *data, size_t size)
{
    const double scales[4] = {1e-3, 2e-3, 0.5, -1.0};
    memset(file, ' ', 42);
    memcpy(file, "bISO-1.0", 8);
    memcpy(file + 42, "\3\0\2\0", 4);
    memcpy(file + 46, scales, 32);
    file[78] = 0;
    file[79] = (unsigned char)type;
    file[80] = 0;
    memcpy(file + 81, data, size);
    return 81 + size;
}

static void iso_sdf(void **state)
{
    (void)state;
    unsigned char file[256] = {0};
    holds_known(read_text(SDF "2 4 6\n8 10 12\n*\nComment = none\n"), 1e-3, 2e-3);
    holds_known(read_text(SDF "2 4 6 8\r\n10 12"), 1e-3, 2e-3);
    const int16_t whole[6] = {2, 4, 6, 8, 10, 12};
    holds_known(read_bytes(file, binary_sdf(file, 5, whole, 12)), 1e-3, 2e-3);
    const double reals[6] = {2, 4, 6, 8, 10, 12};
    holds_known(read_bytes(file, binary_sdf(file, 7, reals, 48)), 1e-3, 2e-3);
    const int16_t bad[6] = {INT16_MIN, 4, 6, 8, 10, -12};
    lac_height_map *map = read_bytes(file, binary_sdf(file, 5, bad, 12));
    assert_true(map->masked == 1 && isnan(map->heights[0]) && map->heights[5] == -6.0);
    assert_string_equal(map->height_unit, "m");
    lac_height_map_free(map);
    map = read_text(SDF "2 4 BAD\n8 10 12\n*\n");
    assert_true(map->masked == 1 && isnan(map->heights[2]));
    lac_height_map_free(map);
}

// z over (a, b) with coordinates; a is written downwards where `down` is set.
static const char *write_netcdf(const char *var, const char *a, size_t na, const char *b, size_t nb,
                                bool down, const double *z, int mode)
{
    const char *path = scratch_path(&files, "grid.nc");
    int id = 0;
    int dim[2];
    int v[3];
    double x[8];
    (void)remove(path);
    assert_int_equal(nc_create(path, mode, &id), NC_NOERR);
    (void)nc_def_dim(id, a, na, &dim[0]);
    (void)nc_def_dim(id, b, nb, &dim[1]);
    (void)nc_def_var(id, a, NC_DOUBLE, 1, &dim[0], &v[0]);
    (void)nc_def_var(id, b, NC_DOUBLE, 1, &dim[1], &v[1]);
    (void)nc_def_var(id, var, NC_DOUBLE, 2, dim, &v[2]);
    (void)nc_put_att_text(id, v[0], "units", 2, "mm");
    (void)nc_put_att_text(id, v[2], "units", 2, "um");
    (void)nc_enddef(id);
    for (size_t i = 0; i < 8; i++) {
        x[i] = 0.5 * (down ? -(double)i : (double)i);
    }
    (void)nc_put_var_double(id, v[0], x);
    for (size_t i = 0; i < 8; i++) {
        x[i] = 0.5 * (double)i;
    }
    (void)nc_put_var_double(id, v[1], x);
    (void)nc_put_var_double(id, v[2], z);
    assert_int_equal(nc_close(id), NC_NOERR);
    return path;
}

static void netcdf_grid(void **state)
{
    (void)state;
    const double columns[6] = {1, 4, 2, 5, 3, 6};
    const double down[6] = {4, 5, 6, 1, 2, 3};
    lac_error err = {""};
    lac_height_map *map = NULL;
    for (int k = 0; k < 2; k++) {
        int mode = k == 0 ? NC_NETCDF4 : NC_CLOBBER;
        const char *path = write_netcdf("z", "y", 2, "x", 3, false, known, mode);
        assert_int_equal(lac_height_map_read(path, &map, &err), LAC_OK);
        assert_string_equal(map->lateral_unit, "mm");
        assert_string_equal(map->height_unit, "um");
        holds_known(map, 0.5, 0.5);
        path = write_netcdf("elevation", "lat", 2, "lon", 3, true, down, mode);
        assert_int_equal(lac_height_map_read(path, &map, &err), LAC_OK);
        holds_known(map, 0.5, 0.5);
        path = write_netcdf("heights", "x", 3, "y", 2, false, columns, mode);
        assert_int_equal(lac_height_map_read(path, &map, &err), LAC_OK);
        holds_known(map, 0.5, 0.5);
    }
}

typedef struct mess {
    const char *text, *word; ///< content and what the message must say
} mess;

static const mess messes[] = {
    {"", "empty"},
    {"hello\n", "none of the formats"},
    {"\xff\xfe\x31", "UTF-16"},
    {"ncols 3\nrows 2\n", "no key"},
    {"ncols 3\n1 2 3\n", "without nrows"},
    {"nrows 3\n1 2 3\n", "without ncols"},
    {"ncols 3\nnrows 2\n1 2 3\n4 5 6\n", "cellsize"},
    {"ncols 3\nnrows 2\ndx 1\n1 2 3\n4 5 6\n", "dx and dy"},
    {"ncols 3\nnrows 2\ncellsize 1\ndx 1\ndy 1\n1 2 3\n4 5 6\n", "not both"},
    {"ncols 3\nncols 3\n", ":2: ncols stands in line 1"},
    {"ncols\nnrows 2\n", ":1: ncols must have one value"},
    {"ncols 3 4\n", "one value"},
    {"ncols -3\n", "whole number"},
    {"ncols 0\n", "whole number"},
    {"ncols 2.5\n", "whole number"},
    {"ncols 1e30\n", "whole number"},
    {"ncols nan\n", "whole number"},
    {"ncols 0x3\n", "not a number"},
    {"ncols 3\nnrows 2\ncellsize 0\n1", "> 0"},
    {"ncols 3\nnrows 2\ncellsize -1\n1", "> 0"},
    {"ncols 3\nnrows 2\ncellsize 0,5\n1", "decimal point"},
    {"ncols 3000000000\nnrows 3000000000\ncellsize 1\n1", "at most"},
    {"ncols 9007199254740992\nnrows 9007199254740992\ncellsize 1\n1", "at most"},
    {"ncols 10000\nnrows 10000\ncellsize 1\n1 2 3\n", "hold at most"},
    {ASC "4 5 6\n1 2\n", "after 5 numbers"},
    {ASC "4 5 6\n1 2 3\n7\n", ":9: \"7\" comes after all"},
    {ASC "4 5 6 1\n2 3\n", "a line must end"},
    {ASC "4 5 x\n1 2 3\n", ":7: \"x\" is not a number"},
    {ASC "4 5 6,5\n1 2 3\n", "decimal point"},
    {ASC "4 5 inf\n1 2 3\n", "not a number"},
    {ASC "4 5 1e999\n1 2 3\n", "too large"},
    {ASC "4 5 --\n1 2 3\n", "not a number"},
    {ASC "-9999 nan nan\nnan nan nan\n", "all 6 heights are missing"},
    {"# nothing\n1 2\n", "fewer than three"},
    {"1 2 3 4\n", "more than three"},
    {"1,5 2,5 3,5\n", "decimal point"},
    {"nan 0 1\n", "x is nan"},
    {"0 0 1\n1 0 2\n0 0 3\n1 1 1\n", ":3: the point"},
    {"0 0 1\n1 0 2\n2.5 0 3\n7.1 0 2\n", "off the grid"},
    {"0 0 1\n1 1 1\n2 2 1\n3 3 1\n4 4 1\n5 5 1\n6 6 1\n7 7 1\n8 8 1\n", "must be gridded"},
    {"-1e308 0 1\n1e308 0 1\n", "no grid is that large"},
    {"1 2 \x01\n", "not a number"},
    {"x y z\n", "without a point"},
    {"Gwyddion Simple Field 1.0\nXRes = 3\n", "without the NUL"},
    {"aBCR-1.0\nNumPoints = 3\n", "without the *"},
    {"aBCR-1.0\nNumPoints 3\n", "neither key"},
    {"aBCR-1.0\n*\n1", "Xscale"},
    {"aBCR-1.0\nXscale = -1\n", "> 0"},
    {"aBCR-1.0\nXscale = \n", "not a number"},
    {SDF_HEAD "Compression = 1\n*\n1 2 3\n", "Compression"},
    {SDF "2 4 6\n8 10\n*\n", "end after 5"},
    {SDF "2 4 6\n8 10 12 13\n*\n", "\"13\" comes after all"},
    {SDF "2 4 6\n8 10 12;\n*\n", "not a number"},
    {"aBCR-1.0\nNumPoints = 65535\nNumProfiles = 65535\nXscale = 1\nYscale = 1\nZscale = 1\n*\n1 2",
     "at most"},
    {"bBCR-1.0  short", "inside its header"},
    {"\x89HDF\r\n\x1a\nxxxxxxxxx", "netCDF cannot read"},
    {"CDF\x01", "netCDF cannot read"},
    {"\x93NUMPY\x01", "inside the .npy header"},
};

static void refuse_bytes(const void *bytes, size_t size, const char *word)
{
    lac_error err = {""};
    lac_height_map *map = (lac_height_map *)&files;
    const char *path = scratch_write(&files, "heights", bytes, size);
    lac_status status = lac_height_map_read(path, &map, &err);
    if (status != LAC_EINPUT || map != NULL || strstr(err.message, word) == NULL ||
        strncmp(err.message, path, strlen(path)) != 0 || strchr(err.message, '\n') != NULL) {
        fail_msg("status %d, \"%s\" does not speak of \"%s\"", (int)status, err.message, word);
    }
}

static void mess_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof messes / sizeof messes[0]; i++) {
        refuse_bytes(messes[i].text, strlen(messes[i].text), messes[i].word);
    }
}

static void refuse_npy(const char *header, size_t size, const char *word)
{
    unsigned char file[256] = {0};
    refuse_bytes(file, npy(file, header, known, size), word);
}

static void binary_mess_is_refused(void **state)
{
    (void)state;
    unsigned char file[512] = {0};
    const char *sound = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
    refuse_npy(sound, 47, "hold at most");
    refuse_npy(sound, 0, "hold at most");
    size_t n = npy(file, sound, known, 48);
    refuse_bytes(file, n + 1, "goes on behind");
    file[8] = 0xff;
    file[9] = 0x0f;
    refuse_bytes(file, n, "byte 8");
    file[6] = 9;
    refuse_bytes(file, n, "version 9");
    refuse_npy("{'descr': '<c8', 'fortran_order': False, 'shape': (2, 3), }", 48, "type");
    refuse_npy("{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3), }", 48, "type");
    refuse_npy("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (6,), }", 48, "type");
    refuse_npy("{'descr': '<f8', 'fortran_order': Maybe, 'shape': (2, 3), }", 48, "fortran_order");
    refuse_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 1), }", 48, "shape");
    refuse_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (), }", 48, "shape");
    refuse_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-2, 3), }", 48, "shape");
    refuse_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 3), }", 48, "at least one");
    refuse_npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3", 48, "shape");
    refuse_npy("{'descr': '<f8', 'fortran_order': False, "
               "'shape': (99999999999999999999999999, 99999999999999999999), }",
               48, "at most");
    const double infinite[6] = {1, 2, 3, 4, INFINITY, 6};
    refuse_bytes(file, npy(file, sound, infinite, 48), "column 2 of row 2");
    refuse_bytes(file, gsf(file, GSF, 5), "hold at most");
    refuse_bytes(file, gsf(file, GSF, 6) + 4, "goes on behind");
    refuse_bytes(file, gsf(file, "Gwyddion Simple Field 1.0\nYRes = 2\n", 6), "XRes");
    refuse_bytes(file, gsf(file, GSF "XReal = -1\n", 6), "> 0");
    refuse_bytes(file, gsf(file, GSF "Title\n", 6), "key = value");
    refuse_bytes(file, binary_sdf(file, 7, known, 40), "hold at most");
    refuse_bytes(file, binary_sdf(file, 9, known, 48), "DataType");
    n = binary_sdf(file, 7, known, 48);
    file[78] = 1;
    refuse_bytes(file, n, "Compression");
    memset(file + 42, 0, 40);
    refuse_bytes(file, n, "Xscale");
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    lac_error err = {""};
    lac_height_map *map = NULL;
    assert_int_equal(lac_height_map_read(scratch_path(&files, "none"), &map, &err), LAC_EIO);
    assert_int_equal(lac_height_map_read(files.folder, &map, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "no file"));
    assert_int_equal(lac_height_map_read("/dev/zero", &map, &err), LAC_EIO);
    lac_height_map_free(NULL);
}

static int setup(void **state)
{
    (void)state;
    scratch_create(&files);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    scratch_remove(&files);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(npy_of_every_type),
        cmocka_unit_test(npy_written_by_numpy),
        cmocka_unit_test(ascii_grid),
        cmocka_unit_test(gridded_points),
        cmocka_unit_test(gwyddion_field),
        cmocka_unit_test(iso_sdf),
        cmocka_unit_test(netcdf_grid),
        cmocka_unit_test(mess_is_refused),
        cmocka_unit_test(binary_mess_is_refused),
        cmocka_unit_test(what_is_no_file_is_refused),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
