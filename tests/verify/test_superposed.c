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

static const double strength = 0.5 * 4.9e-3;

static void go_by(sheared *s, lac_shear_method method)
{
    s->def.method = method;
    s->def.heights = s->h;
    start_again(s);
}

// With nu = 0 both methods solve the same problem: cell by cell, in three steps and in one.
static void the_same_without_coupling(void **state)
{
    (void)state;
    const double parts[] = {0.3, 0.6, 0.95};
    for (int periodic = 0; periodic < 2; periodic++) {
        sheared s = rough_of(128, periodic == 1, 0.0, 0.5);
        sheared t = rough_of(128, periodic == 1, 0.0, 0.5);
        go_by(&t, LAC_SHEAR_SUPERPOSED);
        for (int k = 0; k < 3; k++) {
            double qx = 0.8 * parts[k] * strength;
            double qy = 0.6 * parts[k] * strength;
            lac_tangential_report a = shear(&s, qx, qy);
            lac_tangential_report b = shear(&t, qx, qy);
            assert_int_equal(a.stick_cells, b.stick_cells);
            assert_int_equal(a.highest_cell, b.highest_cell);
            assert_memory_equal(lac_tangential_state(s.t), lac_tangential_state(t.t), 128 * 128);
            assert_true(fabs(b.shift[0] / a.shift[0] - 1.0) < 1e-7);
            assert_true(fabs(b.shift[1] / a.shift[1] - 1.0) < 1e-7);
            assert_true(fabs(b.dissipation / a.dissipation - 1.0) < 1e-6);
            double worst_slip = 0.0;
            for (size_t i = 0; i < (size_t)128 * 128; i++) {
                for (int axis = 0; axis < 2; axis++) {
                    double q = lac_tangential_traction(s.t, axis)[i];
                    double slip = lac_tangential_slip(s.t, axis)[i];
                    assert_true(fabs(lac_tangential_traction(t.t, axis)[i] - q) <
                                1e-6 * s.contact.max_pressure);
                    worst_slip = fmax(worst_slip, fabs(lac_tangential_slip(t.t, axis)[i] - slip));
                }
            }
            assert_true(worst_slip < 1e-6 * a.shift[0]);
        }
        release(&s);
        release(&t);
    }
}

static void error_at(const sheared *s, double part, size_t largest, lac_superposed_error *e)
{
    lac_error err = {""};
    const double load[2] = {0.0, part * strength};
    if (lac_superposed_measure(&s->def, 4.9e-3, load, largest, e, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    print_message(
        "nu %.1f, Q/fP %.1f, %s, %3zu^2: tractions %.2f %%, stick %+.3f points of contact, "
        "shift %+.2f %%\n",
        s->def.poisson, part, s->def.grid.periodic ? "periodic" : "free", e->nx,
        100.0 * e->traction, 100.0 * e->stick_area, 100.0 * e->shift);
}

// What others measured on the same surface: 4 to 6 %, 0.2 points, 0.5 %.
static void the_error_is_known(void **state)
{
    (void)state;
    for (int periodic = 0; periodic < 2; periodic++) {
        sheared s = rough_of(256, periodic == 1, 0.2, 0.5);
        s.def.heights = s.h;
        for (double part = 0.1; part < 1.0; part += 0.4) {
            lac_superposed_error fine;
            lac_superposed_error coarse;
            error_at(&s, part, 0, &fine);
            error_at(&s, part, 128, &coarse);
            assert_int_equal(fine.nx, 256);
            assert_int_equal(coarse.ny, 128);
            assert_true(fine.traction > 0.035 && fine.traction < 0.065);
            assert_true(fabs(fine.stick_area) <= 2e-3);
            assert_true(fabs(fine.shift) < 5e-3);
            assert_true(fabs(coarse.traction / fine.traction - 1.0) < 0.1);
        }
        release(&s);
    }
}

// Up to full sliding, where Q = f P: every cell at its limit, the shift that of first touch.
static void up_to_full_sliding(void **state)
{
    (void)state;
    sheared s = sphere_of(64, 0.2, 0.0, 0.4);
    go_by(&s, LAC_SHEAR_SUPERPOSED);
    lac_tangential_report r = shear(&s, 0.4 * s.contact.mean_pressure, 0.0);
    assert_int_equal(r.stick_cells, 0);
    for (size_t i = 0; i < (size_t)64 * 64; i++) {
        assert_true(fabs(lac_tangential_traction(s.t, 0)[i] - 0.4 * s.p[i]) < 1e-15);
    }
    // Mindlin at Q = f P with nu = 0: f times the depth of Hertz
    assert_true(fabs(r.shift[0] / (0.4 * 0.2 * 0.2) - 1.0) < 1e-2);
    release(&s);
}

static void first_slip_at(size_t n, lac_first_slip *f)
{
    sheared s = sphere_of(n, 0.2, 0.0, 0.4);
    if (lac_tangential_first_slip(&s.def, s.p, (double[]){1.0, 0.0}, NULL, f, &s.err) != LAC_OK) {
        fail_msg("%s", s.err.message);
    }
    double a = 0.2;
    // no slip: shift = Q (2 - nu)/(8 G a) of each body (Johnson 1985, eq. 7.40)
    double shift = 2.0 * f->load * 2.0 / (8.0 * a);
    double x = ((double)(f->cell % n) - 0.5 * (double)n) / (double)n;
    double y = ((double)(f->cell / n) - 0.5 * (double)n) / (double)n;
    print_message("%3zu^2: first slip at Q/fP %.2e, r/a %.3f, p/p_max %.2e, shift / elastic %.4f\n",
                  n, f->factor, hypot(x, y) / a, s.p[f->cell] / s.contact.max_pressure,
                  f->shift[0] / shift);
    assert_true(fabs(f->shift[0] / shift - 1.0) < 2.0 / (double)n);
    assert_true(fabs(hypot(x, y) / a - 1.0) < 8.0 / (double)n);
    // just above it, that cell alone slips or its mirror images with it
    lac_tangential_report r = shear(&s, 1.0001 * f->load, 0.0);
    assert_true(r.slip_cells >= 1 && r.slip_cells <= 8);
    assert_int_equal(lac_tangential_state(s.t)[f->cell], LAC_CELL_SLIP);
    start_again(&s);
    assert_int_equal(shear(&s, 0.9999 * f->load, 0.0).slip_cells, 0);
    release(&s);
}

// At the edge, whatever the resolution, and the sooner the smaller the cells.
static void first_slip_of_a_sphere(void **state)
{
    (void)state;
    lac_first_slip f[3];
    for (size_t k = 0; k < 3; k++) {
        first_slip_at((size_t)48 << k, &f[k]);
    }
    assert_true(f[2].factor < f[0].factor);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_without_coupling),
        cmocka_unit_test(the_error_is_known),
        cmocka_unit_test(up_to_full_sliding),
        cmocka_unit_test(first_slip_of_a_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
