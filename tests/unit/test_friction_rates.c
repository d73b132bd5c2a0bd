// SPDX-License-Identifier: GPL-3.0-or-later
// Slip rates from tractions: put back into the balance over thirty decades of rate and twelve of
// pressure, for every law and form; and what no rate can carry.
#include <string.h>

#include <math.h>

#include "base/rng.h"
#include "friction/friction.h"
#include "support/settle_copies.h"
#include "support/slot.h"
#include "support/test.h"

enum { CELLS = 256 };

static double uniform(uint64_t i, uint64_t what, double low, double high)
{
    return low + (high - low) * lac_random_uniform(11, LAC_STREAM_TEST, i, what);
}

static lac_friction *make(const lac_friction_law *law, int form, double a)
{
    lac_error err;
    lac_model model = {0};
    lac_friction *friction;
    assert_int_equal(lac_model_create(&law->info, &model, &err), LAC_OK);
    lac_friction_params *p = model.params;
    p->f0 = 0.6;
    p->a = a;
    p->b = 0.015;
    p->dc = 1e-4;
    p->v0 = 1e-6;
    p->form = form;
    test_slot_fill(&model);
    assert_int_equal(lac_friction_create(&model, CELLS, &friction, &err), LAC_OK);
    lac_model_clear(&model);
    return friction;
}

// Cells with known rates and the tractions that these need.
typedef struct known {
    double u[CELLS], sign[CELLS], w[CELLS], traction[CELLS], pressure[CELLS];
} known;

static void fill(const lac_friction *friction, uint64_t seed, double eta, known *k)
{
    for (uint64_t i = 0; i < CELLS; i++) {
        uint64_t c = seed * CELLS + i;
        k->u[i] = log(10.0) * uniform(c, 0, -27.0, 3.0);
        k->w[i] = log(10.0) * uniform(c, 1, -12.0, 20.0);
        k->pressure[i] = pow(10.0, uniform(c, 2, -2.0, 10.0));
        k->sign[i] = uniform(c, 3, -1.0, 1.0) < 0.0 ? -1.0 : 1.0;
        double f = lac_friction_coefficient(friction, i, k->u[i], k->w[i]);
        k->traction[i] = k->sign[i] * (k->pressure[i] * f + eta * exp(k->u[i]));
    }
}

static lac_friction_balance balance_of(const known *k, double eta)
{
    return (lac_friction_balance){.n = CELLS,
                                  .w = k->w,
                                  .traction = k->traction,
                                  .pressure = k->pressure,
                                  .share = 1.0,
                                  .damping = eta};
}

// The rate is found as well as rounding of the traction allows, whatever the start.
static void check_block(const lac_friction *friction, uint64_t seed, double eta)
{
    static const double starts[] = {0.0, NAN, 1e9, -590.0, 39.0, -20.0};
    known k;
    fill(friction, seed, eta, &k);
    lac_friction_balance eq = balance_of(&k, eta);
    double u[CELLS];
    double v[CELLS];
    for (size_t s = 0; s < 7; s++) {
        for (size_t i = 0; i < CELLS; i++) {
            u[i] = s < 6 ? starts[s] : k.u[i] + 0.5;
        }
        lac_friction_rates(friction, &eq, u, v);
        for (size_t i = 0; i < CELLS; i++) {
            double f;
            double f_u;
            double f_w;
            double g;
            double speed = exp(u[i]);
            lac_friction_cells cell = {i, 1, &u[i], &k.w[i], &speed, 0.0, NULL};
            lac_friction_evaluate(friction, &cell, &(lac_friction_values){&f, &f_u, &f_w, &g},
                                  NULL);
            double p = k.pressure[i];
            double slope = p * f_u + eta * speed;
            double slack = 1e-14 * (p * fabs(f) + fabs(k.traction[i]) + eta * speed) / slope;
            if (k.traction[i] * k.sign[i] <= 0.0) {
                continue; // plain friction below zero: the sign of slip is not that of its traction
            }
            if (!(fabs(u[i] - k.u[i]) <= slack + 1e-12 * (1.0 + fabs(k.u[i])))) {
                fail_msg("%s, start %g: ln v %.17g, expected %.17g within %g",
                         friction->law->info.name, s < 6 ? starts[s] : 0.5, u[i], k.u[i], slack);
            }
            assert_true(v[i] * k.sign[i] > 0.0);
        }
    }
}

static void rates_carry_their_tractions(void **state)
{
    (void)state;
    const double etas[] = {0.0, 1.0, 5e6};
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_get(l)) != NULL; l++) {
        for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
            for (uint64_t e = 0; e < 3; e++) {
                lac_friction *friction = make(law, form, e == 1 ? 0.05 : 0.008);
                for (uint64_t seed = 0; seed < test_some(4); seed++) {
                    check_block(friction, 4 * e + seed, etas[e]);
                }
                lac_friction_free(friction);
            }
        }
    }
}

// One cell gives the same bits alone as in its block.
static void a_cell_does_not_depend_on_its_block(void **state)
{
    (void)state;
    lac_friction *friction = make(lac_friction_law_get(0), LAC_FORM_REGULARISED, 0.01);
    known k;
    fill(friction, 1, 5e6, &k);
    lac_friction_balance eq = balance_of(&k, 5e6);
    double u[CELLS] = {0};
    double v[CELLS];
    lac_friction_rates(friction, &eq, u, v);
    for (size_t i = 0; i < CELLS; i++) {
        double alone = 0.0;
        double rate;
        lac_friction_balance one = eq;
        one.first = i;
        one.n = 1;
        one.w += i;
        one.traction += i;
        one.pressure += i;
        lac_friction_rates(friction, &one, &alone, &rate);
        assert_memory_equal(&alone, &u[i], sizeof alone);
        assert_memory_equal(&rate, &v[i], sizeof rate);
    }
    lac_friction_free(friction);
}

// Every instruction set gives the same bits, in either form and over all rates.
static void instruction_sets_agree(void **state)
{
    (void)state;
    test_settle *copies[3];
    size_t count = test_settle_copies(copies);
    for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
        lac_friction *friction = make(lac_friction_law_get(0), form, 0.01);
        known k;
        fill(friction, 7, 5e6, &k);
        lac_friction_balance eq = balance_of(&k, 5e6);
        double u[3][CELLS];
        double v[3][CELLS];
        for (size_t c = 0; c < count; c++) {
            for (size_t i = 0; i < CELLS; i++) {
                u[c][i] = k.u[i] + 0.3;
            }
            copies[c](friction, &eq, u[c], v[c]);
            assert_memory_equal(u[c], u[0], sizeof u[0]);
            assert_memory_equal(v[c], v[0], sizeof v[0]);
        }
        lac_friction_free(friction);
    }
}

// No traction, none that is a number, too much of it, no direct effect: a bound or NaN, at once.
static void nothing_fails(void **state)
{
    (void)state;
    const double tractions[] = {0.0, -0.0, 1e-300, INFINITY, -INFINITY, 1e300, NAN, 5e5};
    const double as[] = {0.0, 0.01};
    const double etas[] = {0.0, 5e6};
    for (size_t c = 0; c < 8; c++) {
        lac_friction *friction = make(lac_friction_law_get(0), (int)(c & 1), as[c >> 1 & 1]);
        double eta = etas[c >> 2];
        for (size_t i = 0; i < sizeof tractions / sizeof tractions[0]; i++) {
            double w = 10.0;
            double p = 1e6;
            double u = 0.0;
            double v;
            lac_friction_balance eq = {.n = 1,
                                       .w = &w,
                                       .traction = &tractions[i],
                                       .pressure = &p,
                                       .share = 1.0,
                                       .damping = eta};
            lac_friction_rates(friction, &eq, &u, &v);
            if (!isnan(tractions[i])) {
                assert_true(u >= LAC_SLOWEST && u <= LAC_FASTEST);
                assert_true(signbit(v) == signbit(tractions[i]) && v != 0.0);
            }
            // and from there, as a run would go on
            double traction = 6e5;
            eq.traction = &traction;
            lac_friction_rates(friction, &eq, &u, &v);
            assert_true(isfinite(u) && isfinite(v));
        }
        lac_friction_free(friction);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_carry_their_tractions),
        cmocka_unit_test(a_cell_does_not_depend_on_its_block),
        cmocka_unit_test(instruction_sets_agree),
        cmocka_unit_test(nothing_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
