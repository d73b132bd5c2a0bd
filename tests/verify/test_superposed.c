// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "contact/tangential.h"
#include "support/sheared.h"
#include "support/test.h"

enum { N = 256, CELLS = N * N };

// Ciavarella (1998), Jaeger (1998): under a load Q that grows along one direction while P is held,
//   q = f [p(P) - p(P - Q/f)],   stick where p(P - Q/f) > 0,   U = f k [a(P - Q/f) - a(P)],
// a the approach and k = (1 - nu/2)/(1 - nu): two normal contacts, and no shear solver. With nu = 0
// this is exact. What the load along y leaves against that: rms of the tractions over their rms,
// cells that stick over the contact, shift.
static void superpose(sheared *s, double part, double off[3])
{
    const lac_contact_stats full = s->contact;
    const double nu = s->def.poisson;
    const double f = s->def.friction;
    const double load = part * f * s->normal.mean_pressure;
    double *p = malloc(CELLS * sizeof *p);
    double difference = 0.0;
    double size = 0.0;
    double sticks = 0.0;
    assert_non_null(p);
    memcpy(p, s->p, CELLS * sizeof *p);
    const lac_tangential_stats coupled = shear(s, 0.0, load);
    press(s, s->normal.mean_pressure - load / f); // now s->p is p(P - Q/f)
    for (size_t i = 0; i < CELLS; i++) {
        double along = s->t->traction[1][i];
        difference = hypot(difference, f * (p[i] - s->p[i]) - along);
        difference = hypot(difference, s->t->traction[0][i]);
        size = hypot(hypot(size, along), s->t->traction[0][i]);
        sticks += p[i] > 0.0 && s->p[i] > 0.0 ? 1.0 : 0.0;
    }
    double shift = f * (1.0 - 0.5 * nu) / (1.0 - nu) * (s->contact.approach - full.approach);
    off[0] = difference / size;
    off[1] = (sticks - (double)coupled.stick_cells) / (double)coupled.contact_cells;
    off[2] = shift / coupled.shift[1] - 1.0;
    free(p);
}

static void exact_without_coupling(void **state)
{
    (void)state;
    for (int periodic = 0; periodic < 2; periodic++) {
        double off[3];
        sheared s = rough_of(N, periodic == 1, 0.0, 0.5);
        superpose(&s, 0.6, off);
        assert_true(off[0] < 1e-6 && off[1] == 0.0 && fabs(off[2]) < 1e-7);
        release(&s);
    }
}

// The table of docs/tables/theory-tangential.md, in hundredths.
static void its_error_with_coupling(void **state)
{
    static const struct {
        bool periodic;
        double part, off[3];
    } rows[] = {
        {false, 0.1, {6.0, 0.05, 0.14}}, {false, 0.5, {5.5, 0.15, 0.15}},
        {false, 0.9, {3.9, 0.05, 0.09}}, {true, 0.1, {6.2, 0.06, 0.43}},
        {true, 0.5, {5.4, -0.02, 0.49}}, {true, 0.9, {3.7, 0.13, 0.18}},
    };
    (void)state;
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        double off[3];
        sheared s = rough_of(N, rows[k].periodic, 0.2, 0.5);
        superpose(&s, rows[k].part, off);
        print_message("Q/fP %.1f, %s: tractions %.2f %%, stick %+.3f points, shift %+.3f %%\n",
                      rows[k].part, rows[k].periodic ? "periodic" : "free", 100 * off[0],
                      100 * off[1], 100 * off[2]);
        assert_true(fabs(100 * off[0] - rows[k].off[0]) < 0.051);
        assert_true(fabs(100 * off[1] - rows[k].off[1]) < 0.016); // a cell
        assert_true(fabs(100 * off[2] - rows[k].off[2]) < 0.0051);
        release(&s);
    }
}

static void first_slip_at(size_t n, lac_first_slip *f)
{
    sheared s = sphere_of(n, 0.2, 0.0, 0.4);
    if (lac_tangential_first_slip(&s.def, s.p, (double[]){1.0, 0.0}, f, &s.err) != LAC_OK) {
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
    lac_tangential_stats r = shear(&s, 1.0001 * f->load, 0.0);
    assert_true(r.slip_cells >= 1 && r.slip_cells <= 8);
    assert_int_equal(s.t->state[f->cell], LAC_CELL_SLIP);
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
        cmocka_unit_test(exact_without_coupling),
        cmocka_unit_test(its_error_with_coupling),
        cmocka_unit_test(first_slip_of_a_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
