// SPDX-License-Identifier: GPL-3.0-or-later
// A block with mass on one cell: closed forms (free slide, oscillation, runaway), linear stability,
// and the limit without mass.
#include <stdio.h>
#include <string.h>

#include <gsl/gsl_integration.h>
#include <gsl/gsl_poly.h>
#include <math.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/slot.h"
#include "support/test.h"

static const double second = 0.1; // when the load comes [s]

static lac_model shear_step(double stress)
{
    lac_model model = test_slot_shear("step");
    test_slot_set(&model, "value", stress);
    test_slot_set(&model, "at", second);
    return model;
}

static lac_model spring(double stiffness, double speed)
{
    lac_model model = test_slot_shear("spring");
    test_slot_set(&model, "stiffness", stiffness);
    test_slot_set(&model, "speed", speed);
    return model;
}

// A block of 5e5 kg/m2 that slides at 1 um/s under friction without evolution.
static block_def slide(double a, lac_model *loads, size_t count)
{
    block_def def = block_default(1.0, 1.0);
    def.a = a;
    def.b = 0.0;
    def.theta = 1.0;
    def.pressure = 5e6;
    def.slip_rate = 1e-6;
    def.v0 = 1e-6;
    def.mass = 5e5;
    def.shear = loads;
    def.shear_count = count;
    return def;
}

static lac_run_def until(lac_method method, double end, double rtol)
{
    lac_run_def how = lac_run_default();
    how.method = method;
    how.end = end;
    how.rtol = rtol;
    how.failure_rate = 1e4;
    return how;
}

typedef struct outcome {
    lac_status status;
    lac_error err;
    lac_run_result result;
    lac_record last;
} outcome;

static outcome run_block(const block_def *def, const lac_run_def *how)
{
    block b;
    outcome out = {.err = {""}};
    history h = {0};
    block_create(def, &b);
    lac_sink sink = history_sink(&h);
    out.status = lac_run(b.problem, how, &sink, &out.result, &out.err);
    out.last = h.line[h.n - 1];
    history_clear(&h);
    block_clear(&b);
    return out;
}

// Constant friction: v = v0 + (q - p f)/m t, whatever the method.
static void free_slide(void **state)
{
    (void)state;
    for (int method = LAC_BDF; method <= LAC_ERK; method++) {
        for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
            lac_model load = shear_step(2e6);
            block_def def = slide(form == LAC_FORM_PLAIN ? 0.0 : 1e-12, &load, 1);
            def.form = form;
            lac_run_def how = until((lac_method)method, 2.1, 1e-10);
            outcome out = run_block(&def, &how);
            assert_int_equal(out.status, LAC_OK);
            double v = 1e-6 + 2e6 / 5e5 * 2.0;
            double slip = 1e-6 * 2.1 + 0.5 * 2e6 / 5e5 * 4.0;
            printf("free slide, method %d: v %.2g, slip %.2g off\n", method,
                   out.last.observation.mean_rate / v - 1.0, out.result.mean_slip / slip - 1.0);
            assert_true(fabs(out.last.observation.mean_rate / v - 1.0) < 1e-8);
            assert_true(fabs(out.result.mean_slip / slip - 1.0) < 1e-8);
            assert_true(out.result.balance_residual < 1e-14);
            lac_model_clear(&load);
        }
    }
}

// Constant friction against a spring: v = V sin(w t + phase) until it stops, having slipped twice
// as far as where the forces balance.
static void oscillation(void **state)
{
    (void)state;
    const double k = 1e7;
    const double m = 5e5;
    const double drop = 1e5;
    const double v0 = 1e-6;
    double w = sqrt(k / m);
    // From the step on slip - drop/k swings with this amplitude.
    double slip1 = v0 / w * sin(w * second);
    double v1 = v0 * cos(w * second);
    double amplitude = hypot(slip1 - drop / k, v1 / w);
    for (int method = LAC_BDF; method <= LAC_ERK; method++) {
        lac_model loads[] = {spring(k, 0.0), shear_step(drop)};
        block_def def = slide(0.0, loads, 2);
        lac_run_def how = until((lac_method)method, second + 0.6, 1e-10);
        outcome out = run_block(&def, &how);
        assert_int_equal(out.status, LAC_OK);
        double v = v1 * cos(w * 0.6) - w * (slip1 - drop / k) * sin(w * 0.6);
        assert_true(fabs(out.last.observation.mean_rate / v - 1.0) < 1e-7);
        how.end = 2.0;
        how.max_steps = 100000;
        out = run_block(&def, &how);
        // Constant friction has no rate to rest at.
        assert_int_equal(out.status, LAC_ENUMERIC);
        assert_non_null(strstr(out.err.message, "cell 0 comes to rest at t = "));
        double slip = drop / k + amplitude;
        double half = second + (M_PI - atan2(v1 / w, drop / k - slip1)) / w;
        printf("oscillation, method %d: slip %.2g, half a period %.2g off\n", method,
               out.result.mean_slip / slip - 1.0, out.result.time / half - 1.0);
        assert_true(fabs(out.result.mean_slip / slip - 1.0) < 1e-8);
        assert_true(fabs(out.result.time / half - 1.0) < 1e-8);
        lac_model_clear(&loads[0]);
        lac_model_clear(&loads[1]);
    }
}

// Constant friction p f that turns with the slip: each way back goes round a middle 2 p f/k further
// on than each way out. After two and a half half-periods the slip passes the middle of the third.
static void swings_back_and_forth(void **state)
{
    (void)state;
    const double k = 1e7;
    const double drop = 4e6;
    const double held = 5e6 * 0.06;
    double w = sqrt(k / 5e5);
    for (int method = LAC_BDF; method <= LAC_ERK; method++) {
        lac_model loads[] = {spring(k, 0.0), shear_step(drop)};
        block_def def = slide(1e-12, loads, 2);
        def.form = LAC_FORM_REGULARISED;
        def.f0 = 0.06;
        lac_run_def how = until((lac_method)method, second + 2.5 * M_PI / w, 1e-9);
        outcome out = run_block(&def, &how);
        if (out.status != LAC_OK) {
            fail_msg("method %d: %s", method, out.err.message);
        }
        double v = w * (drop - 4.0 * held) / k;
        printf("swings, method %d: v %.2g, slip %.2g off, %lld steps\n", method,
               out.last.observation.mean_rate / v - 1.0, out.result.mean_slip * k / drop - 1.0,
               (long long)out.result.steps);
        // The slow slide before the load comes is left out of account: 1e-6 of the swing.
        assert_true(fabs(out.last.observation.mean_rate / v - 1.0) < 1e-6);
        assert_true(fabs(out.result.mean_slip * k / drop - 1.0) < 1e-6);
        lac_model_clear(&loads[0]);
        lac_model_clear(&loads[1]);
    }
}

typedef struct runaway_law {
    double excess, ap, v0, m;
} runaway_law;

static double slowness(double u, void *params)
{
    const runaway_law *l = params;
    return l->m * exp(u) / (l->excess - l->ap * (u - log(l->v0)));
}

// Logarithmic friction and mass through 1 m/s: t = integral of m dv/(q - p f(v)).
static void runaway(void **state)
{
    (void)state;
    runaway_law law = {2e6, 0.01 * 5e6, 1e-6, 5e5};
    gsl_integration_workspace *w = gsl_integration_workspace_alloc(1000);
    gsl_function g = {slowness, &law};
    const double ends[] = {1.0, 5.0};
    for (size_t i = 0; i < 2; i++) {
        double t;
        double error;
        lac_model load = shear_step(2e6);
        block_def def = slide(0.01, &load, 1);
        lac_run_def how = until(LAC_BDF, 1e3, 1e-11);
        how.failure_rate = ends[i];
        outcome out = run_block(&def, &how);
        assert_true(out.result.failed);
        gsl_integration_qag(&g, log(1e-6), log(ends[i]), 0.0, 1e-13, 1000, GSL_INTEG_GAUSS61, w, &t,
                            &error);
        printf("runaway to %g m/s: %.2g off\n", ends[i], (out.result.time - second) / t - 1.0);
        assert_true(fabs((out.result.time - second) / t - 1.0) < 1e-8);
        lac_model_clear(&load);
    }
    gsl_integration_workspace_free(w);
}

// The two complex roots of a slider's characteristic equation about steady sliding at V, c = V/dc:
// m V l^3 + (m V c + s a) l^2 + (k V + s (a - b) c) l + k V c = 0 (Rice & Ruina 1983).
static gsl_complex slider_root(const block_def *def, double k)
{
    gsl_complex z[3];
    double v = def->slip_rate;
    double c = v / def->dc;
    double s = def->pressure;
    double lead = def->mass * v;
    gsl_poly_complex_solve_cubic((lead * c + s * def->a) / lead,
                                 (k * v + s * (def->a - def->b) * c) / lead, k * v * c / lead,
                                 &z[0], &z[1], &z[2]);
    return GSL_IMAG(z[2]) > 0.0 ? z[2] : z[1];
}

// Growth of ln v from the third of its maxima to the last, each by the parabola through records.
static double measure_growth(const history *h)
{
    double time[2] = {0};
    double height[2] = {0};
    size_t found = 0;
    for (size_t k = 1; k + 1 < h->n; k++) {
        double y0 = log(h->line[k - 1].observation.mean_rate);
        double y1 = log(h->line[k].observation.mean_rate);
        double y2 = log(h->line[k + 1].observation.mean_rate);
        if (!(y1 > y0 && y1 >= y2)) {
            continue;
        }
        double shift = 0.5 * (y0 - y2) / (y0 - 2.0 * y1 + y2);
        size_t which = found < 3 ? 0 : 1;
        time[which] = history_time(h, k) + shift * (history_time(h, k) - history_time(h, k - 1));
        height[which] = y1 - 0.25 * (y0 - y2) * shift;
        found++;
    }
    assert_true(found > 5);
    return log(height[1] / height[0]) / (time[1] - time[0]);
}

// Growth of a perturbation at 0.99 and 1.01 of the critical stiffness, which mass raises.
static void linear_stability(void **state)
{
    (void)state;
    const double ratios[] = {0.99, 1.01};
    for (size_t i = 0; i < 2; i++) {
        block_def def = block_default(1.5, 1.0);
        def.mass = 5e3; // m V^2/(s a dc) = 0.5
        def.slip_rate = 1.0;
        double critical = def.pressure * (def.b - def.a) / def.dc *
                          (1.0 + def.mass / (def.pressure * def.a * def.dc));
        lac_model load = spring(ratios[i] * critical, 1.0);
        gsl_complex root = slider_root(&def, ratios[i] * critical);
        assert_true((GSL_REAL(root) > 0.0) == (ratios[i] < 1.0));
        def.slip_rate = 1.0 + 1e-6;
        def.shear = &load;
        def.shear_count = 1;
        lac_run_def how = until(LAC_BDF, 60.0, 1e-13);
        how.record = (lac_cadence){.time = 0.01, .per_decade = NAN};
        block b;
        lac_error err = {""};
        lac_run_result result;
        history h = {0};
        block_create(&def, &b);
        lac_sink sink = history_sink(&h);
        assert_int_equal(lac_run(b.problem, &how, &sink, &result, &err), LAC_OK);
        double growth = measure_growth(&h);
        printf("k/k_c %g: growth %.8f, theory %.8f\n", ratios[i], growth, GSL_REAL(root));
        assert_true(fabs(growth / GSL_REAL(root) - 1.0) < 1e-3);
        history_clear(&h);
        block_clear(&b);
        lac_model_clear(&load);
    }
}

// When a block that creeps to failure at v0 fails.
static double failure_of(double mass, double damping)
{
    block_def def = block_default(1.5, 0.9);
    block b;
    lac_error err = {""};
    lac_run_result result;
    def.mass = mass;
    def.damping = damping;
    lac_run_def how = until(LAC_BDF, 1e6, 1e-12);
    how.failure_rate = 1e3;
    block_create(&def, &b);
    assert_int_equal(lac_run(b.problem, &how, NULL, &result, &err), LAC_OK);
    assert_true(result.failed);
    block_clear(&b);
    return result.failure_origin + result.failure_local;
}

// Little mass: the block fails as without, the later by as much as the mass grows. A slab gives its
// waves back: nothing is damped.
static void the_limit_without_mass(void **state)
{
    (void)state;
    const double masses[] = {1e-30, 1e-6, 1e-4};
    double late[3];
    double without = failure_of(0.0, 0.0);
    for (size_t i = 0; i < 3; i++) {
        late[i] = failure_of(masses[i], 0.0) / without - 1.0;
        printf("mass %g kg/m2: failure %.3g late\n", masses[i], late[i]);
        assert_true(failure_of(masses[i], 1e7) == failure_of(masses[i], 0.0));
    }
    assert_true(fabs(late[0]) < 1e-9);
    assert_true(fabs((late[2] - late[0]) / (100.0 * (late[1] - late[0])) - 1.0) < 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_slide),
        cmocka_unit_test(oscillation),
        cmocka_unit_test(swings_back_and_forth),
        cmocka_unit_test(runaway),
        cmocka_unit_test(linear_stability),
        cmocka_unit_test(the_limit_without_mass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
