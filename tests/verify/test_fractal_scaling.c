// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "fractal/fractal.h"
#include "support/benchmark_surface.h"
#include "support/test.h"

enum { SIDE = 1024 };

// Areas of J07_1024 at 1e-2 E* on 64 ... 1024 cells a side by another code.
static const double joint_area[5] = {0.104736, 0.086121, 0.068253, 0.055264, 0.046990};

static lac_contact_def contact_of(size_t side, const double *heights, double pressure)
{
    lac_contact_def def = lac_contact_default();
    def.grid = (lac_grid){side, side, 1.0 / (double)side, 1.0 / (double)side, true};
    def.heights = heights;
    def.e_star = 1.0;
    def.mean_pressure = pressure;
    return def;
}

static lac_scaling measured(const lac_contact_def *contact, lac_scaling_def def)
{
    lac_scaling s;
    lac_error err = {""};
    if (lac_scaling_measure(contact, &def, &s, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return s;
}

static lac_scaling power_law(size_t n, double dimension)
{
    lac_scaling s = {.n = n};
    for (size_t i = 0; i < n; i++) {
        double r = exp2(-(double)i);
        s.at[i] = (lac_resolution){.cell = r, .area = 3.0 * pow(r, 2.0 - dimension)};
        s.at[i].pressure = 12.0 / s.at[i].area;
    }
    return s;
}

static void power_law_is_found(void **state)
{
    (void)state;
    lac_scaling s = power_law(6, 1.6);
    lac_scaling_fit(&s, 0);
    assert_true(fabs(s.dimension - 1.6) < 1e-14);
    assert_true(s.error < 1e-7 && s.regression_error < 1e-7);
    assert_true(fabs(s.load - 12.0) < 1e-12 && s.load_error < 1e-14);
    // A_r = A* r^(2 - D) with A* = 3, p* = P / A*.
    assert_true(fabs(s.fractal_area - 3.0) < 1e-12);
    assert_true(fabs(s.fractal_pressure - 4.0) < 1e-12);
    for (size_t i = 0; i < 5; i++) {
        assert_true(fabs(s.at[i].local - 1.6) < 1e-13);
    }
    assert_true(isnan(s.at[5].local));
    // What is left out of the fit does not matter to it; a load that is not held is seen.
    s.at[5].area *= 1.5;
    lac_scaling_fit(&s, 1);
    assert_true(fabs(s.dimension - 1.6) < 1e-14);
    assert_true(fabs(s.at[4].local - (1.6 + log2(1.5))) < 1e-12);
    assert_true(fabs(s.load_error - (18.0 / 13.0 - 1.0)) < 1e-12);
}

static void table_of_another_code(void **state)
{
    (void)state;
    lac_scaling s = {.n = 5};
    for (size_t i = 0; i < 5; i++) {
        s.at[i] = (lac_resolution){.cell = 1.0 / (double)(64 << i),
                                   .area = joint_area[i],
                                   .pressure = 1e-2 / joint_area[i]};
    }
    lac_scaling_fit(&s, 0);
    assert_true(fabs(s.dimension - 1.705) < 5e-4);
    assert_true(fabs(s.regression_error - 0.010) < 1e-3);
    assert_true(s.error > s.regression_error && s.error < 0.05);
}

// The same areas, solved here, from the heights on the finest grid.
static void rough_joint(void **state)
{
    (void)state;
    double *h = malloc((size_t)SIDE * SIDE * sizeof *h);
    assert_non_null(h);
    assert_int_equal(joint_surface(SIDE, h), 0);
    lac_contact_def contact = contact_of(SIDE, h, 1e-2);
    lac_scaling s = measured(&contact, (lac_scaling_def){.coarsest = 64, .left_out = 0});
    assert_int_equal(s.n, 5);
    for (size_t i = 0; i < 5; i++) {
        print_message("1/%4.0f: A %.6f (%.6f), p %.5f, h' %.4f, local %.3f\n", 1.0 / s.at[i].cell,
                      s.at[i].area, joint_area[i], s.at[i].pressure, s.at[i].slope, s.at[i].local);
        assert_true(fabs(s.at[i].area - joint_area[i]) < 2e-6);
        assert_true(fabs(s.at[i].pressure * s.at[i].area - 1e-2) < 1e-9);
    }
    print_message("Delta_S %.4f +- %.4f (regression %.4f; 1.705 +- 0.010)\n", s.dimension, s.error,
                  s.regression_error);
    assert_true(fabs(s.dimension - 1.705) < 1e-3);
    assert_true(fabs(s.regression_error - 0.010) < 1e-3);
    assert_true(s.load_error < 1e-7);
    // Without the resolution at the cut-off of the surface.
    lac_scaling_fit(&s, 1);
    print_message("without 1/1024: %.4f +- %.4f\n", s.dimension, s.error);
    assert_true(fabs(s.dimension - 1.690) < 1e-3);
    free(h);
}

// sin^2 (k r / 2) / (r / 2)^2: mean square slope that points r apart see of a mode k along a side.
static double seen(double k, double r)
{
    return 4.0 * sin(0.5 * k * r) * sin(0.5 * k * r) / (r * r);
}

// h = cos 2 pi x: each sampling sees its chords, each block mean a wave lowered by its sinc.
static void coarsening_is_what_it_says(void **state)
{
    (void)state;
    const double pi = 3.141592653589793;
    double h[32 * 16];
    for (size_t i = 0; i < 32 * 16; i++) {
        h[i] = 1e-3 * cos(2.0 * pi * ((double)(i % 32) + 0.5) / 32.0);
    }
    lac_contact_def contact = contact_of(32, h, 1e-4);
    contact.grid.ny = 16;
    for (int how = LAC_SAMPLE; how <= LAC_BLOCK_MEAN; how++) {
        lac_scaling_def def = {.coarsest = 4, .left_out = 0, .coarsening = (lac_coarsening)how};
        lac_scaling s = measured(&contact, def);
        assert_int_equal(s.n, 3);
        assert_int_equal(s.coarsening, how);
        for (size_t i = 0; i < 3; i++) {
            size_t m = (size_t)4 >> i;
            double r = (double)m / 32.0;
            double lowered = how == LAC_SAMPLE ? 1.0 : sin(pi * r) / ((double)m * sin(pi / 32.0));
            double slope = lowered * 1e-3 * sqrt(0.5 * seen(2.0 * pi, r));
            assert_true(fabs(s.at[i].cell - r) < 1e-15);
            assert_true(fabs(s.at[i].slope - slope) < 1e-12);
            assert_true(fabs((double)s.at[i].cells * r * r - s.at[i].area) < 1e-15);
        }
    }
}

static void refuse_measure(lac_contact_def contact, lac_scaling_def def, lac_status status,
                           const char *word)
{
    lac_error err = {""};
    lac_scaling s;
    assert_int_equal(lac_scaling_measure(&contact, &def, &s, &err), status);
    assert_non_null(strstr(err.message, word));
}

static void what_cannot_be_fitted_is_refused(void **state)
{
    (void)state;
    double h[64] = {0.0};
    lac_contact_def contact = contact_of(8, h, 1.0);
    refuse_measure(contact, lac_scaling_default(), LAC_EINPUT, "8 x 8");
    refuse_measure(contact, (lac_scaling_def){.coarsest = 0}, LAC_EINPUT, "8 x 8");
    refuse_measure(contact, (lac_scaling_def){.coarsest = 2, .left_out = 1}, LAC_EINPUT,
                   "3 times are needed");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(power_law_is_found),
        cmocka_unit_test(table_of_another_code),
        cmocka_unit_test(rough_joint),
        cmocka_unit_test(coarsening_is_what_it_says),
        cmocka_unit_test(what_cannot_be_fitted_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
