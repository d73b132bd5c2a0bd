// SPDX-License-Identifier: GPL-3.0-or-later
// Delta_S against 2 - d ln h' / d ln(1/r), which is summed here over the modes of the spectrum,
// knowing nothing of any contact: docs/theory/fractal.md, "Closed form".
//
//   verify_test_fractal_closed_form [SIDE SEEDS]     a longer series, printed and not judged
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "fractal/fractal.h"
#include "support/test.h"
#include "surface/surface.h"

enum { COARSEST = 64, MOST = 8 };

// Heights of side * side points, solved at 1/64 ... 2/side.
typedef struct extent {
    size_t side, points;
    int64_t seeds;
} extent;

static const double hurst = 0.7;
static const double rms_height = 0.01;

// 4 sin^2 (k r / 2) / r^2: twice the mean square slope that points r apart see of a wave of unit
// height along one side.
static double seen(double k, double r)
{
    return 4.0 * sin(0.5 * k * r) * sin(0.5 * k * r) / (r * r);
}

// h'_r of points 1/64 ... 2/side apart on self-affine heights with all waves 1 <= |k| <= side/2.
static void slopes_of_the_spectrum(extent e, double *slope)
{
    const int most = (int)e.side / 2;
    const double tau = 6.283185307179586476925286766559;
    double height = 0.0;
    double square[MOST] = {0.0};
    for (int kx = -most; kx <= most; kx++) {
        for (int ky = -most; ky <= most; ky++) {
            double k = hypot(kx, ky);
            if (k < 1.0 || k > most) {
                continue;
            }
            double power = pow(k, -2.0 * (hurst + 1.0));
            height += power;
            for (size_t i = 0; i < e.points; i++) {
                double r = 1.0 / (double)(COARSEST << i);
                square[i] += power * (seen(tau * kx, r) + seen(tau * ky, r));
            }
        }
    }
    for (size_t i = 0; i < e.points; i++) {
        slope[i] = rms_height * sqrt(square[i] / height);
    }
}

// 2 - slope of ln h' on ln(1/r)
static double closed_form(extent e, const double *slope)
{
    double xy = 0.0;
    double xx = 0.0;
    for (size_t i = 0; i < e.points; i++) {
        double x = (double)i - 0.5 * (double)(e.points - 1);
        xy += x * log2(slope[i]);
        xx += x * x;
    }
    return 2.0 - xy / xx;
}

// One load over the seeds.
typedef struct series {
    double load;         // p / (E* h') at the finest resolution
    double mean, square; // of Delta_S less the closed form
    double kappa[MOST];
    int held; // seeds whose own slopes predict Delta_S within two of its errors
} series;

static void add(extent e, series *s, const lac_scaling *scaling, double pressure, double exact)
{
    s->mean += (scaling->dimension - exact) / (double)e.seeds;
    s->square += (scaling->dimension - exact) * (scaling->dimension - exact) / (double)e.seeds;
    for (size_t i = 0; i < e.points; i++) {
        const lac_resolution *at = &scaling->at[i];
        s->kappa[i] += at->area * at->slope / pressure / (double)e.seeds;
    }
    s->held += fabs(scaling->dimension - scaling->from_slopes) <= 2.0 * scaling->error;
}

// Every second point of the heights: the waves that this does not resolve fold back, as they do at
// all coarser resolutions.
static void make_heights(size_t side, int64_t seed, double *fine, double *heights)
{
    const lac_surface_source *source = lac_surface_source_get(0);
    lac_grid grid = {side, side, 1.0 / (double)side, 1.0 / (double)side, true};
    size_t half = side / 2;
    lac_self_affine p;
    assert_string_equal(source->info.name, "self-affine");
    lac_params_default(&source->info, &p);
    p.hurst = hurst;
    p.rms_height = rms_height;
    p.seed = seed;
    assert_int_equal(source->generate(&p, &grid, NULL, fine, NULL, NULL), LAC_OK);
    for (size_t i = 0; i < half * half; i++) {
        heights[i] = fine[i / half * 2 * side + i % half * 2];
    }
}

static void measure(extent e, series *loads, size_t n, const double *slope)
{
    size_t half = e.side / 2;
    double *fine = malloc(e.side * e.side * sizeof *fine);
    double *heights = malloc(half * half * sizeof *heights);
    assert_true(fine != NULL && heights != NULL);
    lac_contact_def contact = lac_contact_default();
    contact.grid = (lac_grid){half, half, 1.0 / (double)half, 1.0 / (double)half, true};
    contact.heights = heights;
    contact.e_star = 1.0;
    contact.tolerance = 1e-6;
    const lac_scaling_def def = {.coarsest = COARSEST};
    double exact = closed_form(e, slope);
    for (int64_t seed = 1; seed <= e.seeds; seed++) {
        make_heights(e.side, seed, fine, heights);
        for (size_t k = 0; k < n; k++) {
            lac_scaling s;
            lac_error err = {""};
            contact.mean_pressure = loads[k].load * slope[e.points - 1];
            if (lac_scaling_measure(&contact, &def, &s, &err) != LAC_OK) {
                fail_msg("%s", err.message);
            }
            // A surface has the slopes of its spectrum, but for the luck of its longest waves.
            for (size_t i = 0; i < e.points; i++) {
                assert_true(fabs(s.at[i].slope / slope[i] - 1.0) < 0.08);
            }
            add(e, &loads[k], &s, contact.mean_pressure, exact);
        }
    }
    free(fine);
    free(heights);
}

static void print(extent e, const series *s, double exact)
{
    double scatter = sqrt(fmax(0.0, s->square - s->mean * s->mean) / (double)(e.seeds - 1));
    print_message("p/(E* h') %.3f: Delta_S %.4f +- %.4f, closed form %.4f; %d of %d within two "
                  "errors of their own slopes\n",
                  s->load, exact + s->mean, scatter, exact, s->held, (int)e.seeds);
    for (size_t i = 0; i < e.points; i++) {
        print_message("   1/%3d: kappa %.3f\n", COARSEST << i, s->kappa[i]);
    }
}

// The closed form, after measuring and printing the loads.
static double compare(extent e, series *loads, size_t n)
{
    double slope[MOST];
    slopes_of_the_spectrum(e, slope);
    double exact = closed_form(e, slope);
    measure(e, loads, n, slope);
    for (size_t k = 0; k < n; k++) {
        print(e, &loads[k], exact);
    }
    return exact;
}

static void area_scales_as_the_slope(void **state)
{
    (void)state;
    const extent e = {.side = 1024, .points = 4, .seeds = 12};
    series loads[] = {{.load = 0.005}, {.load = 0.02}, {.load = 0.07}};
    double exact = compare(e, loads, 3);
    assert_true(fabs(exact - 1.697) < 1e-3);
    const series *light = &loads[0];
    const series *heavy = &loads[2];
    // The areas as they are counted, where 0.1 to 0.3 of the interface touches.
    assert_true(fabs(heavy->mean) < 0.015);
    assert_true(heavy->held >= 10);
    // What boundary cells do at light load, where patches of the coarse grids are a few cells.
    assert_true(light->mean < -0.04 && light->mean > -0.09);
    assert_true(light->kappa[0] / light->kappa[3] > 1.10);
}

static void print_series(void **state)
{
    series loads[] = {{.load = 0.005}, {.load = 0.02}, {.load = 0.07}};
    (void)compare(*(const extent *)*state, loads, 3);
}

int main(int argc, char **argv)
{
    extent longer = {.side = 0};
    if (argc == 3) {
        longer.side = strtoul(argv[1], NULL, 10);
        longer.seeds = strtol(argv[2], NULL, 10);
        for (size_t n = COARSEST; n < longer.side && longer.points < MOST; n *= 2) {
            longer.points++;
        }
        const struct CMUnitTest only[] = {cmocka_unit_test_prestate(print_series, &longer)};
        return cmocka_run_group_tests(only, NULL, NULL);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(area_scales_as_the_slope),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
