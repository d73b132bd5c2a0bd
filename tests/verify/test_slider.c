// SPDX-License-Identifier: GPL-3.0-or-later
// A spring slider near steady sliding against linear stability (Ruina 1983), and single blocks
// across twenty-six decades of slip rate.
#include <stdio.h>

#include <math.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/quadrature.h"
#include "support/slot.h"
#include "support/test.h"

static lac_model spring(double stiffness, double speed)
{
    lac_model model = test_slot_shear("spring");
    test_slot_set(&model, "stiffness", stiffness);
    test_slot_set(&model, "speed", speed);
    return model;
}

// A slider of order-one scales, a perturbation off steady sliding at the speed of the spring.
static block_def slider(const lac_model *model, double off)
{
    block_def def = block_default(1.5, 1.0);
    def.slip_rate = 1.0 + off;
    def.shear = model;
    def.shear_count = 1;
    return def;
}

static lac_run_result integrate(const block_def *def, const lac_run_def *how, history *h)
{
    block b;
    lac_error err = {""};
    lac_run_result result;
    block_create(def, &b);
    lac_sink sink = history_sink(h);
    if (lac_run(b.problem, how, &sink, &result, &err) != LAC_OK) {
        fail_msg("run: %s", err.message);
    }
    block_clear(&b);
    return result;
}

// Maxima of ln v along a history, by the parabola through three records.
static size_t maxima(const history *h, double *time, double *height, size_t room)
{
    size_t found = 0;
    for (size_t i = 1; i + 1 < h->n && found < room; i++) {
        double y0 = log(h->line[i - 1].observation.mean_rate);
        double y1 = log(h->line[i].observation.mean_rate);
        double y2 = log(h->line[i + 1].observation.mean_rate);
        if (y1 > y0 && y1 >= y2) {
            double bend = y0 - 2.0 * y1 + y2;
            double shift = 0.5 * (y0 - y2) / bend;
            double dt = history_time(h, i) - history_time(h, i - 1);
            time[found] = history_time(h, i) + shift * dt;
            height[found] = y1 - 0.25 * (y0 - y2) * shift;
            found++;
        }
    }
    return found;
}

// lambda^2 + lambda [k V/(a s) - (V/dc)(b-a)/a] + k V^2/(a s dc) = 0: growth is Re lambda.
static void growth_rate(void **state)
{
    const double ratios[] = {0.5, 0.9, 0.99, 1.01, 1.1, 1.5};
    for (size_t i = 0; i < sizeof ratios / sizeof ratios[0]; i++) {
        block_def def = block_default(1.5, 1.0);
        def.formulation = chosen(state);
        double critical = def.pressure * (def.b - def.a) / def.dc;
        double k = ratios[i] * critical;
        double want = 0.5 * ((def.b - def.a) / (def.a * def.dc) - k / (def.a * def.pressure));
        lac_model model = spring(k, 1.0);
        def = slider(&model, 1e-6);
        def.formulation = chosen(state);
        lac_run_def how = lac_run_default();
        how.rtol = 1e-13;
        how.end = 40.0;
        how.failure_rate = 1e3;
        how.record = (lac_cadence){.time = 0.02, .per_decade = NAN};
        history h = {0};
        (void)integrate(&def, &how, &h);
        double time[64];
        double height[64];
        size_t n = maxima(&h, time, height, 64);
        assert_true(n >= 3);
        double growth = log(height[2] / height[1]) / (time[2] - time[1]);
        printf("k/k_crit %-5g growth rate %+.6f, linear theory %+.6f\n", ratios[i], growth, want);
        assert_true(fabs(growth - want) <= 0.01 * fabs(want));
        history_clear(&h);
        lac_model_clear(&model);
    }
}

// Far from linear: above k_crit a slider comes to rest at the spring's speed, below it stick-slips.
static void stable_above_and_unstable_below(void **state)
{
    const double ratios[] = {0.8, 1.2};
    for (size_t i = 0; i < 2; i++) {
        block_def def = block_default(1.5, 1.0);
        def.formulation = chosen(state);
        lac_model model = spring(ratios[i] * def.pressure * (def.b - def.a) / def.dc, 1.0);
        def = slider(&model, 0.1);
        def.formulation = chosen(state);
        def.damping = 1.0;
        lac_run_def how = lac_run_default();
        how.rtol = 1e-9;
        how.end = 300.0;
        how.failure_rate = 1e3;
        history h = {0};
        lac_run_result result = integrate(&def, &how, &h);
        if (i == 0) {
            assert_true(result.max_slip_rate > 5.0);
        } else {
            assert_false(result.failed);
            assert_true(fabs(h.line[h.n - 1].observation.mean_rate - 1.0) < 1e-6);
        }
        history_clear(&h);
        lac_model_clear(&model);
    }
}

// From 1e-25 to 10 m/s: plain and regularised laws fail when the exact solution says; the run
// spans 1e21 s and resolves microseconds at its end.
static void slow_start(void **state)
{
    const char *laws[] = {"aging", "slip"};
    double time[2][2];
    for (int form = 0; form < 2; form++) {
        for (int l = 0; l < 2; l++) {
            block_def def = block_default(1.5, 0.9);
            def.formulation = chosen(state);
            def.law = laws[l];
            def.form = form;
            def.v0 = 1e-6;
            def.dc = 1e-4;
            def.slip_rate = 1e-25;
            lac_run_def how = lac_run_default();
            how.rtol = 1e-10;
            how.end = 1e30;
            how.failure_rate = 10.0;
            history h = {0};
            lac_run_result result = integrate(&def, &how, &h);
            assert_true(result.failed);
            time[form][l] = result.failure_origin + result.failure_local;
            double last = h.line[h.n - 1].observation.mean_rate;
            assert_true(fabs(last - 10.0) < 1e-6);
            for (size_t i = 1; i < h.n; i++) {
                double dt = (h.line[i].time_origin - h.line[i - 1].time_origin) +
                            (h.line[i].time_local - h.line[i - 1].time_local);
                assert_true(dt > 0.0);
            }
            if (l == 0) {
                double steady = block_steady_state(&def);
                double x = pow(10.0 / block_steady_rate(&def), -1.0 / 1.5);
                double exact = steady * aging_time(1.5, 0.9, x);
                assert_true(fabs(time[form][l] / exact - 1.0) < 1e-6);
            }
            history_clear(&h);
        }
    }
    // f >> a: the regularised law is the plain one.
    for (int l = 0; l < 2; l++) {
        assert_true(fabs(time[0][l] / time[1][l] - 1.0) < 1e-9);
    }
}

// With damping the same start passes v_c = a sigma/eta and goes on to 10 m/s without a singularity.
static void slow_start_damped(void **state)
{
    block_def def = block_default(1.5, 0.9);
    def.formulation = chosen(state);
    def.dc = 1e-4;
    def.v0 = 1e-6;
    def.slip_rate = 1e-25;
    def.damping = 1e4; // v_c = 1 m/s
    for (int form = 0; form < 2; form++) {
        def.form = form;
        lac_run_def how = lac_run_default();
        how.rtol = 1e-9;
        how.end = 1e30;
        how.failure_rate = 10.0;
        history h = {0};
        lac_run_result result = integrate(&def, &how, &h);
        assert_true(result.failed);
        assert_true(result.balance_residual < 1e-6);
        double steady = block_steady_state(&def);
        double exact = steady * aging_time(1.5, 0.9, 1e-18);
        double tc = result.failure_origin + result.failure_local;
        assert_true(fabs(tc / exact - 1.0) < 1e-6); // the damped part lasts milliseconds
        history_clear(&h);
    }
}

// A block that relaxes: from 10 m/s down to 1e-25 m/s.
static void slow_end(void **state)
{
    block_def def = block_default(1.5, 1.5);
    def.formulation = chosen(state);
    def.dc = 1e-4;
    def.slip_rate = 10.0;
    lac_run_def how = lac_run_default();
    how.rtol = 1e-10;
    how.failure_rate = 100.0;
    double steady = block_steady_state(&def);
    how.end = steady * pow(1e-26, -1.0 / 1.5);
    history h = {0};
    lac_run_result result = integrate(&def, &how, &h);
    assert_false(result.failed);
    double last = h.line[h.n - 1].observation.mean_rate;
    assert_true(last < 1e-24);
    double x = pow(last / block_steady_rate(&def), -1.0 / 1.5);
    assert_true(fabs(steady * aging_time(1.5, 1.5, x) / how.end - 1.0) < 1e-6);
    double slip = -def.dc / 0.5 * log((1.0 - pow(1.5, -0.5)) / (1.0 - pow(x, -0.5)));
    assert_true(fabs(result.mean_slip / slip - 1.0) < 1e-6);
    history_clear(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOR_EACH_FORMULATION(growth_rate), FOR_EACH_FORMULATION(stable_above_and_unstable_below),
        FOR_EACH_FORMULATION(slow_start),  FOR_EACH_FORMULATION(slow_start_damped),
        FOR_EACH_FORMULATION(slow_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
