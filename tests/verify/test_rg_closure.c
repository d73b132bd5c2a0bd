// SPDX-License-Identifier: GPL-3.0-or-later
// Fixed points and exponents of maps known in closed form, and what the closure leaves out.

#include <math.h>

#include "rg/rg_map.h"
#include "support/test.h"
#include "support/trees.h"

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static void test_points_of_one_strength(void **state)
{
    (void)state;
    const struct {
        size_t n, k;
        double s, lambda, nu;
    } row[] = {
        {4, 2, 0.2324081208, 1.643210828, 1.395639},
        {4, 3, 0.7675918792, 1.643210828, 1.395639},
        {3, 2, 0.5, 1.5, 1.709511},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        lac_rg_closure c;
        lac_error err = {""};
        assert_int_equal(lac_rg_closure_points(row[i].n, row[i].k, &c, &err), LAC_OK);
        assert_near(c.fixed_point, row[i].s, 1e-10);
        assert_near(c.lambda, row[i].lambda, 1e-9);
        assert_near(c.nu, row[i].nu, 1e-6);
    }
}

static void test_weibull_points(void **state)
{
    (void)state;
    const struct {
        size_t n;
        double m, p, lambda, nu;
    } row[] = {
        {2, 1, 0.5, 1.5, 1.709511},
        {2, 2, 0.2062994740, 1.61889842, 1.438823},
        {2, 3, 0.0942763357, 1.65993435, 1.367753},
        {3, 2, 0.1812978209, 2.04903884, 0.966233},
        {4, 1, 0.4292659299, 2.23073446, 0.863917},
        {4, 2, 0.1707398024, 2.35705529, 0.808417},
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        lac_rg_closure c;
        lac_error err = {""};
        assert_int_equal(lac_rg_closure_weibull(row[i].n, row[i].m, &c, &err), LAC_OK);
        assert_near(c.fixed_point, row[i].p, 1e-10);
        assert_near(c.lambda, row[i].lambda, 1e-8);
        assert_near(c.nu, row[i].nu, 1e-6);
    }
}

static void test_four_points_as_a_polynomial(void **state)
{
    (void)state;
    for (double p = 0.01; p < 1.0; p += 0.07) {
        double u[4];
        for (size_t k = 0; k < 4; k++) {
            u[k] = 1.0 - pow(1.0 - p, pow(4.0 / (4.0 - (double)k), 2.0));
        }
        double expected = 24 * u[0] * u[1] * u[2] * u[3] - 12 * u[0] * u[0] * u[2] * u[3] -
                          12 * u[0] * u[1] * u[1] * u[3] - 12 * u[0] * u[1] * u[2] * u[2] +
                          6 * u[0] * u[0] * u[2] * u[2] + 4 * u[0] * u[0] * u[0] * u[3] +
                          4 * u[0] * u[1] * u[1] * u[1] - u[0] * u[0] * u[0] * u[0];
        assert_near(lac_rg_all_below(4, u), expected, 1e-13);
    }
}

static void test_order_by_counting(void **state)
{
    (void)state;
    const double bound[3] = {0.3, 0.6, 0.7};
    const int draws = 200000;
    int below = 0;
    for (int i = 0; i < draws; i++) {
        double x[3];
        for (uint64_t j = 0; j < 3; j++) {
            x[j] = draw_uniform(7, 3 * (uint64_t)i + j, 0, 1);
        }
        double least = fmin(x[0], fmin(x[1], x[2]));
        double most = fmax(x[0], fmax(x[1], x[2]));
        double middle = x[0] + x[1] + x[2] - least - most;
        below += least < bound[0] && middle < bound[1] && most < bound[2];
    }
    double exact = lac_rg_all_below(3, bound);
    double error = sqrt(exact * (1.0 - exact) / draws);
    assert_near((double)below / draws, exact, 4.0 * error);
}

// Probability that a block of 2^level points fails under F each, without the closure: the halves
// of a block share what it carries, not what a point of its own would.
static double exact_failure(int level, double f)
{
    double w[64];
    for (int k = 0; k <= level; k++) {
        w[k] = -expm1(-pow(ldexp(f, k), 2.0)); // under 2^k f, modulus 2
    }
    for (int l = 1; l <= level; l++) {
        for (int k = 0; k + l <= level; k++) {
            w[k] = 2.0 * w[k] * w[k + 1] - w[k] * w[k];
        }
    }
    return w[0];
}

// The strength of the exact hierarchy falls for ever: it has no threshold, as the closure has.
static void test_exact_recursion_has_no_threshold(void **state)
{
    (void)state;
    const struct {
        int level;
        double median;
    } row[] = {{0, .833}, {1, .689}, {2, .573}, {3, .487}, {4, .425}, {10, .262}, {50, .134}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        double low = 0.0;
        double high = 2.0;
        for (int step = 0; step < 60; step++) {
            double middle = 0.5 * (low + high);
            bool weaker = exact_failure(row[i].level, middle) > 0.5;
            low = weaker ? low : middle;
            high = weaker ? middle : high;
        }
        assert_near(high, row[i].median, 6e-4);
    }
    lac_rg_closure c;
    lac_error err = {""};
    assert_int_equal(lac_rg_closure_weibull(2, 2.0, &c, &err), LAC_OK);
    assert_near(sqrt(-log1p(-c.fixed_point)), 0.4807, 1e-4);
}

static void test_what_cannot_be_is_refused(void **state)
{
    (void)state;
    lac_rg_closure c;
    lac_error err = {""};
    assert_int_equal(lac_rg_closure_points(4, 0, &c, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_closure_points(4, 5, &c, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_closure_points(65, 5, &c, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_closure_weibull(1, 1.0, &c, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_closure_weibull(2, NAN, &c, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_closure_weibull(2, 0.0, &c, &err), LAC_EINPUT);
    // any one of them, or all of them: no fixed point in between
    assert_int_equal(lac_rg_closure_points(4, 1, &c, &err), LAC_OK);
    assert_true(isnan(c.fixed_point));
    assert_int_equal(lac_rg_closure_points(4, 4, &c, &err), LAC_OK);
    assert_true(isnan(c.fixed_point));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_of_one_strength),
        cmocka_unit_test(test_weibull_points),
        cmocka_unit_test(test_four_points_as_a_polynomial),
        cmocka_unit_test(test_order_by_counting),
        cmocka_unit_test(test_exact_recursion_has_no_threshold),
        cmocka_unit_test(test_what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
