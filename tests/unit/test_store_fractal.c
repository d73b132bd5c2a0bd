// SPDX-License-Identifier: GPL-3.0-or-later
// The fractal measures in the file of a contact.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <netcdf.h>

#include "scene/scene.h"
#include "support/contact_file.h"
#include "support/scratch.h"
#include "support/test.h"

static scratch folder;

static int set_up(void **state)
{
    (void)state;
    scratch_create(&folder);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    scratch_remove(&folder);
    return 0;
}

static double pressure[4] = {1.0, 0.0, 2.0, 0.0};
static const lac_grid grid = {2, 2, 0.5, 0.5, true};

// The scaling of three resolutions, with Delta_S = 1.5.
static lac_scaling scaling_of_three(void)
{
    lac_scaling s = {.n = 3, .coarsening = LAC_BLOCK_MEAN};
    for (size_t i = 0; i < 3; i++) {
        double r = exp2(-(double)i);
        s.at[i] = (lac_resolution){
            .cell = r, .area = sqrt(r), .pressure = 3.0 / sqrt(r), .slope = 0.1, .cells = 7 + i};
    }
    lac_scaling_fit(&s, 0);
    return s;
}

static void expect_values(int file, const char *name, size_t n, const double *want)
{
    int var = 0;
    int dim = 0;
    size_t length = 0;
    double got[32];
    assert_int_equal(nc_inq_varid(file, name, &var), NC_NOERR);
    assert_int_equal(nc_inq_vardimid(file, var, &dim), NC_NOERR);
    assert_int_equal(nc_inq_dimlen(file, dim, &length), NC_NOERR);
    assert_int_equal(length, n);
    assert_int_equal(nc_get_var_double(file, var, got), NC_NOERR);
    assert_memory_equal(got, want, n * sizeof *want);
}

static double attribute(int file, const char *name)
{
    double value = 0.0;
    assert_int_equal(nc_get_att_double(file, NC_GLOBAL, name, &value), NC_NOERR);
    return value;
}

static void measures_come_back(void **state)
{
    (void)state;
    const lac_scaling scaling = scaling_of_three();
    const lac_cluster_summary clusters = {.n = 5,
                                          .cells = 9,
                                          .largest = 4,
                                          .largest_extent = 1.5,
                                          .widest = 2.0,
                                          .mean = 1.8,
                                          .weighted = 2.6,
                                          .octaves = 3,
                                          .count = {3, 1, 1},
                                          .cells_of = {3, 2, 4}};
    lac_scene_contact contact = {.grid = grid, .pressure = pressure};
    contact.fractal =
        (lac_scene_fractal){.clustered = true,
                            .clusters = clusters,
                            .scaled = true,
                            .scaling = scaling,
                            .sizes = 2,
                            .size = {{0.1, 4e6, 1.5, 1.25, 1.75}, {10.0, 1e6, 0.5, 0.25, 0.75}}};
    const char *path = scratch_path(&folder, "fractal.nc");
    assert_int_equal(contact_file(&contact, path, false, NULL, NULL), LAC_OK);
    int file = 0;
    assert_int_equal(nc_open(path, NC_NOWRITE, &file), NC_NOERR);
    expect_values(file, "resolution", 3, (const double[]){1.0, 0.5, 0.25});
    expect_values(file, "resolution_cells", 3, (const double[]){7.0, 8.0, 9.0});
    expect_values(file, "resolution_slope", 3, (const double[]){0.1, 0.1, 0.1});
    expect_values(file, "resolution_local_dimension", 3,
                  (const double[]){scaling.at[0].local, scaling.at[1].local, NC_FILL_DOUBLE});
    expect_values(file, "cluster_size", 3, (const double[]){1.0, 2.0, 4.0});
    expect_values(file, "cluster_count", 3, (const double[]){3.0, 1.0, 1.0});
    expect_values(file, "cluster_cells", 3, (const double[]){3.0, 2.0, 4.0});
    expect_values(file, "specimen_size", 2, (const double[]){0.1, 10.0});
    expect_values(file, "specimen_pressure", 2, (const double[]){4e6, 1e6});
    expect_values(file, "specimen_strength", 2, (const double[]){1.5, 0.5});
    expect_values(file, "specimen_strength_low", 2, (const double[]){1.25, 0.25});
    expect_values(file, "specimen_strength_high", 2, (const double[]){1.75, 0.75});
    assert_true(attribute(file, "delta_s") == scaling.dimension);
    assert_true(attribute(file, "clusters") == 5.0);
    assert_true(attribute(file, "widest_cluster_m") == 2.0);
    (void)nc_close(file);
    char text[64];
    assert_int_equal(lac_store_read_attribute(path, "fractal_area_unit", text, sizeof text, NULL),
                     LAC_OK);
    assert_string_equal(text, "m^1.500");
    assert_int_equal(lac_store_read_attribute(path, "coarsening", text, sizeof text, NULL), LAC_OK);
    assert_string_equal(text, "block means");
}

static void what_was_not_measured_is_left_out(void **state)
{
    (void)state;
    const lac_scene_contact contact = {
        .grid = grid, .pressure = pressure, .fractal = {.clustered = true, .scaled = true}};
    const char *path = scratch_path(&folder, "bare.nc");
    int file = 0;
    int id = 0;
    assert_int_equal(contact_file(&contact, path, false, NULL, NULL), LAC_OK);
    assert_int_equal(nc_open(path, NC_NOWRITE, &file), NC_NOERR);
    assert_int_equal(nc_inq_dimid(file, "resolution", &id), NC_EBADDIM);
    assert_int_equal(nc_inq_dimid(file, "cluster_octave", &id), NC_EBADDIM);
    assert_int_equal(nc_inq_dimid(file, "specimen", &id), NC_EBADDIM);
    (void)nc_close(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(measures_come_back),
        cmocka_unit_test(what_was_not_measured_is_left_out),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
