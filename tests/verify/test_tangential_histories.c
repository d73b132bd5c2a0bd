// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "contact/tangential.h"
#include "contact/tangential_space.h"
#include "support/sheared.h"
#include "support/test.h"

static const double pi = 3.14159265358979323846;
static const double strength = 0.5 * 4.9e-3; // f p of the rough joints here

// Tractions as they are, both axes; the caller frees them
static double *copy_tractions(const sheared *s)
{
    const size_t cells = s->n * s->n;
    double *tau = malloc(2 * cells * sizeof *tau);
    assert_non_null(tau);
    memcpy(tau, s->t->traction[0], cells * sizeof *tau);
    memcpy(tau + cells, s->t->traction[1], cells * sizeof *tau);
    return tau;
}

// rms of the tractions less factor * b, over the rms of those
static double difference(const sheared *s, const double *a, const double *b, double factor)
{
    double sum = 0.0;
    double size = 0.0;
    for (size_t k = 0; k < 2 * s->n * s->n; k++) {
        sum += (a[k] - factor * b[k]) * (a[k] - factor * b[k]);
        size += a[k] * a[k];
    }
    return sqrt(sum / size);
}

// Pressed harder under a load that stays: nothing slips, new cells carry nothing (Mindlin &
// Deresiewicz 1953, case dQ = 0, dP > 0), whatever nu.
static void pressed_harder(void **state)
{
    (void)state;
    sheared s = rough_of(128, true, 0.3, 0.5);
    lac_tangential_stats before = shear(&s, 0.5 * strength, 0.2 * strength);
    double *tau = copy_tractions(&s);
    press(&s, 2.0 * 4.9e-3);
    lac_tangential_stats after = shear(&s, 0.5 * strength, 0.2 * strength);
    double off = difference(&s, s.t->traction[0], tau, 1.0);
    print_message("P doubled: tractions %.1e, shift %.1e, %zu slip\n", off,
                  after.shift[0] / before.shift[0] - 1.0, after.slip_cells);
    assert_int_equal(after.slip_cells, 0);
    assert_true(after.contact_cells > before.contact_cells);
    assert_true(after.dissipation == 0.0);
    assert_true(off < 1e-7);
    assert_true(fabs(after.shift[0] / before.shift[0] - 1.0) < 1e-7);
    free(tau);
    release(&s);
}

// Pressed less under a load that stays: what slips is what would have under the lower pressure from
// the start (the same, case dP < 0), with nu = 0.
static void pressed_less(void **state)
{
    (void)state;
    sheared s = rough_of(128, true, 0.0, 0.5);
    (void)shear(&s, 0.4 * strength, 0.0);
    press(&s, 0.7 * 4.9e-3);
    lac_tangential_stats after = shear(&s, 0.4 * strength, 0.0);
    double *tau = copy_tractions(&s);
    start_again(&s);
    lac_tangential_stats virgin = shear(&s, 0.4 * strength, 0.0);
    double off = difference(&s, s.t->traction[0], tau, 1.0);
    print_message("P down: tractions %.1e, shift %.1e\n", off,
                  after.shift[0] / virgin.shift[0] - 1.0);
    assert_true(off < 1e-7);
    assert_true(fabs(after.shift[0] / virgin.shift[0] - 1.0) < 1e-8);
    assert_int_equal(after.stick_cells, virgin.stick_cells);
    free(tau);
    release(&s);
}

// P and Q grow together, dQ/dP < f: nothing slips, q = (Q/P) p (the same, case dQ/dP < f), nu = 0.
// A step has its new cells in contact from its beginning: first order.
static double grown_together(sheared *s, int steps, double part)
{
    start_again(s);
    lac_tangential_stats r = {0};
    for (int k = 1; k <= steps; k++) {
        double load = 4.9e-3 * (double)k / steps;
        press(s, load);
        r = shear(s, part * 0.5 * load, 0.0);
    }
    double *q = calloc(2 * s->n * s->n, sizeof *q);
    assert_non_null(q);
    for (size_t i = 0; i < s->n * s->n; i++) {
        q[i] = part * 0.5 * s->p[i];
    }
    double off = difference(s, s->t->traction[0], q, 1.0);
    print_message("Q = %.1f f P in %2d steps: tractions %.2e, %zu of %zu slip at the end\n", part,
                  steps, off, r.slip_cells, r.contact_cells);
    free(q);
    return off;
}

static void loads_that_grow_together(void **state)
{
    (void)state;
    sheared s = rough_of(64, true, 0.0, 0.5);
    double off[4];
    for (int k = 0; k < 4; k++) {
        off[k] = grown_together(&s, 8 << k, 0.5);
    }
    assert_true(off[3] < 0.06);
    for (int k = 0; k < 3; k++) {
        assert_true(off[k + 1] < 0.75 * off[k]);
    }
    release(&s);
}

// Elastic energy tau.C tau/2 over the nominal area [J], by the operator alone
static double elastic_energy(const sheared *s)
{
    const size_t cells = s->n * s->n;
    lac_shear_space *space = NULL;
    assert_int_equal(lac_shear_space_create(&s->def.grid, s->def.poisson, &space, NULL), LAC_OK);
    for (int axis = 0; axis < 2; axis++) {
        lac_fft *fft = space->fft[axis];
        memset(fft->real, 0, fft->nx * fft->ny * sizeof *fft->real);
        for (size_t i = 0; i < cells; i++) {
            fft->real[i / s->n * fft->nx + i % s->n] = s->t->traction[axis][i];
        }
    }
    double softness = 1.0 / (pi * (1.0 - s->def.poisson) * s->def.e_star);
    double sum = lac_shear_space_energy(space);
    lac_shear_space_free(space);
    return 0.5 * sum * softness * lac_grid_cell_area(&s->def.grid);
}

// Work of the load = what friction eats + what is stored. Loads of a step are taken at its end, so
// that the two differ by half the last increments; many steps close the gap.
static double energy_gap(sheared *s, int steps)
{
    const double path[][2] = {{0.7, 0.0}, {0.2, 0.5}, {-0.5, 0.1}, {0.0, 0.0}};
    double work = 0.0;
    double eaten = 0.0;
    double q[2] = {0.0, 0.0};
    double shift[2] = {0.0, 0.0};
    start_again(s);
    for (int leg = 0; leg < 4; leg++) {
        const double from[2] = {q[0], q[1]};
        for (int k = 1; k <= steps; k++) {
            double next[2];
            for (int axis = 0; axis < 2; axis++) {
                double to = path[leg][axis] * strength;
                next[axis] = from[axis] + (to - from[axis]) * (double)k / steps;
            }
            lac_tangential_stats r = shear(s, next[0], next[1]);
            for (int axis = 0; axis < 2; axis++) {
                work += 0.5 * (q[axis] + next[axis]) * (r.shift[axis] - shift[axis]);
                shift[axis] = r.shift[axis];
                q[axis] = next[axis];
            }
            assert_true(r.dissipation >= 0.0);
            eaten += r.dissipation;
        }
    }
    double stored = elastic_energy(s);
    print_message("%2d steps a leg: work %.6e, dissipated %.6e, stored %.6e\n", steps, work, eaten,
                  stored);
    return fabs(work - eaten - stored) / work;
}

static void energy_balance(void **state)
{
    (void)state;
    for (int periodic = 0; periodic < 2; periodic++) {
        sheared s = rough_of(64, periodic == 1, 0.25, 0.5);
        double coarse = energy_gap(&s, 4);
        double fine = energy_gap(&s, 16);
        assert_true(coarse < 0.05);
        assert_true(fine < 0.4 * coarse);
        release(&s);
    }
}

// A cycle between -Q and Q of a sphere eats (Johnson 1985, eq. 7.57; nu = 0)
//   4 U(Q) Q - 8 int_0^Q U,  U = U_m (1 - (1 - Q/fP)^(2/3)):
// the area of the loop that Mindlin's shift makes. Two steps have it all.
static void a_cycle_of_mindlin(void **state)
{
    (void)state;
    const double a = 0.2;
    const double f = 0.4;
    for (size_t n = 64; n <= 128; n *= 2) {
        sheared s = sphere_of(n, a, 0.0, f);
        double most = f * 4.0 / 3.0 * a * a * a;
        double part = 0.7;
        double um = 2.0 * 3.0 * most * 2.0 / (16.0 * a);
        double u = um * (1.0 - pow(1.0 - part, 2.0 / 3.0));
        double area = um * most * (part - 0.6 * (1.0 - pow(1.0 - part, 5.0 / 3.0)));
        double loop = 4.0 * u * part * most - 8.0 * area;
        (void)shear(&s, part * most, 0.0);
        double eaten = shear(&s, -part * most, 0.0).dissipation;
        eaten += shear(&s, part * most, 0.0).dissipation;
        print_message("Mindlin's cycle at %3zu^2: %.5f of the loop\n", n, eaten / loop);
        assert_true(fabs(eaten / loop - 1.0) < 30.0 / (double)(n * n));
        release(&s);
    }
}

// Dragged far, all slides, and friction eats f P a metre.
static void dragged_far(void **state)
{
    (void)state;
    sheared s = rough_of(64, true, 0.3, 0.5);
    (void)drag(&s, 0.3, 0.4);
    lac_tangential_stats r = drag(&s, 0.6, 0.8);
    assert_int_equal(r.slip_cells, r.contact_cells);
    assert_true(fabs(r.dissipation / (0.5 * strength) - 1.0) < 1e-6);
    r = drag(&s, 0.0, 0.0);
    assert_true(fabs(r.traction[0] / (-0.6 * strength) - 1.0) < 1e-2);
    assert_true(fabs(r.dissipation / strength - 1.0) < 1e-2);
    release(&s);
}

// The joint turned by 90 degrees, x -> y -> -x
static void turn(const sheared *s, sheared *turned)
{
    const size_t n = s->n;
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < n; i++) {
            turned->p[i * n + (n - 1 - j)] = s->p[j * n + i];
        }
    }
}

// rms difference of the tractions of the turned joint from those turned
static double turned_difference(const sheared *s, const sheared *turned)
{
    const size_t n = s->n;
    double sum = 0.0;
    double size = 0.0;
    for (size_t j = 0; j < n; j++) {
        for (size_t i = 0; i < n; i++) {
            size_t at = j * n + i;
            size_t to = i * n + (n - 1 - j);
            double dx = turned->t->traction[0][to] + s->t->traction[1][at];
            double dy = turned->t->traction[1][to] - s->t->traction[0][at];
            sum += dx * dx + dy * dy;
            size += pow(s->t->traction[0][at], 2) + pow(s->t->traction[1][at], 2);
        }
    }
    return sqrt(sum / size);
}

static void turned_joint(void **state)
{
    (void)state;
    const double path[][2] = {{0.5, 0.1}, {0.1, 0.6}, {-0.4, 0.2}};
    for (int periodic = 0; periodic < 2; periodic++) {
        sheared s = rough_of(64, periodic == 1, 0.4, 0.5);
        sheared t = rough_of(64, periodic == 1, 0.4, 0.5);
        turn(&s, &t);
        for (int k = 0; k < 3; k++) {
            double qx = path[k][0] * strength;
            double qy = path[k][1] * strength;
            lac_tangential_stats a = shear(&s, qx, qy);
            lac_tangential_stats b = shear(&t, -qy, qx);
            assert_int_equal(a.stick_cells, b.stick_cells);
            assert_true(fabs(a.shift[0] - b.shift[1]) < 1e-7 * fabs(a.shift[0]));
            assert_true(turned_difference(&s, &t) < 1e-7);
        }
        release(&s);
        release(&t);
    }
}

// With nu = 0 no direction is special: the same tractions along any.
static void any_direction(void **state)
{
    (void)state;
    sheared s = rough_of(64, false, 0.0, 0.5);
    lac_tangential_stats straight = shear(&s, 0.6 * strength, 0.0);
    double *tau = copy_tractions(&s);
    start_again(&s);
    lac_tangential_stats oblique = shear(&s, 0.6 * strength * 0.6, -0.6 * strength * 0.8);
    double most = 0.0;
    for (size_t i = 0; i < s.n * s.n; i++) {
        most = fmax(most, fabs(s.t->traction[0][i] - 0.6 * tau[i]));
        most = fmax(most, fabs(s.t->traction[1][i] + 0.8 * tau[i]));
    }
    assert_true(most < 1e-7 * s.contact.max_pressure);
    assert_int_equal(oblique.stick_cells, straight.stick_cells);
    assert_true(fabs(hypot(oblique.shift[0], oblique.shift[1]) / straight.shift[0] - 1.0) < 1e-8);
    free(tau);
    release(&s);
}

// A load that turns around a sphere: every turn eats the same in the end, a quarter of it each
// quarter, and the shift follows the load around.
static void turning_load(void **state)
{
    (void)state;
    enum { STEPS = 8 };
    sheared s = sphere_of(32, 0.2, 0.25, 0.4);
    double q = 0.6 * 0.4 * s.contact.mean_pressure;
    double eaten[4] = {0.0};
    double shift[4][2];
    for (int k = 0; k <= 4 * STEPS; k++) {
        double angle = 2.0 * pi * k / STEPS;
        lac_tangential_stats r = shear(&s, q * cos(angle), q * sin(angle));
        int quarter = (k - 1) / (STEPS / 4) - 12;
        if (quarter >= 0) {
            eaten[quarter] += r.dissipation;
            shift[quarter][0] = r.shift[0];
            shift[quarter][1] = r.shift[1];
        }
    }
    print_message("quarters of a turn eat %.8e %.8e %.8e %.8e\n", eaten[0], eaten[1], eaten[2],
                  eaten[3]);
    double far = hypot(shift[3][0], shift[3][1]);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(eaten[k] / eaten[3] - 1.0) < 1e-3);
        assert_true(fabs(shift[k + 1][0] + shift[k][1]) < 1e-4 * far);
        assert_true(fabs(shift[k + 1][1] - shift[k][0]) < 1e-4 * far);
    }
    release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressed_harder),
        cmocka_unit_test(pressed_less),
        cmocka_unit_test(loads_that_grow_together),
        cmocka_unit_test(energy_balance),
        cmocka_unit_test(a_cycle_of_mindlin),
        cmocka_unit_test(dragged_far),
        cmocka_unit_test(turned_joint),
        cmocka_unit_test(any_direction),
        cmocka_unit_test(turning_load),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
