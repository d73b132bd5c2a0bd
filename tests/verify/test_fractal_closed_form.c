// SPDX-License-Identifier: GPL-3.0-or-later
// Delta_S against 2 - d ln h' / d ln(1/r), which is summed here over the modes of the spectrum,
// knowing nothing of any contact: docs/theory/fractal.md, "Closed form".
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>

#include "lacuna/fractal.h"
#include "lacuna/surface.h"

enum { SIDE = 1024, FINEST = 512, POINTS = 4, SEEDS = 12 };
static const double hurst = 0.7;
static const double rms_height = 0.01;

// 4 sin^2 (k r / 2) / r^2: twice the mean square slope that points r apart see of a wave of unit
// height along one side.
static double seen(double k, double r)
{
    return 4.0 * sin(0.5 * k * r) * sin(0.5 * k * r) / (r * r);
}

// h'_r of points 1/64 ... 1/512 apart on self-affine heights with all waves 1 <= |k| <= 512.
static void slopes_of_the_spectrum(double *slope)
{
    const double tau = 6.283185307179586476925286766559;
    double height = 0.0;
    double square[POINTS] = {0.0};
    for (int kx = -SIDE / 2; kx <= SIDE / 2; kx++) {
        for (int ky = -SIDE / 2; ky <= SIDE / 2; ky++) {
            double k = hypot(kx, ky);
            if (k < 1.0 || k > SIDE / 2) {
                continue;
            }
            double power = pow(k, -2.0 * (hurst + 1.0));
            height += power;
            for (size_t i = 0; i < POINTS; i++) {
                double r = 1.0 / (double)(64 << i);
                square[i] += power * (seen(tau * kx, r) + seen(tau * ky, r));
            }
        }
    }
    for (size_t i = 0; i < POINTS; i++) {
        slope[i] = rms_height * sqrt(square[i] / height);
    }
}

// 2 - slope of ln h' on ln(1/r)
static double closed_form(const double *slope)
{
    double xy = 0.0;
    double xx = 0.0;
    for (size_t i = 0; i < POINTS; i++) {
        double x = (double)i - 0.5 * (POINTS - 1);
        xy += x * log2(slope[i]);
        xx += x * x;
    }
    return 2.0 - xy / xx;
}

// One load over the seeds.
typedef struct series {
    double load;         // p / (E* h') at the finest resolution
    double mean, square; // of Delta_S less the closed form
    double smooth;       // mean of Delta_S of the areas less their boundary cells, less that
    double kappa[POINTS], kappa_smooth[POINTS];
    int held; // seeds whose own slopes predict Delta_S within two of its errors
} series;

static void add(series *s, const lac_scaling *scaling, double pressure, double exact)
{
    s->mean += (scaling->dimension - exact) / SEEDS;
    s->square += (scaling->dimension - exact) * (scaling->dimension - exact) / SEEDS;
    s->smooth += (scaling->smooth - exact) / SEEDS;
    for (size_t i = 0; i < POINTS; i++) {
        const lac_resolution *at = &scaling->at[i];
        s->kappa[i] += at->area * at->slope / pressure / SEEDS;
        s->kappa_smooth[i] += lac_smooth_area(at) * at->slope / pressure / SEEDS;
    }
    s->held += fabs(scaling->dimension - scaling->from_slopes) <= 2.0 * scaling->error;
}

// Every second point of 1024 x 1024: the waves that 1/512 does not resolve fold back, as they do
// at all coarser resolutions.
static void make_heights(int64_t seed, double *fine, double *heights)
{
    const lac_surface_source *source = lac_surface_source_at(0);
    lac_grid grid = {SIDE, SIDE, 1.0 / SIDE, 1.0 / SIDE, true};
    lac_self_affine p;
    assert_string_equal(source->about.name, "self-affine");
    assert_int_equal(lac_params_default(&source->about, &p, NULL), LAC_OK);
    p.hurst = hurst;
    p.rms_height = rms_height;
    p.seed = seed;
    assert_int_equal(source->generate(&p, &grid, fine, NULL), LAC_OK);
    for (size_t i = 0; i < (size_t)FINEST * FINEST; i++) {
        heights[i] = fine[i / FINEST * 2 * SIDE + i % FINEST * 2];
    }
}

static void measure(series *loads, size_t n, const double *slope)
{
    double *fine = malloc((size_t)SIDE * SIDE * sizeof *fine);
    double *heights = malloc((size_t)FINEST * FINEST * sizeof *heights);
    assert_true(fine != NULL && heights != NULL);
    lac_contact_def contact = lac_contact_default();
    contact.grid = (lac_grid){FINEST, FINEST, 1.0 / FINEST, 1.0 / FINEST, true};
    contact.heights = heights;
    contact.e_star = 1.0;
    contact.tolerance = 1e-6;
    const lac_scaling_def def = {.coarsest = 64};
    double exact = closed_form(slope);
    for (int64_t seed = 1; seed <= SEEDS; seed++) {
        make_heights(seed, fine, heights);
        for (size_t k = 0; k < n; k++) {
            lac_scaling s;
            lac_error err = {""};
            contact.mean_pressure = loads[k].load * slope[POINTS - 1];
            if (lac_scaling_measure(&contact, &def, &s, &err) != LAC_OK) {
                fail_msg("%s", err.message);
            }
            // A surface has the slopes of its spectrum, but for the luck of its longest waves.
            for (size_t i = 0; i < POINTS; i++) {
                assert_true(fabs(s.at[i].slope / slope[i] - 1.0) < 0.08);
            }
            add(&loads[k], &s, contact.mean_pressure, exact);
        }
    }
    free(fine);
    free(heights);
}

static void print(const series *s, double exact)
{
    double scatter = sqrt(fmax(0.0, s->square - s->mean * s->mean) / (SEEDS - 1));
    print_message("p/(E* h') %.3f: Delta_S %.4f +- %.4f, less boundary cells %.4f, closed form "
                  "%.4f; %d of %d within two errors of their own slopes\n",
                  s->load, exact + s->mean, scatter, exact + s->smooth, exact, s->held, SEEDS);
    for (size_t i = 0; i < POINTS; i++) {
        print_message("   1/%3d: kappa %.3f, less boundary cells %.3f\n", 64 << i, s->kappa[i],
                      s->kappa_smooth[i]);
    }
}

static void area_scales_as_the_slope(void **state)
{
    (void)state;
    series loads[] = {{.load = 0.005}, {.load = 0.02}, {.load = 0.07}};
    double slope[POINTS];
    slopes_of_the_spectrum(slope);
    double exact = closed_form(slope);
    measure(loads, 3, slope);
    for (size_t k = 0; k < 3; k++) {
        print(&loads[k], exact);
    }
    assert_true(fabs(exact - 1.697) < 1e-3);
    const series *light = &loads[0];
    const series *middle = &loads[1];
    const series *heavy = &loads[2];
    // The areas as they are counted, where 0.1 to 0.3 of the interface touches.
    assert_true(fabs(heavy->mean) < 0.015);
    assert_true(heavy->held >= SEEDS - 2);
    // Less their boundary cells, at lighter load too; the lighter, the further below.
    assert_true(fabs(heavy->smooth) < 0.015);
    assert_true(middle->smooth < 0.0 && middle->smooth > -0.025);
    assert_true(light->smooth < middle->smooth && light->smooth > -0.035);
    // What boundary cells do at light load, where patches of the coarse grids are a few cells.
    assert_true(light->mean < -0.04 && light->mean > -0.09);
    assert_true(light->kappa[0] / light->kappa[3] > 1.10);
    assert_true(light->kappa_smooth[0] / light->kappa_smooth[3] < 1.07);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(area_scales_as_the_slope),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
