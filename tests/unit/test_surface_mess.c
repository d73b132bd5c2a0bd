// SPDX-License-Identifier: GPL-3.0-or-later
// Files of heights that are refused, and what is said of them.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "support/height_files.h"
#include "support/scratch.h"
#include "support/test.h"
#include "surface/surface.h"

static scratch files;

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
    {"ncols 3\nnrows 2\ncellsize 0,5\n1.5", "decimal point"},
    {"ncols 3000000000\nnrows 3000000000\ncellsize 1\n1", "at most"},
    {"ncols 9007199254740992\nnrows 9007199254740992\ncellsize 1\n1", "at most"},
    {"ncols 10000\nnrows 10000\ncellsize 1\n1 2 3\n", "hold at most"},
    {HEIGHTS_ASC "4 5 6\n1 2\n", "after 5 numbers"},
    {HEIGHTS_ASC "4 5 6\n1 2 3\n7\n", ":9: \"7\" comes after all"},
    {"ncols 2\nnrows 3\ncellsize 1\n4 5 6\n1 2 3\n", "exchanged"},
    {"ncols 2\nnrows 4\ncellsize 1\n1 2 3 4\n5 6 7 8\n", "exchanged"},
    {"ncols 6\nnrows 2\ncellsize 1\n1 2 3 4\n5 6 7 8\n9 10 11 12\n", "no rows of ncols = 6"},
    {HEIGHTS_ASC "4 5 x\n1 2 3\n", ":7: \"x\" is not a number"},
    {HEIGHTS_ASC "4 5 6,5\n1 2 3\n", "decimal point"},
    {HEIGHTS_ASC "4 5 inf\n1 2 3\n", "not a number"},
    {HEIGHTS_ASC "4 5 1e999\n1 2 3\n", "too large"},
    {HEIGHTS_ASC "4 5 --\n1 2 3\n", "not a number"},
    {HEIGHTS_ASC "-9999 nan nan\nnan nan nan\n", "all 6 heights are missing"},
    {HEIGHTS_ASC "4 5 6\n1 2 3\nend of file\n", ":9: \"end\" comes after all"},
    {HEIGHTS_ASC "4 5 6\n1 2 3e\n", "not a number"},
    {"ncols 2\nnrows 1\ncellsize 1\n1,5 1,2,3\n", "not a number"},
    {"# nothing\n1 2\n", "fewer than three"},
    {"1 2 3 4\n", "more than three"},
    {"nan 0 1\n", "x is nan"},
    {"0 0 1\n1 0 2\n0 0 3\n1 1 1\n", ":3: the point x = 0, y = 0 stands in line 1 already, with "
                                     "another height, 1, not 3"},
    {"0 0 1\n1 0 2\n0 0 nan\n1 1 1\n", ":3: the point"},
    {"0 0 1\n0.9 0.1 2\n1.8 0.2 3\n-0.1 0.9 4\n0.8 1 5\n1.7 1.1 6\n", "turn a grid"},
    {"1,5 2.5 3,5\n", "decimal point"},
    {"0 0 inf\n", "not a number"},
    {"0 0 1\n1 0 2\n2.5 0 3\n7.1 0 2\n", "off the grid"},
    {"0 0 1\n1 1 1\n2 2 1\n3 3 1\n4 4 1\n5 5 1\n6 6 1\n7 7 1\n8 8 1\n", "must be gridded"},
    {"-1e308 0 1\n1e308 0 1\n", "no grid is that large"},
    {"1 2 \x01\n", "not a number"},
    {"x y z\n", "without a point"},
    {"Gwyddion Simple Field 1.0\nXRes = 3\n", "without the NUL"},
    {"aBCR-1.0\nNumPoints = 3\n", "without the *"},
    {"aBCR-1.0\nNumPoints\n", "neither key"},
    {"aBCR-1.0\nNumPoints 3\n", "without the *"},
    {"aBCR-2.0\nNumPoints 3\n", "none of the formats"},
    {HEIGHTS_SDF_HEAD "CheckType = 2\n*\n1 2 3\n", "CheckType"},
    {"aBCR-1.0\n*\n1", "Xscale"},
    {"aBCR-1.0\nXscale = -1\n", "> 0"},
    {"aBCR-1.0\nXscale = \n", "not a number"},
    {HEIGHTS_SDF_HEAD "Compression = 1\n*\n1 2 3\n", "Compression"},
    {HEIGHTS_SDF "2 4 6\n8 10\n*\n", "end after 5"},
    {HEIGHTS_SDF "2 4 6\n8 10 12 13\n*\n", "\"13\" comes after all"},
    {HEIGHTS_SDF "2 4 6\n8 10 12;\n*\n", "not a number"},
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
    refuse_bytes(file, heights_npy(file, header, known_heights, size), word);
}

static void binary_mess_is_refused(void **state)
{
    (void)state;
    unsigned char file[512] = {0};
    const char *sound = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
    refuse_npy(sound, 47, "hold at most");
    refuse_npy(sound, 0, "hold at most");
    size_t n = heights_npy(file, sound, known_heights, 48);
    refuse_bytes(file, n + 1, "goes on behind");
    file[8] = 0xff;
    file[9] = 0x0f;
    refuse_bytes(file, n, "byte 8");
    file[6] = 9;
    refuse_bytes(file, n, "version 9");
    refuse_npy("{'descr': '<c8', 'fortran_order': False, 'shape': (2, 3), }", 48, "type");
    refuse_npy("{'descr': '<f3', 'fortran_order': False, 'shape': (2, 3), }", 48, "type");
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
    refuse_bytes(file, heights_npy(file, sound, infinite, 48), "column 2 of row 2");
    refuse_bytes("CDF\1\0\0\0\0\0\0\0\x0a\x7f\xff\xff\xff\0\0\0\1x\0\0\0", 24, "byte 16");
    refuse_bytes("CDF\5\0\0\0\0\0\0\0\0\0\0\0\x0a\0\0\0\1\0\0\0\0", 24, "byte 24");
    refuse_bytes(file, heights_gsf(file, HEIGHTS_GSF, 5), "hold at most");
    refuse_bytes(file, heights_gsf(file, HEIGHTS_GSF, 6) + 4, "goes on behind");
    refuse_bytes(file, heights_gsf(file, "Gwyddion Simple Field 1.0\nYRes = 2\n", 6), "XRes");
    refuse_bytes(file, heights_gsf(file, HEIGHTS_GSF "XReal = -1\n", 6), "> 0");
    refuse_bytes(file, heights_gsf(file, HEIGHTS_GSF "Title\n", 6), "key = value");
    refuse_bytes(file, heights_sdf(file, "bISO-1.0", 7, known_heights, 40), "hold at most");
    refuse_bytes(file, heights_sdf(file, "bISO-1.0", 9, known_heights, 48), "DataType");
    n = heights_sdf(file, "bISO-1.0", 7, known_heights, 48);
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
        cmocka_unit_test(mess_is_refused),
        cmocka_unit_test(binary_mess_is_refused),
        cmocka_unit_test(what_is_no_file_is_refused),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
