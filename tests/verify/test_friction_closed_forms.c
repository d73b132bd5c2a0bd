// SPDX-License-Identifier: GPL-3.0-or-later
// Friction laws against closed forms: docs/theory/friction.md.

#include <math.h>
#include <string.h>

#include "friction/friction.h"
#include "support/slot.h"
#include "support/test.h"

// One cell's parameters, as a reference formula sees them.
typedef struct rock {
    double f0, a, b, dc, v0;
} rock;

static const rock granite = {0.6, 0.010, 0.015, 1e-4, 1e-6};
static const rock gouge = {0.45, 0.012, 0.004, 3e-5, 1e-9};
static const rock schist = {0.7, 0.004, 0.0054, 0.02, 1e-3};
static const rock *const rocks[] = {&granite, &gouge, &schist};
enum { ROCKS = sizeof rocks / sizeof rocks[0] };

static const lac_friction_law *law_named(const char *name)
{
    for (size_t i = 0; lac_friction_law_get(i) != NULL; i++) {
        if (strcmp(lac_friction_law_get(i)->info.name, name) == 0) {
            return lac_friction_law_get(i);
        }
    }
    fail_msg("no law %s", name);
    return NULL;
}

static lac_friction *make(const char *law, int form, const rock *r)
{
    lac_model model;
    lac_friction *friction = NULL;
    assert_int_equal(lac_model_create(&law_named(law)->info, &model, NULL), LAC_OK);
    test_slot_set(&model, "f0", r->f0);
    test_slot_set(&model, "a", r->a);
    test_slot_set(&model, "b", r->b);
    test_slot_set(&model, "dc", r->dc);
    test_slot_set(&model, "v0", r->v0);
    test_slot_set(&model, "form", form);
    assert_int_equal(lac_friction_create(&model, 1, &friction, NULL), LAC_OK);
    lac_model_clear(&model);
    return friction;
}

static long double plain(const rock *r, double u, double w)
{
    long double ln_v0 = logl(r->v0);
    return r->f0 + r->a * (u - ln_v0) + r->b * (ln_v0 + w - logl(r->dc));
}

// The regularised coefficient as it is written in papers; overflows where (f0 + ...)/a > 11000.
static long double regularised(const rock *r, double u, double w)
{
    long double ln_v0 = logl(r->v0);
    long double psi = r->f0 + r->b * (ln_v0 + w - logl(r->dc));
    return r->a * asinhl(expl(u) / (2 * (long double)r->v0) * expl(psi / r->a));
}

// dw/dt of a cell.
static double evolution(const lac_friction *friction, double u, double w)
{
    double f, f_u, f_w, g, v = exp(u);
    lac_friction_evaluate(friction, &(lac_friction_cells){0, 1, &u, &w, &v, 0, NULL},
                          &(lac_friction_values){&f, &f_u, &f_w, &g}, NULL);
    return g;
}

static void assert_near(double value, long double expected, double tolerance)
{
    if (!(fabsl(value - expected) <= tolerance)) {
        fail_msg("%.17g, not %.17Lg (tolerance %g)", value, expected, tolerance);
    }
}

static void coefficient_follows_the_papers(void **state)
{
    (void)state;
    for (size_t i = 0; i < ROCKS; i++) {
        lac_friction *log_law = make("aging", LAC_FORM_PLAIN, rocks[i]);
        lac_friction *finite = make("slip", LAC_FORM_REGULARISED, rocks[i]);
        for (double u = -69; u < 7; u += 1.3) {
            for (double w = -27; w < 46; w += 1.7) {
                assert_near(lac_friction_coefficient(log_law, 0, u, w), plain(rocks[i], u, w),
                            1e-14);
                long double f = regularised(rocks[i], u, w);
                assert_near(lac_friction_coefficient(finite, 0, u, w), f, (double)(1e-12L * f));
            }
        }
        lac_friction_free(log_law);
        lac_friction_free(finite);
    }
}

static void values_of_single_cells_are_used(void **state)
{
    (void)state;
    lac_model model;
    lac_friction *friction;
    assert_int_equal(lac_model_create(&law_named("aging")->info, &model, NULL), LAC_OK);
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.01);
    test_slot_set(&model, "dc", 1);
    assert_int_equal(lac_friction_create(&model, ROCKS, &friction, NULL), LAC_OK);
    static const char *const keys[] = {"f0", "a", "b", "dc", "v0"};
    for (size_t k = 0; k < 5; k++) {
        double values[ROCKS];
        for (size_t i = 0; i < ROCKS; i++) {
            memcpy(&values[i], (const char *)rocks[i] + k * sizeof(double), sizeof(double));
        }
        assert_int_equal(lac_friction_set(friction, keys[k], values, NULL), LAC_OK);
    }
    for (size_t i = 0; i < ROCKS; i++) {
        assert_near(lac_friction_coefficient(friction, i, -20, 10), plain(rocks[i], -20, 10),
                    1e-14);
        assert_near(lac_friction_steady_state(friction, i, -20), logl(rocks[i]->dc) + 20, 1e-14);
    }
    lac_friction_free(friction);
    lac_model_clear(&model);
}

// theta_ss = dc/v,  f_ss = f0 + (a - b) ln(v/v0)
static void steady_sliding(void **state)
{
    (void)state;
    static const char *const laws[] = {"aging", "slip"};
    for (size_t i = 0; i < ROCKS * 2; i++) {
        const rock *r = rocks[i / 2];
        lac_friction *friction = make(laws[i % 2], LAC_FORM_PLAIN, r);
        for (double u = -69; u < 7; u += 0.7) {
            double w = lac_friction_steady_state(friction, 0, u);
            assert_near(w, logl(r->dc) - u, 1e-13);
            assert_near(lac_friction_coefficient(friction, 0, u, w),
                        r->f0 + (r->a - r->b) * (u - logl(r->v0)), 1e-14);
        }
        lac_friction_free(friction);
    }
}

// At rest theta grows by one second a second (aging) or not at all (slip).
static void healing_at_rest(void **state)
{
    (void)state;
    lac_friction *aging = make("aging", LAC_FORM_PLAIN, &granite);
    lac_friction *slip = make("slip", LAC_FORM_PLAIN, &granite);
    for (double w = -20; w < 40; w += 3) {
        assert_near(evolution(aging, -800, w) * exp(w), 1, 1e-14);
        assert_near(evolution(slip, -800, w), 0, 0);
    }
    lac_friction_free(aging);
    lac_friction_free(slip);
}

// v -> 0 at fixed state: f -> v/(2 v0) a exp(psi/a), linear in v; X >> 1: the plain form.
static void regularised_limits(void **state)
{
    (void)state;
    lac_friction *friction = make("aging", LAC_FORM_REGULARISED, &granite);
    double f_slow = lac_friction_coefficient(friction, 0, -90, 0);
    double f_slower = lac_friction_coefficient(friction, 0, -90 - log(1000), 0);
    assert_near(f_slow / f_slower, 1000, 1e-9);
    for (double u = -20; u < 7; u += 1) {
        double w = log(granite.dc) - u;
        assert_near(lac_friction_coefficient(friction, 0, u, w), plain(&granite, u, w), 1e-14);
    }
    lac_friction_free(friction);
}

// One block under constant tau/p: theta = x theta_ss slides at v = v* x^(-m), m = b/a, and
// dv/dt = (m/dc) v^2 (1 - (v/v*)^(-(m-1)/m)); theta = x^(1-m) dc/v.
static void one_block_aging(void **state)
{
    (void)state;
    for (size_t i = 0; i < ROCKS; i++) {
        const rock *r = rocks[i];
        lac_friction *friction = make("aging", LAC_FORM_PLAIN, r);
        double m = r->b / r->a, p = 3e6, ln_steady = log(1e-8);
        double w_steady = log(r->dc) - ln_steady;
        double tau = p * lac_friction_coefficient(friction, 0, ln_steady, w_steady);
        for (double x = 0.001; x < 1000; x *= 1.7) {
            double w = w_steady + log(x);
            double u = lac_friction_rate_for(friction, 0, w, tau, p, 0);
            assert_near(u, ln_steady - m * log(x), 1e-11);
            assert_near(w, (1 - m) * log(x) + log(r->dc) - u, 1e-11);
            double v = exp(u), star = exp(ln_steady);
            double acceleration = -m * v * evolution(friction, u, w);
            double scale = m / r->dc * v * v, ratio = pow(v / star, -(m - 1) / m);
            assert_near(acceleration, scale * (1 - ratio), 1e-10 * scale * (1 + ratio));
        }
        lac_friction_free(friction);
    }
}

// phi = ln(v theta/dc) obeys dphi/d(slip) = (m - 1) phi/dc under constant tau/p.
static void one_block_slip(void **state)
{
    (void)state;
    for (size_t i = 0; i < ROCKS; i++) {
        const rock *r = rocks[i];
        lac_friction *friction = make("slip", LAC_FORM_PLAIN, r);
        double m = r->b / r->a;
        for (double phi = -20; phi < 20; phi += 0.9) {
            double u = -15, w = phi + log(r->dc) - u, g = evolution(friction, u, w);
            double per_slip = (g - m * g) / exp(u);
            assert_near(per_slip, (m - 1) * phi / r->dc, 1e-12 / r->dc);
        }
        lac_friction_free(friction);
    }
}

// A step of tau/p takes x to x exp(-step/(b - a)): the state stays and the rate jumps.
static void load_step_shifts_x(void **state)
{
    (void)state;
    lac_friction *friction = make("aging", LAC_FORM_PLAIN, &granite);
    double m = granite.b / granite.a, u = -18, x = 1.4, p = 5e6, step = 0.0023;
    double w = (1 - m) * log(x) + log(granite.dc) - u;
    double tau = p * lac_friction_coefficient(friction, 0, u, w) + p * step;
    double stepped = lac_friction_rate_for(friction, 0, w, tau, p, 0);
    double ln_x = (stepped + w - log(granite.dc)) / (1 - m);
    assert_near(ln_x, log(x) - step / (granite.b - granite.a), 1e-11);
    lac_friction_free(friction);
}

// Root of p f + eta e^u = tau by bisection in long double, from the papers' formulas.
static long double bisected(const rock *r, int form, double w, double tau, double p, double eta)
{
    long double low = -2000, high = 300;
    for (int i = 0; i < 120; i++) {
        long double u = (low + high) / 2, ln_v0 = logl(r->v0);
        long double psi = r->f0 + r->b * (ln_v0 + w - logl(r->dc));
        long double log_x = u - ln_v0 - logl(2) + psi / r->a;
        long double f = form == LAC_FORM_PLAIN ? psi + r->a * (u - ln_v0)
                        : log_x > 50           ? r->a * (log_x + logl(2))
                                               : r->a * asinhl(expl(log_x));
        *(p * f + eta * expl(u) > tau ? &high : &low) = u;
    }
    return low;
}

static void rate_agrees_with_bisection(void **state)
{
    (void)state;
    static const double damping[] = {1e-3, 4.5e6, 1e13};
    static const double loads[] = {1e-9, 0.01, 0.3, 0.6, 0.7, 1, 30};
    for (size_t i = 0; i < ROCKS; i++) {
        for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
            lac_friction *friction = make("aging", form, rocks[i]);
            for (size_t j = 0; j < 3 * 7 * 9; j++) {
                double eta = damping[j % 3], p = 2e6, tau = p * loads[j / 3 % 7];
                double w = -25 + 8.0 * (double)(j / 21);
                double u = lac_friction_rate_for(friction, 0, w, tau, p, eta);
                assert_near(u, bisected(rocks[i], form, w, tau, p, eta), 1e-11 + 1e-14 * fabs(u));
            }
            lac_friction_free(friction);
        }
    }
}

// Without direct effect only damping tells the rate; without either nothing does.
static void rate_where_there_is_no_direct_effect(void **state)
{
    (void)state;
    rock r = granite;
    r.a = 0;
    for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
        lac_friction *friction = make("aging", form, &r);
        double w = log(r.dc / r.v0), p = 1e6;
        assert_near(lac_friction_coefficient(friction, 0, -30, w), r.f0, 1e-14);
        assert_near(lac_friction_rate_for(friction, 0, w, 0.61 * p, p, 1e7), logl(1e-3), 1e-9);
        assert_true(isnan(lac_friction_rate_for(friction, 0, w, 0.61 * p, p, 0)));
        assert_true(isnan(lac_friction_rate_for(friction, 0, w, 0.59 * p, p, 1e7)));
        assert_near(lac_friction_state_for(friction, 0, -30, 0.62), w + (0.62L - r.f0) / r.b,
                    1e-11);
        lac_friction_free(friction);
    }
    r = granite;
    r.b = 0;
    lac_friction *friction = make("aging", LAC_FORM_PLAIN, &r);
    assert_true(isnan(lac_friction_state_for(friction, 0, -30, 0.6)));
    lac_friction_free(friction);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coefficient_follows_the_papers),
        cmocka_unit_test(values_of_single_cells_are_used),
        cmocka_unit_test(steady_sliding),
        cmocka_unit_test(healing_at_rest),
        cmocka_unit_test(regularised_limits),
        cmocka_unit_test(one_block_aging),
        cmocka_unit_test(one_block_slip),
        cmocka_unit_test(load_step_shifts_x),
        cmocka_unit_test(rate_agrees_with_bisection),
        cmocka_unit_test(rate_where_there_is_no_direct_effect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
