// SPDX-License-Identifier: GPL-3.0-or-later
// Loading paths, slipped fractions along them, and the map fitted to those.

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rg/rg.h"
#include "rg/rg_study.h"
#include "support/test.h"
#include "support/trees.h"

enum { MOST = 64 };

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static void draw_strengths(uint64_t seed, size_t n, double *strength)
{
    for (size_t i = 0; i < n; i++) {
        strength[i] = draw_log(seed, i, 0.1, 10);
    }
}

static void test_equal_stress_carries_the_load(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 300; seed++) {
        size_t n = 1 + seed % MOST;
        double strength[MOST];
        double shear[MOST];
        double gap[MOST];
        lac_error err = {""};
        lac_rg_path *path = NULL;
        draw_strengths(seed, n, strength);
        assert_int_equal(lac_rg_path_further(n, strength, NULL, &path, &err), LAC_OK);
        for (double load = 0.0; load <= 1.0; load += 0.125) {
            double given = 0.0;
            double carried = 0.0;
            lac_rg_path_eval(path, load, shear, gap);
            for (size_t i = 0; i < n; i++) {
                given += load * strength[i];
                carried += shear[i];
                // the same stress on each, less what is beyond the cap
                assert_near(strength[i] - gap[i], strength[0] - gap[0], 1e-13 * 10);
                assert_near(shear[i], fmin(strength[i], strength[i] - gap[i]), 1e-13);
            }
            assert_near(carried, given, 1e-12 * (given + 1.0));
        }
        lac_rg_path_free(path);
    }
}

// Uniform stress only shifts the root's threshold, so that Q_crit follows from a pass at no load.
static void test_uniform_stress_slides_where_one_pass_says(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 200; seed++) {
        lac_domain *domain = random_domain(seed, MOST);
        lac_hierarchy *h = hierarchy_of(domain);
        size_t n = domain->n;
        double strength[MOST], drop[MOST], work[2 * MOST], none[MOST] = {0}, total = 0.0;
        lac_error err = {""};
        lac_rg_path *path = NULL;
        lac_rg_tree *tree = NULL;
        draw_strengths(seed, n, strength);
        for (size_t i = 0; i < n; i++) {
            drop[i] = draw_uniform(seed, 1000, 0, 0.5) * strength[i];
            total += strength[i];
        }
        assert_int_equal(lac_rg_path_uniform(n, strength, &path, &err), LAC_OK);
        assert_int_equal(lac_rg_tree_create(h, strength, drop, &tree, &err), LAC_OK);
        lac_rg_path_eval(path, 0.5, work, work + n);
        for (size_t i = 0; i < n; i++) {
            assert_near(work[i], 0.5 * total / (double)n, 1e-12 * total);
            assert_near(work[n + i], strength[i] - work[i], 1e-12 * total);
        }
        double cons = (double)n * lac_rg_pass(tree, LAC_RG_CONS, none, NULL) / total;
        double fix = (double)n * lac_rg_pass(tree, LAC_RG_FIX, none, NULL) / total;
        assert_near(lac_rg_critical(tree, LAC_RG_CONS, path, work), cons, 1e-8);
        if (fix <= 1.0) { // under stress that has no caps FIX can ask for more than f P
            assert_near(lac_rg_critical(tree, LAC_RG_FIX, path, work), fix, 1e-8);
        }
        lac_rg_tree_free(tree);
        lac_rg_path_free(path);
        lac_hierarchy_free(h);
        lac_domain_free(domain);
    }
}

static void test_elastic_path_passes_through_its_solutions(void **state)
{
    (void)state;
    const double part[3] = {1.0, 0.25, 0.0};
    const double pressure[9] = {1, 2, 4, 0, 0.5, 2, 0, 0, 0};
    const lac_rg_series series = {3, 3, part, pressure, 0.5};
    lac_error err = {""};
    lac_rg_path *path = NULL;
    double shear[3];
    double gap[3];
    assert_int_equal(lac_rg_path_elastic(&series, &path, &err), LAC_OK);
    for (size_t k = 0; k < 3; k++) {
        lac_rg_path_eval(path, 1.0 - part[k], shear, gap);
        for (size_t i = 0; i < 3; i++) {
            assert_near(gap[i], 0.5 * pressure[3 * k + i], 1e-15);
            assert_near(shear[i] + gap[i], 0.5 * pressure[i], 1e-15);
        }
    }
    lac_rg_path_eval(path, 0.375, shear, gap); // half way to the second
    assert_near(gap[1], 0.5 * 1.25, 1e-15);
    lac_rg_path_free(path);
}

static void refuse_series(const lac_rg_series *series)
{
    lac_error err = {""};
    lac_rg_path *path = NULL;
    assert_int_equal(lac_rg_path_elastic(series, &path, &err), LAC_EINPUT);
    assert_null(path);
    assert_true(strlen(err.message) > 0);
}

static void test_wrong_series_are_refused(void **state)
{
    (void)state;
    const double part[3] = {1.0, 0.25, 0.0};
    const double pressure[3] = {1, 0.5, 0};
    const double nan_pressure[3] = {NAN, 0.5, 0};
    const double open[3] = {0, 0, 0};
    refuse_series(&(lac_rg_series){1, 3, part, nan_pressure, 0.5});
    refuse_series(&(lac_rg_series){1, 3, part, open, 0.5});
    refuse_series(&(lac_rg_series){0, 3, part, pressure, 0.5});
}

static void test_loads_run_from_all_to_none(void **state)
{
    (void)state;
    double part[LAC_RG_LOADS];
    lac_rg_loads(LAC_RG_LOADS, part);
    assert_near(part[0], 1.0, 0.0);
    assert_near(part[9], 0.1, 1e-15);
    assert_near(part[LAC_RG_LOADS - 2], 0.002, 1e-15);
    assert_near(part[LAC_RG_LOADS - 1], 0.0, 0.0);
    for (size_t k = 10; k + 2 < LAC_RG_LOADS; k++) {
        assert_near(part[k + 1] / part[k], part[10] / part[9], 1e-12);
    }
}

static void test_map_is_recovered(void **state)
{
    (void)state;
    const double lambda = 1.643210828;
    const double centre = 0.62;
    double s[50];
    double next[50];
    lac_error err = {""};
    lac_rg_map map;
    double g = (1.0 - lambda) * log(centre / (1.0 - centre));
    for (size_t i = 0; i < 50; i++) {
        s[i] = (double)i / 49.0;
        next[i] =
            i == 0 || i == 49 ? s[i] : 1.0 / (1.0 + exp(-lambda * log(s[i] / (1.0 - s[i])) - g));
    }
    assert_int_equal(lac_rg_map_fit(50, s, next, &map, &err), LAC_OK);
    assert_near(map.lambda, lambda, 1e-12);
    assert_near(map.fixed_point, centre, 1e-12);
    assert_near(map.nu, 1.395639, 1e-6);
    assert_near(map.residual, 0.0, 1e-7);
    // on the diagonal there is no fixed point in between
    assert_int_equal(lac_rg_map_fit(50, s, s, &map, &err), LAC_OK);
    assert_near(map.lambda, 1.0, 1e-12);
    assert_int_equal(lac_rg_map_fit(2, s, next, &map, &err), LAC_EINPUT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_stress_carries_the_load),
        cmocka_unit_test(test_uniform_stress_slides_where_one_pass_says),
        cmocka_unit_test(test_elastic_path_passes_through_its_solutions),
        cmocka_unit_test(test_wrong_series_are_refused),
        cmocka_unit_test(test_loads_run_from_all_to_none),
        cmocka_unit_test(test_map_is_recovered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
