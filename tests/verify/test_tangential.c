// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <omp.h>

#include "contact/tangential.h"
#include "support/sheared.h"
#include "support/test.h"

// Sphere of R = E* = 1 on a free grid of side 5 a, a = 0.2: Q = 0.875 f P leaves half the radius
// stuck. Mindlin's shift 3 f P (2 - nu) / (16 G a) (1 - (1 - Q/fP)^(2/3)), of each body; both:
// twice.
static void mindlin_at(size_t n, double nu, double ratio, size_t stick, size_t contact)
{
    const double a = 0.2;
    const double f = 0.4;
    const double load = 4.0 / 3.0 * a * a * a;
    sheared s = sphere_of(n, a, nu, f);
    lac_tangential_stats r = shear(&s, 0.875 * f * s.contact.mean_pressure, 0.0);
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

// So far below what friction holds nothing slips: the joint is linear, down to the least of loads.
static void least_loads(void **state)
{
    (void)state;
    sheared s = rough_of(64, false, 0.2, 0.5);
    lac_first_slip first;
    const double along[] = {0.6, 0.8};
    assert_int_equal(lac_tangential_first_slip(&s.def, s.p, along, &first, &s.err), LAC_OK);
    for (double part = 0.1; part > 1e-100; part *= 1e-3) {
        start_again(&s);
        double load = part * first.load;
        lac_tangential_stats r = shear(&s, 0.6 * load, 0.8 * load);
        assert_int_equal(r.slip_cells, 0);
        assert_true(fabs(r.highest_ratio / part - 1.0) < 1e-6);
        double sum = 0.0;
        for (size_t i = 0; i < s.n * s.n; i++) {
            sum += s.t->traction[1][i] / (double)(s.n * s.n);
        }
        assert_true(fabs(sum / (0.8 * load) - 1.0) < 1e-12);
        assert_true(fabs(r.shift[0] / (part * first.shift[0]) - 1.0) < 1e-7);
        assert_true(fabs(r.shift[1] / (part * first.shift[1]) - 1.0) < 1e-7);
    }
    release(&s);
}

static void rough_joint(void **state)
{
    (void)state;
    sheared s = rough_of(256, false, 0.2, 0.5);
    // the reference was loaded along what is y here
    lac_tangential_stats r = shear(&s, 0.0, 0.5 * 0.5 * 4.9e-3);
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

// Tractions along x after a load, from the virgin state; the caller frees them
static double *tractions_at(sheared *s, double qx, double *shift)
{
    const size_t cells = s->n * s->n;
    double *tau = malloc(cells * sizeof *tau);
    assert_non_null(tau);
    start_again(s);
    *shift = shear(s, qx, 0.0).shift[0];
    memcpy(tau, s->t->traction[0], cells * sizeof *tau);
    return tau;
}

static double largest_difference(const sheared *s, const double *a, const double *b,
                                 const double *c, double factor)
{
    double most = 0.0;
    for (size_t i = 0; i < s->n * s->n; i++) {
        most = fmax(most, fabs(a[i] - (b[i] + factor * c[i])));
    }
    return most / s->contact.max_pressure;
}

// With nu = 0, one direction and constant pressure, going back from Q to R superposes twice the
// virgin response to (Q - R)/2 (Masing 1926): in shift and in every cell. Back at Q nothing is left
// of the way there.
static void masing(void **state)
{
    (void)state;
    const double q = 0.6 * 0.5 * 4.9e-3;
    const double r = -0.2 * 0.5 * 4.9e-3;
    sheared s = rough_of(256, true, 0.0, 0.5);
    double shift_q;
    double shift_half;
    double *up = tractions_at(&s, q, &shift_q);
    double *half = tractions_at(&s, 0.5 * (q - r), &shift_half);
    start_again(&s);
    (void)shear(&s, q, 0.0);
    double shift = shear(&s, r, 0.0).shift[0];
    double off = largest_difference(&s, s.t->traction[0], up, half, -2.0);
    double back = shear(&s, q, 0.0).shift[0];
    double left = largest_difference(&s, s.t->traction[0], up, half, 0.0);
    print_message("Masing: shift %.1e, tractions %.1e; memory erased: %.1e, %.1e\n",
                  shift / (shift_q - 2.0 * shift_half) - 1.0, off, back / shift_q - 1.0, left);
    assert_true(fabs(shift / (shift_q - 2.0 * shift_half) - 1.0) < 1e-8);
    assert_true(off < 1e-7);
    assert_true(fabs(back / shift_q - 1.0) < 1e-8);
    assert_true(left < 1e-7);
    free(up);
    free(half);
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
        lac_tangential_stats r = shear(&s, load[k] * 0.5 * 4.9e-3, 0.0);
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
    lac_tangential_stats load = shear(&s, 0.4 * strength, 0.3 * strength);
    start_again(&s);
    lac_tangential_stats given = drag(&s, load.shift[0], load.shift[1]);
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

// In full contact nothing elastic holds the mean of the tractions along an axis whose shift is
// given: slid as a whole along x, then loaded along y, most cells come to stick, at a lower mean.
static void slid_then_loaded_across(void **state)
{
    (void)state;
    const double strength = 0.5 * 0.3;
    sheared s = rough_of(64, true, 0.2, 0.5);
    press(&s, 0.3);
    assert_int_equal(s.contact.n_cells, 64 * 64);
    (void)drag(&s, 1.0, 0.0);
    for (int k = 1; k <= 3; k++) {
        const lac_tangential_target target = {{LAC_SHEAR_SHIFT, LAC_SHEAR_LOAD},
                                              {1.0, 0.1 * k * strength}};
        lac_tangential_stats r;
        lac_status status = lac_tangential_step(s.t, s.p, &target, &r, &s.err);
        print_message("loaded across by %.1f f P: %lld iterations, %zu slip\n", 0.1 * k,
                      (long long)r.iterations, r.slip_cells);
        assert_int_equal(status, LAC_OK);
        assert_true(r.iterations < 100);
        assert_true(hypot(r.traction[0], r.traction[1]) < strength);
    }
    release(&s);
}

static void any_number_of_threads(void **state)
{
    (void)state;
    sheared s = rough_of(128, false, 0.3, 0.5);
    double *tau[2];
    for (int k = 0; k < 2; k++) {
        omp_set_num_threads(1 + 3 * k);
        double shift;
        tau[k] = tractions_at(&s, 0.7 * 0.5 * 4.9e-3, &shift);
    }
    assert_memory_equal(tau[0], tau[1], 128 * 128 * sizeof(double));
    free(tau[0]);
    free(tau[1]);
    release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mindlin),
        cmocka_unit_test(least_loads),
        cmocka_unit_test(rough_joint),
        cmocka_unit_test(cycles),
        cmocka_unit_test(masing),
        cmocka_unit_test(given_shift),
        cmocka_unit_test(slid_then_loaded_across),
        cmocka_unit_test(any_number_of_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
