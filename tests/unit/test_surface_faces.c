// SPDX-License-Identifier: GPL-3.0-or-later
// Two measured faces against faces of closed form: signs, places, views, units, what is refused.
#include <stdio.h>
#include <string.h>

#include <math.h>

#include "support/height_files.h"
#include "support/scratch.h"
#include "support/test.h"
#include "surface/surface.h"

static scratch files;

// A smooth height that is the same nowhere else.
static double shape(double x, double y) { return 3.0 * x - y + x * x - 0.5 * x * y; }

// Samples of a face: nx x ny, dx apart, the first at (x0, y0); its frame may run backwards.
typedef struct scan {
    size_t nx, ny;
    double dx, x0, y0;
    double (*height)(double x, double y);
} scan;

static const char *write_asc(const char *name, scan s)
{
    static char text[40000];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "ncols %zu\nnrows %zu\nxllcenter %.17g\nyllcenter %.17g\n"
                                   "cellsize %.17g\n",
                                   s.nx, s.ny, s.x0, s.y0, s.dx);
    for (size_t j = s.ny; j-- > 0;) {
        for (size_t i = 0; i < s.nx; i++) {
            double h = s.height(s.x0 + (double)i * s.dx, s.y0 + (double)j * s.dx);
            used += (size_t)snprintf(text + used, sizeof text - used, "%.17g ", h);
        }
        used += (size_t)snprintf(text + used, sizeof text - used, "\n");
    }
    return scratch_write(&files, name, text, used);
}

static lac_surface_file faces(const char *upper, const char *lower)
{
    return (lac_surface_file){.path = (char *)upper, .lower = (char *)lower, .spacing = NAN};
}

static void make(lac_surface_file p, const lac_grid *grid, double *h)
{
    lac_error err = {""};
    if (lac_surface_generate(&(lac_model){&surface_source("file")->info, &p}, grid, h, NULL,
                             &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
}

static void refuse(lac_surface_file p, const lac_grid *grid, const char *word)
{
    double h[4096];
    lac_error err = {""};
    assert_int_equal(
        lac_surface_generate(&(lac_model){&surface_source("file")->info, &p}, grid, h, NULL, &err),
        LAC_EINPUT);
    if (strstr(err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", err.message, word);
    }
}

static double lower_face(double x, double y) { return shape(x, y); }

// A hemisphere-like asperity hanging from the upper rock at (4, 3).
static double hanging(double x, double y) { return 9.0 - 2.0 * exp(-hypot(x - 4.0, y - 3.0)); }
static double flat(double x, double y) { return 0.0 * x * y; }

// What hangs lowest touches first: it is the peak of the composite.
static void peaks_of_the_upper_face_point_down(void **state)
{
    (void)state;
    const lac_grid grid = {9, 7, 1.0, 1.0, true};
    double h[63];
    make(faces(write_asc("upper.asc", (scan){9, 7, 1.0, 0.0, 0.0, hanging}),
               write_asc("lower.asc", (scan){9, 7, 1.0, 0.0, 0.0, flat})),
         &grid, h);
    size_t peak = 0;
    for (size_t i = 0; i < 63; i++) {
        peak = h[i] > h[peak] ? i : peak;
        assert_true(fabs(h[i] + hanging((double)(i % 9), (double)(i / 9))) < 1e-12);
    }
    assert_true(peak == 3 * 9 + 4);
}

// Faces that fit into each other leave a flat composite, wherever the files begin.
static void faces_lie_by_their_coordinates(void **state)
{
    (void)state;
    const lac_grid grid = {8, 6, 0.5, 0.5, true};
    double h[48];
    const char *upper = write_asc("upper.asc", (scan){12, 10, 0.5, 1.0, 2.0, lower_face});
    lac_surface_file p =
        faces(upper, write_asc("lower.asc", (scan){17, 13, 0.5, -0.5, 1.0, lower_face}));
    make(p, &grid, h);
    for (size_t i = 0; i < 48; i++) {
        assert_true(fabs(h[i]) < 1e-12);
    }
    // moved by two cells, the lower face is that of one place, the upper that of another
    p.offset = 1.0;
    make(p, &grid, h);
    for (size_t i = 0; i < 48; i++) {
        double x = 2.0 + 0.5 * (double)(i % 8);
        double y = 3.0 + 0.5 * (double)(i / 8);
        assert_true(fabs(h[i] - (shape(x - 1.0, y) - shape(x, y))) < 1e-12);
    }
    p.offset = 0.2;
    refuse(p, &grid, "0.4 of a cell off the cells along x");
    p.offset = 3.0;
    refuse(p, &grid, "of the interface, which goes from 0 to 4 m");
}

static double mirrored_x(double x, double y) { return -shape(-x, y); }
static double mirrored_y(double x, double y) { return -shape(x, -y); }

// A joint opened like a book: what was up on the one face was down on the other.
static void faces_looked_at_are_added(void **state)
{
    (void)state;
    const lac_grid grid = {8, 6, 0.5, 0.5, true};
    double h[48];
    // coordinates do not count: each scan has its own. Extents are symmetric about 0.
    const char *upper = write_asc("upper.asc", (scan){9, 7, 0.5, -2.0, -1.5, lower_face});
    lac_surface_file p =
        faces(upper, write_asc("lower.asc", (scan){9, 7, 0.5, -2.0, -1.5, mirrored_y}));
    p.lower_view = 2;
    make(p, &grid, h);
    for (size_t i = 0; i < 48; i++) {
        assert_true(fabs(h[i]) < 1e-12);
    }
    p.lower = (char *)write_asc("turned.asc", (scan){13, 7, 0.5, -3.0, -1.5, mirrored_x});
    p.lower_view = 1;
    make(p, &grid, h);
    for (size_t i = 0; i < 48; i++) {
        assert_true(fabs(h[i]) < 1e-12);
    }
    // the offset is along the x of the interface, also where that of the scan runs backwards
    p.offset = 0.5;
    make(p, &grid, h);
    for (size_t i = 0; i < 48; i++) {
        double x = -2.0 + 0.5 * (double)(i % 8);
        double y = -1.5 + 0.5 * (double)(i / 8);
        assert_true(fabs(h[i] - (shape(x, y) - shape(x - 0.5, y))) < 1e-12);
    }
}

static double plane(double x, double y) { return 0.2 * x - 0.1 * y; }

// Bilinear interpolation is exact on a plane: spacings, sizes and formats may differ.
static void faces_of_two_kinds(void **state)
{
    (void)state;
    const lac_grid grid = {10, 8, 0.3, 0.3, true};
    double h[80];
    double rows[30 * 30];
    unsigned char file[128 + sizeof rows];
    const char *upper = write_asc("upper.asc", (scan){20, 20, 0.25, 0.0, 0.0, plane});
    for (size_t i = 0; i < 900; i++) {
        rows[i] = plane(0.2 * (double)(i % 30), 0.2 * (double)(i / 30)) + 7.0;
    }
    size_t n = heights_npy(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (30, 30), }",
                           rows, sizeof rows);
    lac_surface_file p = faces(upper, scratch_write(&files, "lower.npy", file, n));
    p.fit = 2;
    p.detrend = 1;
    p.unit = "m";
    p.lateral_unit = "m";
    p.spacing = 0.2;
    p.offset = 0.17;
    make(p, &grid, h);
    for (size_t i = 0; i < 80; i++) {
        assert_true(fabs(h[i]) < 1e-12); // a plane moved along itself is a plane as steep
    }
    p.offset = 2.0;
    refuse(p, &grid, "lower.npy: it lies from");
    p.offset = 0.0;
    p.spacing = 0.01;
    refuse(p, &grid, "covers 0.3 m along x");
}

static void odd_and_even_scans(void **state)
{
    (void)state;
    const lac_grid grid = {4, 1, 1.0, 1.0, true};
    double h[4];
    // no coordinates: middle on middle, which for 7 and 8 samples is half a cell off
    lac_surface_file p = faces(NULL, NULL);
    unsigned char file[256];
    const double ramp[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    size_t n =
        heights_npy(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (8,), }", ramp, 64);
    p.path = (char *)scratch_write(&files, "eight", file, n);
    n = heights_npy(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (7,), }", ramp, 56);
    p.lower = (char *)scratch_write(&files, "seven", file, n);
    refuse(p, &grid, "0.5 of a cell off");
    p.offset = 0.5;
    make(p, &grid, h);
    assert_true(h[0] == -1.0 && h[3] == -1.0);
    n = heights_npy(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (6,), }", ramp, 48);
    p.lower = (char *)scratch_write(&files, "six", file, n);
    p.offset = 0.0;
    make(p, &grid, h);
    assert_true(h[0] == -1.0 && h[3] == -1.0);
}

// A unit and a spacing of the case are for the file that says none; where none needs them they are
// refused.
static void each_file_takes_what_it_lacks(void **state)
{
    (void)state;
    static const char header[] = HEIGHTS_GSF "XReal = 1.5\nYReal = 1\nXYUnits = m\nZUnits = mm\n";
    static const char thousandth[] = HEIGHTS_ASC "0.004 0.005 0.006\n0.001 0.002 0.003\n";
    const lac_grid grid = {3, 2, 0.5, 0.5, true};
    double h[6];
    unsigned char file[256];
    const char *upper = scratch_write(&files, "mm.gsf", file, heights_gsf(file, header, 6));
    lac_surface_file p =
        faces(upper, scratch_write(&files, "m.asc", thousandth, sizeof thousandth - 1));
    p.unit = "m";
    make(p, &grid, h);
    for (size_t i = 0; i < 6; i++) {
        assert_true(fabs(h[i]) < 1e-9); // of mm and of m the same heights
    }
    p.spacing = 0.5;
    refuse(p, &grid, "leave spacing out");
    p.spacing = NAN;
    p.lower = NULL;
    refuse(p, &grid, "the file says mm, but unit is m");
    p.lower = p.path;
    refuse(p, &grid, "the file says mm, but unit is m");
}

static void a_lower_face_that_is_not_there(void **state)
{
    (void)state;
    const lac_grid grid = {3, 2, 0.5, 0.5, true};
    const char *path = scratch_write(&files, "map", HEIGHTS_ASC "4 5 6\n1 2 3\n",
                                     sizeof HEIGHTS_ASC "4 5 6\n1 2 3\n" - 1);
    lac_surface_file p = faces(path, scratch_path(&files, "none"));
    double h[6];
    lac_error err = {""};
    lac_model model = {&surface_source("file")->info, &p};
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "none"));
}

// What is said of the files, and of which heights the measures are.
static void files_are_reported(void **state)
{
    (void)state;
    const lac_grid grid = {8, 6, 0.5, 0.5, true};
    double h[48];
    lac_surface_stats report;
    lac_error err = {""};
    lac_surface_file p = faces(write_asc("upper.asc", (scan){12, 10, 0.5, 1.0, 2.0, plane}), NULL);
    p.taper = 0.2;
    lac_model model = {&surface_source("file")->info, &p};
    assert_int_equal(lac_surface_generate(&model, &grid, h, &report, &err), LAC_OK);
    assert_int_equal(report.measured, LAC_MEASURED_FILE);
    assert_int_equal(report.files, 1);
    assert_string_equal(report.file[0].format, "ESRI ASCII grid");
    assert_string_equal(report.file[0].height_unit, "m");
    assert_true(report.file[0].nx == 12 && report.file[0].ny == 10 && report.file[0].dx == 0.5);
    assert_true(report.measures.rms_height < 1e-12); // its plane is taken off, its taper not seen
    p.lower = (char *)write_asc("lower.asc", (scan){17, 13, 0.5, -0.5, 1.0, lower_face});
    assert_int_equal(lac_surface_generate(&model, &grid, h, &report, &err), LAC_OK);
    assert_int_equal(report.measured, LAC_MEASURED_COMPOSITE);
    assert_true(report.files == 2 && report.file[1].nx == 17);
    assert_true(report.measures.rms_height > 0.1);
    // gaps beside the interface: only what lies on it is measured
    p = faces(scratch_write(&files, "gap", HEIGHTS_ASC "-9999 5 6\n1 2 3\n",
                            sizeof HEIGHTS_ASC "-9999 5 6\n1 2 3\n" - 1),
              NULL);
    const lac_grid small = {1, 1, 0.5, 0.5, true};
    assert_int_equal(lac_surface_generate(&model, &small, h, &report, &err), LAC_OK);
    assert_int_equal(report.measured, LAC_MEASURED_PART);
    assert_int_equal(report.file[0].masked, 1);
    p.nodata = 1;
    assert_int_equal(lac_surface_generate(&model, &small, h, &report, &err), LAC_OK);
    assert_int_equal(report.measured, LAC_MEASURED_FILE);
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
        cmocka_unit_test(peaks_of_the_upper_face_point_down),
        cmocka_unit_test(faces_lie_by_their_coordinates),
        cmocka_unit_test(faces_looked_at_are_added),
        cmocka_unit_test(faces_of_two_kinds),
        cmocka_unit_test(odd_and_even_scans),
        cmocka_unit_test(each_file_takes_what_it_lacks),
        cmocka_unit_test(a_lower_face_that_is_not_there),
        cmocka_unit_test(files_are_reported),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
