// SPDX-License-Identifier: GPL-3.0-or-later
// The source `file`: a map of known_heights heights onto grids of all sorts.
#include <stdio.h>
#include <string.h>

#include <math.h>

#include "support/height_files.h"
#include "support/scratch.h"
#include "support/test.h"
#include "surface/surface.h"

static scratch files;

// What a source makes of a text, with options; `path` and `unit` are filled in here.
static lac_status make(const char *text, lac_surface_file options, const lac_grid *grid, double *h,
                       lac_error *err)
{
    char path[160];
    (void)snprintf(path, sizeof path, "%s", scratch_write(&files, "map", text, strlen(text)));
    options.path = path;
    return lac_surface_generate(&(lac_model){&surface_source("file")->info, &options}, grid, h,
                                NULL, err);
}

static const lac_surface_file plain = {.spacing = NAN};

static void makes(const char *text, lac_surface_file options, lac_grid grid, const double *expected)
{
    lac_error err = {""};
    double h[64];
    if (make(text, options, &grid, h, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    for (size_t i = 0; i < lac_grid_cells(&grid); i++) {
        if (!(fabs(h[i] - expected[i]) < 1e-12)) {
            fail_msg("cell %zu: %g, not %g", i, h[i], expected[i]);
        }
    }
}

static void is_refused(const char *text, lac_surface_file options, lac_grid grid, const char *word)
{
    lac_error err = {""};
    double h[64];
    assert_int_equal(make(text, options, &grid, h, &err), LAC_EINPUT);
    if (strstr(err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", err.message, word);
    }
}

#define MAP HEIGHTS_ASC "4 5 6\n1 2 3\n"

static void map_goes_onto_the_grid(void **state)
{
    (void)state;
    const lac_grid same = {3, 2, 0.5, 0.5, true};
    lac_surface_file o = plain;
    makes(MAP, o, same, known_heights);
    makes(MAP, o, (lac_grid){1, 1, 0.5, 0.5, true}, (double[]){2});
    o.detrend = 1;
    makes(MAP, o, same, (double[]){-2.5, -1.5, -0.5, 0.5, 1.5, 2.5});
    o.detrend = 2;
    makes(MAP, o, same, (double[6]){0});
    o = plain;
    o.fit = 1;
    makes(MAP, o, (lac_grid){5, 3, 0.5, 0.5, true},
          (double[]){1, 1, 2, 3, 3, 1, 1, 2, 3, 3, 4, 4, 5, 6, 6});
    o.fit = 2;
    // a plane: centre 3.5, 1 per sample along x and 3 along y, at cells of half the size
    makes(MAP, o, (lac_grid){4, 2, 0.25, 0.25, true}, (double[]){2, 2.5, 3, 3.5, 3.5, 4, 4.5, 5});
}

static void units_gaps_and_tapers(void **state)
{
    (void)state;
    const lac_grid same = {3, 2, 0.5, 0.5, true};
    lac_surface_file o = plain;
    o.unit = "mm";
    o.lateral_unit = "m";
    makes(MAP, o, same, (double[]){1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3});
    o.lateral_unit = NULL;
    is_refused(MAP, o, same, "0.0005 m apart along x");
    is_refused(MAP, o, same, "fit: resample");
    o.unit = "kg";
    is_refused(MAP, o, same, "kg");
    o = plain;
    is_refused(MAP, o, (lac_grid){4, 2, 0.5, 0.5, true}, "3 samples along x");
    o.spacing = 0.5;
    is_refused(MAP, o, same, "leave spacing out");
    o = plain;
    o.fit = 2;
    is_refused(MAP, o, (lac_grid){4, 2, 0.5, 0.5, true}, "covers 1.5 m along x");
    o = plain;
    o.unit = "mm";
    is_refused(HEIGHTS_SDF "2 4 6\n8 10 12", o, same, "unit is mm");
    o = plain;
    const char *gap = HEIGHTS_ASC "4 5 6\n-9999 2 3\n";
    is_refused(gap, o, same, "nodata: nearest");
    makes(gap, o, (lac_grid){1, 1, 0.5, 0.5, true}, (double[]){2});
    o.nodata = 2;
    makes(gap, o, same, (double[]){4, 2, 3, 4, 5, 6});
    o.nodata = 3; // below the deepest by as much as the heights span
    makes(gap, o, same, (double[]){-2, 2, 3, 4, 5, 6});
    makes(HEIGHTS_ASC "4 5 6\n-9999 -9999 -9999\n", o, same, (double[]){2, 2, 2, 4, 5, 6});
    o.detrend = 1;
    makes(HEIGHTS_ASC "4 5 6\n-9999 5 6\n", o, same,
          (double[]){-19.0 / 6, -1.0 / 6, 5.0 / 6, -7.0 / 6, -1.0 / 6, 5.0 / 6});
    o = plain;
    o.nodata = 1;
    makes(HEIGHTS_ASC "4 5 6\n-9999 -9999 -9999\n", o, same, (double[]){4, 5, 6, 4, 5, 6});
    is_refused(HEIGHTS_ASC "4 5 6\n1 2 1e30\n", o, same, "within 1e9 m");
    o.taper = 0.5;
    makes("ncols 4\nnrows 1\ncellsize 1\n1 1 1 1\n", o, (lac_grid){4, 1, 1.0, 1.0, true},
          (double[]){0.5 - sqrt(0.125), 0.5 + sqrt(0.125), 0.5 + sqrt(0.125), 0.5 - sqrt(0.125)});
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
        cmocka_unit_test(map_goes_onto_the_grid),
        cmocka_unit_test(units_gaps_and_tapers),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
