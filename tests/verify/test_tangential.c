// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>

#include "lacuna/tangential.h"
#include "support/sheared.h"

// Sphere of R = E* = 1 on a free grid of side 5 a, a = 0.2: Q = 0.875 f P leaves half the radius
// stuck. Mindlin's shift 3 f P (2 - nu) / (16 G a) (1 - (1 - Q/fP)^(2/3)), of each body; both:
// twice.
static void mindlin_at(size_t n, double nu, double ratio, size_t stick, size_t contact)
{
    const double a = 0.2;
    const double f = 0.4;
    const double load = 4.0 / 3.0 * a * a * a;
    sheared s = sphere_of(n, a, nu, f);
    lac_tangential_report r = shear(&s, 0.875 * f * s.contact.mean_pressure, 0.0);
    const double modulus = 1.0 - nu; // E* = G / (1 - nu)
    double shift = 2.0 * 3.0 * f * load * (2.0 - nu) / (16.0 * modulus * a) * (1.0 - 0.25);
    print_message("nu %.2f, %3zu^2: %zu of %zu stick, shift / Mindlin %.5f, %lld products\n", nu, n,
                  r.stick_cells, r.contact_cells, r.shift[0] / shift, (long long)r.products);
    assert_true(fabs(r.shift[0] / shift - ratio) < 5.0 / ((double)n * (double)n));
    assert_true(fabs(r.shift[1]) < 1e-9 * shift);
    if (stick > 0) {
        assert_int_equal(r.stick_cells, stick);
        assert_int_equal(r.contact_cells, contact);
    }
    double radius = sqrt((double)r.stick_cells / (double)r.contact_cells);
    assert_true(fabs(radius - 0.5) < 1.0 / (double)n);
    release(&s);
}

// That it slips a little across the load is more than Mindlin knows, so that his shift is too long.
static void mindlin(void **state)
{
    (void)state;
    mindlin_at(64, 0.42, 0.9982, 137, 517);
    mindlin_at(128, 0.42, 0.9982, 517, 2085);
    mindlin_at(256, 0.42, 0.9982, 2069, 8277);
    mindlin_at(256, 0.25, 0.9995, 0, 0);
    mindlin_at(256, 0.0, 1.0, 0, 0);
}

static void rough_joint(void **state)
{
    (void)state;
    sheared s = rough_of(256, false, 0.2, 0.5);
    // the reference was loaded along what is y here
    lac_tangential_report r = shear(&s, 0.0, 0.5 * 0.5 * 4.9e-3);
    print_message("A08_256 free: %zu contact, %zu stick, %zu slip, shift (%.8e, %.4e), %lld "
                  "products\n",
                  r.contact_cells, r.stick_cells, r.slip_cells, r.shift[1], r.shift[0],
                  (long long)r.products);
    assert_int_equal(r.contact_cells, 6490);
    assert_int_equal(r.stick_cells, 3377);
    assert_int_equal(r.slip_cells, 3113);
    assert_true(fabs(r.shift[1] - 1.66248550e-3) < 1e-11);
    assert_true(fabs(r.shift[0] + 1.0840e-6) < 1e-10);
    release(&s);
}

static void cycles(void **state)
{
    (void)state;
    const double load[] = {0.3, 0.6, 0.2, -0.2, -0.6, -0.2, 0.2, 0.6, 0.8};
    const double shift[] = {2.10696078e-4,  5.46940959e-4,  2.83936403e-4,
                            -5.81727731e-5, -5.46940959e-4, -2.83936403e-4,
                            5.81727731e-5,  5.46940959e-4,  9.65336400e-4};
    sheared s = rough_of(256, true, 0.0, 0.5);
    for (size_t k = 0; k < 9; k++) {
        lac_tangential_report r = shear(&s, load[k] * 0.5 * 4.9e-3, 0.0);
        print_message("Q/fP %+.1f: shift %.8e (%.8e), %lld products\n", load[k], r.shift[0],
                      shift[k], (long long)r.products);
        assert_true(fabs(r.shift[0] - shift[k]) < 1e-12);
    }
    release(&s);
}

// The shift that a load takes, given, takes that load; a long way sides come to full sliding.
static void given_shift(void **state)
{
    (void)state;
    const double strength = 0.5 * 4.9e-3;
    sheared s = rough_of(256, true, 0.2, 0.5);
    lac_tangential_report load = shear(&s, 0.4 * strength, 0.3 * strength);
    start_again(&s);
    lac_tangential_report given = drag(&s, load.shift[0], load.shift[1]);
    assert_true(fabs(given.traction[0] / load.traction[0] - 1.0) < 1e-8);
    assert_true(fabs(given.traction[1] / load.traction[1] - 1.0) < 1e-8);
    assert_int_equal(given.stick_cells, load.stick_cells);
    given = drag(&s, 0.6, 0.8);
    assert_int_equal(given.stick_cells, 0);
    assert_int_equal(given.highest_cell, SIZE_MAX);
    assert_true(fabs(given.traction[0] / strength - 0.6) < 1e-3);
    assert_true(fabs(hypot(given.traction[0], given.traction[1]) / strength - 1.0) < 1e-6);
    release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mindlin),
        cmocka_unit_test(rough_joint),
        cmocka_unit_test(cycles),
        cmocka_unit_test(given_shift),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
