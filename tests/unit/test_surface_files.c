// SPDX-License-Identifier: GPL-3.0-or-later
// Files of heights: every format against heights known_heights beforehand, and what is refused.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <netcdf.h>

#include "support/height_files.h"
#include "support/scratch.h"
#include "support/test.h"
#include "surface/surface.h"

static scratch files;

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
        assert_true(fabs(map->heights[i] - known_heights[i]) < 1e-12);
    }
    assert_int_equal(map->masked, 0);
    lac_height_map_free(map);
}

static void npy_of_every_type(void **state)
{
    (void)state;
    unsigned char file[256] = {0};
    size_t n = heights_npy(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }",
                           known_heights, 48);
    holds_known(read_bytes(file, n), NAN, NAN);
    const double columns[6] = {1, 4, 2, 5, 3, 6};
    n = heights_npy(file, "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", columns,
                    48);
    holds_known(read_bytes(file, n), NAN, NAN);
    const float narrow[6] = {1, 2, 3, 4, 5, 6};
    n = heights_npy(file, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", narrow,
                    24);
    holds_known(read_bytes(file, n), NAN, NAN);
    n = heights_npy(file, "{'descr': '>i2', 'fortran_order': False, 'shape': (2, 3), }",
                    "\0\1\0\2\0\3\0\4\0\5\0\6", 12);
    holds_known(read_bytes(file, n), NAN, NAN);
    n = heights_npy(file, "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }",
                    "\1\2\3\4\5\6", 6);
    holds_known(read_bytes(file, n), NAN, NAN);
    n = heights_npy(file, "{'descr': '<f2', 'fortran_order': False, 'shape': (2L, 3L), }",
                    "\0\x3c\0\x40\0\x42\0\x44\0\x45\0\x46", 12);
    holds_known(read_bytes(file, n), NAN, NAN);
    // the largest, the least above 0, none, and the least one of full precision below 0
    n = heights_npy(file, "{'descr': '>f2', 'fortran_order': False, 'shape': (4,), }",
                    "\x7b\xff\0\1\xfe\0\x84\0", 8);
    lac_height_map *half = read_bytes(file, n);
    assert_true(half->heights[0] == 65504.0 && half->heights[1] == 0x1p-24);
    assert_true(isnan(half->heights[2]) && half->heights[3] == -0x1p-14);
    lac_height_map_free(half);
    n = heights_npy(file, "{'descr': '|i1', 'fortran_order': False, 'shape': (2,), }", "\xff\x80",
                    2);
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
                       LACUNA_PYTHON
                       " -c \"import numpy as n; a = n.add.outer(7 * n.arange(5), "
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

static void ascii_grid(void **state)
{
    (void)state;
    holds_known(read_text(HEIGHTS_ASC "4 5 6\n1 2 3\n"), 0.5, 0.5);
    holds_known(read_text(HEIGHTS_ASC "4 5 6\n1 2 3"), 0.5, 0.5);
    holds_known(read_text("\xef\xbb\xbf" HEIGHTS_ASC "  4.0e0 +5. 60e-1\n\n1 2\n3\n\n"), 0.5, 0.5);
    holds_known(read_text("NCOLS 3\r\nNROWS 2\r\ndx 0.5\r\ndy 2\r\n4 5 6\r\n1 2 3\r\n"), 0.5, 2.0);
    // rows end where ncols says, not where lines do
    holds_known(read_text(HEIGHTS_ASC "4 5 6 1 2 3"), 0.5, 0.5);
    holds_known(read_text(HEIGHTS_ASC "4 5 6 1\n2 3\n"), 0.5, 0.5);
    holds_known(read_text("ncols 3\nnrows 2\ndx 0,5\ndy 2\n4 5,0 6\n1 2 3\n"), 0.5, 2.0);
    // no data is -9999 where the header does not say; corners are half a cell off centres
    lac_height_map *map = read_text("ncols 2\nnrows 2\ncellsize 0.5\nxllcorner 7\nyllcenter 3\n"
                                    "-9999 -nan\nNA 2\n");
    assert_int_equal(map->masked, 3);
    assert_true(map->heights[1] == 2.0 && map->x == 7.25 && map->y == 3.0);
    lac_height_map_free(map);
    map = read_text(HEIGHTS_ASC "-9999 5 nan\n1 2 -9999.0\n");
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
    holds_known(read_text("x\ty\tz\n0,0\t0,0\t1,0\n0,5\t0\t2\n1\t0\t3\n0\t0,5\t4\n0,5\t0,5\t5\n"
                          "1,0\t0,5\t6,0\n"),
                0.5, 0.5);
    holds_known(read_text("# 21.11.2026\n0;0;1\n0,5;0;2\n1;0;3\n0;0,5;4\n0,5;0,5;5\n1;0,5;6\n"),
                0.5, 0.5);
    // a point measured twice alike
    holds_known(read_text("0 0 1\n1 0 2\n2 0 3\n0 1 4\n1 1 5\n2 1 6\n1 1 5\n0 0 1\n"), 1.0, 1.0);
    // thirds, rounded
    holds_known(read_text("0 0 1\n.33 0 2\n.67 0 3\n0 1 4\n.33 1 5\n.67 1 6\n"), 0.335, 1.0);
    lac_height_map *map = read_text("0 0 1\n1 0 2\n3 0 4\n0 1 nan\n1 1 6\n3 1 8\n");
    assert_true(map->nx == 4 && map->ny == 2 && map->masked == 3 && map->dx == 1.0);
    assert_true(isnan(map->heights[2]) && map->heights[3] == 4.0 && map->heights[7] == 8.0);
    lac_height_map_free(map);
}

static void gwyddion_field(void **state)
{
    (void)state;
    unsigned char file[512] = {0};
    for (size_t pad = 0; pad < 4; pad++) {
        char header[256];
        (void)snprintf(header, sizeof header,
                       HEIGHTS_GSF "XReal = 1.5e-6\nYReal=1e-6\nTitle = %.*s\n", (int)pad + 1,
                       "abcd");
        holds_known(read_bytes(file, heights_gsf(file, header, 6)), 0.5e-6, 0.5e-6);
    }
    lac_height_map *map = read_bytes(
        file,
        heights_gsf(file, HEIGHTS_GSF "XYUnits = um\nZUnits = nm\nXReal = 3\nYReal = 2\n", 6));
    assert_string_equal(map->lateral_unit, "um");
    assert_string_equal(map->height_unit, "nm");
    assert_string_equal(map->format, "Gwyddion Simple Field");
    lac_height_map_free(map);
    holds_known(read_bytes(file, heights_gsf(file, HEIGHTS_GSF, 6)), NAN, NAN);
}

static void iso_sdf(void **state)
{
    (void)state;
    unsigned char file[256] = {0};
    holds_known(read_text(HEIGHTS_SDF "2 4 6\n8 10 12\n*\nComment = none\n"), 1e-3, 2e-3);
    holds_known(read_text(HEIGHTS_SDF "2 4 6 8\r\n10 12"), 1e-3, 2e-3);
    const int16_t whole[6] = {2, 4, 6, 8, 10, 12};
    holds_known(read_bytes(file, heights_sdf(file, "bISO-1.0", 5, whole, 12)), 1e-3, 2e-3);
    const double reals[6] = {2, 4, 6, 8, 10, 12};
    holds_known(read_bytes(file, heights_sdf(file, "bISO-1.0", 7, reals, 48)), 1e-3, 2e-3);
    const int16_t bad[6] = {INT16_MIN, 4, 6, 8, 10, -12};
    lac_height_map *map = read_bytes(file, heights_sdf(file, "bISO-1.0", 5, bad, 12));
    assert_true(map->masked == 1 && isnan(map->heights[0]) && map->heights[5] == -6.0);
    assert_string_equal(map->height_unit, "m");
    lac_height_map_free(map);
    // 32-bit counts of version 2, Olympus' longer header, unsigned marks of no data
    holds_known(read_bytes(file, heights_sdf(file, "bISO-2.0", 7, reals, 48)), 1e-3, 2e-3);
    unsigned char late[56] = {5, 0, 0, 0, 1};
    memcpy(late + 8, reals, 48);
    holds_known(read_bytes(file, heights_sdf(file, "bISO-1.0", 7, late, 56)), 1e-3, 2e-3);
    const uint16_t full[6] = {2, UINT16_MAX, 6, 8, 10, 12};
    map = read_bytes(file, heights_sdf(file, "bBCR-1.0", 1, full, 12));
    assert_true(map->masked == 1 && isnan(map->heights[1]) && map->heights[2] == 3.0);
    lac_height_map_free(map);
    holds_known(read_text("aISO-2.0\r\n; Talymap\r\nNumPoints 3\r\nNumProfiles 2\r\nXscale 1E-3\r\n"
                          "Yscale 2E-3\r\nZscale 1,0\r\n*\r\n1,0 2 3\r\n4 5 6\r\n*\r\n"),
                1e-3, 2e-3);
    map = read_text(HEIGHTS_SDF "2 4 BAD\n8 10 12\n*\n");
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
        const char *path = write_netcdf("z", "y", 2, "x", 3, false, known_heights, mode);
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

// Places that are packed, as integers that a factor and an offset make places of.
static void netcdf_of_packed_places(void **state)
{
    (void)state;
    const double half = 0.5, five = 5.0;
    lac_error err = {""};
    lac_height_map *map = NULL;
    int id = 0, x = 0;
    const char *path = write_netcdf("z", "y", 2, "x", 3, false, known_heights, NC_NETCDF4);
    assert_int_equal(nc_open(path, NC_WRITE, &id), NC_NOERR);
    assert_int_equal(nc_inq_varid(id, "x", &x), NC_NOERR);
    (void)nc_put_att_double(id, x, "scale_factor", NC_DOUBLE, 1, &half);
    (void)nc_put_att_double(id, x, "add_offset", NC_DOUBLE, 1, &five);
    assert_int_equal(nc_close(id), NC_NOERR);
    assert_int_equal(lac_height_map_read(path, &map, &err), LAC_OK);
    assert_true(map->x == 5.0);
    holds_known(map, 0.25, 0.5);
}

// As SurfaceTopography wrote it once: one unit, said of the coordinates, and a stored integer that
// nobody wrote.
static void netcdf_of_surface_topography(void **state)
{
    (void)state;
    const char *path = scratch_path(&files, "old.nc");
    lac_error err = {""};
    lac_height_map *map = NULL;
    int id = 0;
    int dim[2];
    int v[3];
    const double x[3] = {0.25, 0.75, 1.25};
    const double y[2] = {0.5, 1.5};
    const short z[2] = {2, 5};
    const size_t start[2] = {1, 0};
    const size_t count[2] = {1, 2};
    assert_int_equal(nc_create(path, NC_CLOBBER, &id), NC_NOERR);
    (void)nc_def_dim(id, "x", 3, &dim[0]);
    (void)nc_def_dim(id, "y", 2, &dim[1]);
    (void)nc_def_var(id, "x", NC_DOUBLE, 1, &dim[0], &v[0]);
    (void)nc_def_var(id, "y", NC_DOUBLE, 1, &dim[1], &v[1]);
    (void)nc_def_var(id, "heights", NC_SHORT, 2, dim, &v[2]);
    (void)nc_put_att_text(id, v[0], "length_unit", 2, "um");
    (void)nc_enddef(id);
    (void)nc_put_var_double(id, v[0], x);
    (void)nc_put_var_double(id, v[1], y);
    (void)nc_put_vara_short(id, v[2], start, count, z);
    assert_int_equal(nc_close(id), NC_NOERR);
    assert_int_equal(lac_height_map_read(path, &map, &err), LAC_OK);
    assert_string_equal(map->lateral_unit, "um");
    assert_string_equal(map->height_unit, "um");
    assert_true(map->nx == 3 && map->ny == 2 && map->masked == 4);
    assert_true(map->heights[1] == 2.0 && map->heights[4] == 5.0);
    assert_true(map->x == 0.25 && map->y == 0.5 && map->dx == 0.5 && map->dy == 1.0);
    lac_height_map_free(map);
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
        cmocka_unit_test(netcdf_of_packed_places),
        cmocka_unit_test(netcdf_of_surface_topography),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
