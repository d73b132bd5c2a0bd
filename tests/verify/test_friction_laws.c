// SPDX-License-Identifier: GPL-3.0-or-later
// The composite law, cut-off slip rates and the response to normal stress against closed forms and
// quadratures; docs/theory/friction.md. Numbers given here with 15 digits are integrals by mpmath
// 1.2 at 30 digits; the integrand stands beside each.

#include <gsl/gsl_sf_lambert.h>
#include <math.h>
#include <stdlib.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/slot.h"
#include "support/test.h"

static void assert_close(double got, double want, double relative, const char *what)
{
    if (!(fabs(got - want) <= relative * fabs(want))) {
        fail_msg("%s: %.15g, expected %.15g within %g", what, got, want, relative);
    }
}

static double evolution(const lac_friction *friction, double u, double w)
{
    double f, f_u, f_w, g, v = exp(u);
    lac_friction_evaluate(friction, &(lac_friction_cells){0, 1, &u, &w, &v, 0, NULL},
                          &(lac_friction_values){&f, &f_u, &f_w, &g}, NULL);
    return g;
}

// A block whose times are of order one: dc = v0 = 1, a = 0.01, b = 0.015.
static block_def start(const char *law, double rate, double theta)
{
    block_def def = block_default(1.5, 1.0);
    def.law = law;
    def.slip_rate = rate;
    def.theta = theta;
    return def;
}

static void composite_limits(void **state)
{
    (void)state;
    block_def def = start("composite", 1, 1);
    def.vc = 1e-8;
    block b;
    block_create(&def, &b);
    for (double u = -60; u < 7; u += 0.9) {
        double v = exp(u), z = exp(gsl_sf_lambert_W0(exp(-v / 1e-8)));
        double w = lac_friction_steady_state(b.friction, 0, u);
        assert_close(exp(w + u), z, 1e-13, "v theta/dc in steady sliding");
        double f = lac_friction_coefficient(b.friction, 0, u, w);
        assert_close(f, 0.6 - 0.005 * u + 0.015 * log(z), 1e-13, "steady friction");
    }
    for (double w = -20; w < 40; w += 3) {
        assert_close(evolution(b.friction, -800, w) * exp(w), 1, 1e-14, "healing at rest");
        // far above vc the contacts feel only slip
        double slip = -exp(-5.0) * (w - 5);
        assert_true(fabs(evolution(b.friction, -5, w) - slip) <= 1e-15 * fabs(slip));
    }
    block_clear(&b);
}

// At constant v: t = (dc/v) integral of dz/(exp(-v/vc) - z ln z), z = v theta/dc. Here v = vc.
static void composite_at_constant_rate(void **state)
{
    (void)state;
    static const struct {
        double from, to, time;
    } known[] = {{0.1, 1, 1.47808809620798}, {5, 2, 0.976488838099069}};
    block_def def = start("composite", 1, 1);
    def.vc = 1;
    block b;
    block_create(&def, &b);
    for (size_t k = 0; k < 2; k++) {
        const int steps = 2000;
        double h = known[k].time / steps, w = log(known[k].from);
        for (int i = 0; i < steps; i++) { // Runge and Kutta's method
            double k1 = evolution(b.friction, 0, w), k2 = evolution(b.friction, 0, w + h / 2 * k1);
            double k3 = evolution(b.friction, 0, w + h / 2 * k2);
            double k4 = evolution(b.friction, 0, w + h * k3);
            w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
        assert_close(exp(w), known[k].to, 1e-11, "z");
    }
    block_clear(&b);
}

static double time_to_rate(const block_def *def, double rate)
{
    block b;
    lac_error err = {""};
    lac_run_result result;
    lac_run_def how = lac_run_default();
    how.rtol = 1e-9;
    how.failure_rate = rate;
    how.end = 1e30;
    block_create(def, &b);
    lac_status status = lac_run(b.problem, &how, NULL, &result, &err);
    block_clear(&b);
    if (status != LAC_OK) {
        fail_msg("run: %s", err.message);
    }
    return result.failure_origin + result.failure_local;
}

// Under constant load: composite, v = S theta^-1.5 through v = vc = 1 at theta = 2,
// t = integral of dtheta/(v theta ln(v theta) - exp(-v)) from theta(1e6) to 2.
static void composite_block_runs_away(void **state)
{
    (void)state;
    block_def def = start("composite", 1, 2);
    def.vc = 1;
    assert_close(time_to_rate(&def, 1e6), 0.789096483879338, 1e-7, "composite");
    // thirty decades of rates, from 1e-27 m/s at theta = 3 dc/v
    def = start("composite", 1e-27, 3e21);
    def.dc = 1e-6;
    def.v0 = 1e-6;
    def.vc = 1e-8;
    assert_close(time_to_rate(&def, 1e3), 6.13918380876192e20, 1e-7, "thirty decades");
}

// Under constant load with cut-offs: aging, v = 2 at theta = 1; V = v/(1 + v/v1) and
// K = ln V + 1.5 ln(theta + 1/v2) stays, t = integral of dtheta/(v(theta) theta - 1).
static void blocks_with_cut_offs_run_away(void **state)
{
    (void)state;
    block_def def = start("aging", 2, 1);
    def.v1 = 100;
    assert_close(time_to_rate(&def, 1e4), 0.503739665638391, 1e-7, "v1");
    def.v2 = 30;
    assert_close(time_to_rate(&def, 100), 0.540208417670031, 1e-7, "v1 and v2");
    def.v1 = 0;
    assert_close(time_to_rate(&def, 100), 0.587616178830761, 1e-7, "v2");
}

// f = f0' - a ln(v1/v + 1) + b ln(v2 theta/dc + 1), f0' = f0 + a ln(v1/v0) - b ln(v2/v0), as
// Okubo (1989) writes it.
static long double okubo(const block_def *def, double u, double w)
{
    long double high =
        def->f0 + def->a * logl(def->v1 / def->v0) - def->b * logl(def->v2 / def->v0);
    return high - def->a * log1pl(def->v1 * expl(-u)) +
           def->b * log1pl(def->v2 / def->dc * expl(w));
}

static void cut_offs_are_okubos(void **state)
{
    (void)state;
    static const double rates[] = {1e-9, 1e-3, 0.1, 1e3};
    for (size_t k = 0; k < 16; k++) {
        for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
            block_def def = start("aging", 1e-6, 1);
            def.form = form;
            def.dc = 1e-4;
            def.v0 = 1e-6;
            def.v1 = rates[k % 4];
            def.v2 = rates[k / 4];
            block b;
            block_create(&def, &b);
            for (double u = -69; u < 7; u += 2.3) {
                for (double w = -27; w < 46; w += 2.9) {
                    long double f = okubo(&def, u, w), a = def.a;
                    long double want =
                        form == LAC_FORM_PLAIN || f > 40 * a ? f : a * asinhl(expl(f / a) / 2);
                    double got = lac_friction_coefficient(b.friction, 0, u, w);
                    double tolerance = form == LAC_FORM_PLAIN ? 1e-14 : (double)(2e-12L * want);
                    assert_true(fabsl(got - want) <= fmax(tolerance, 1e-300));
                }
            }
            block_clear(&b);
        }
    }
}

// v2 < v < v1 strengthens, v1 < v < v2 weakens, whatever b - a: df_ss/dlnv = a/(1 + v/v1) -
// b/(1 + v/v2).
static void steady_friction_turns_at_the_cut_offs(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        block_def def = start("aging", 1e-6, 1);
        def.v1 = k == 0 ? 1 : 1e-3;
        def.v2 = k == 0 ? 1e-3 : 1;
        block b;
        block_create(&def, &b);
        for (double u = -40; u < 10; u += 0.7) {
            double f[2];
            for (int side = 0; side < 2; side++) {
                double at = u + (side - 0.5) * 1e-3;
                double w = lac_friction_steady_state(b.friction, 0, at);
                f[side] = lac_friction_coefficient(b.friction, 0, at, w);
            }
            double want = def.a / (1 + exp(u) / def.v1) - def.b / (1 + exp(u) / def.v2);
            assert_true(fabs((f[1] - f[0]) / 1e-3 - want) < 1e-8);
        }
        double w = lac_friction_steady_state(b.friction, 0, log(0.03));
        double slope = lac_friction_plain(b.friction, 0, log(0.031), w - log(0.031 / 0.03)) -
                       lac_friction_plain(b.friction, 0, log(0.03), w);
        assert_true(k == 0 ? slope > 0 : slope < 0);
        block_clear(&b);
    }
}

// theta = x theta_ss under the load that follows: steady sliding at theta/x carries the same load.
static void ratio_to_steady_holds_for_every_law(void **state)
{
    (void)state;
    const lac_friction_law *law;
    for (size_t l = 0; (law = lac_friction_law_get(l)) != NULL; l++) {
        for (int k = 0; k < 24; k++) {
            block_def def = start(law->info.name, 1e-5, 1);
            def.v1 = k % 2 == 0 ? 0 : 1e-3;
            def.v2 = k / 2 % 2 == 0 ? 0 : 1e-4;
            block b;
            block_create(&def, &b);
            double x = pow(10, k / 4 - 2.5), u = log(1e-5) + k % 5;
            double w = lac_friction_state_at_ratio(b.friction, 0, u, x);
            double low = -60, high = 20;
            for (int i = 0; i < 100; i++) { // ln theta_ss falls as the rate rises
                double middle = (low + high) / 2;
                bool slow = lac_friction_steady_state(b.friction, 0, middle) > w - log(x);
                *(slow ? &low : &high) = middle;
            }
            double steady = lac_friction_coefficient(b.friction, 0, low, w - log(x));
            double f = lac_friction_coefficient(b.friction, 0, u, w);
            bool steady_exists = isfinite(w);
            // 1, but nothing where a state saturates, which then does not tell the rate
            double fall = 10 * (lac_friction_steady_state(b.friction, 0, low - 0.05) -
                                lac_friction_steady_state(b.friction, 0, low + 0.05));
            if (!steady_exists) { // steady sliding would take more friction than v1 leaves
                double wanted = u - log1p(exp(u) / def.v1) + 1.5 * log(x);
                assert_true(def.v1 > 0 && x > 1 && wanted > log(def.v1));
            }
            assert_true(!steady_exists || fabs(steady - f) * fmin(fall, 1) < 1e-13);
            block_clear(&b);
        }
    }
}

// Pore pressure that rises by `step` at t = 1, or from then at `rate`.
static const double step_pore = 3e5, ramp_rate = 2e4, begin = 1;

static void add_step(const lac_load *load, double t, lac_load_state *sum)
{
    (void)load;
    sum->pore += t >= begin ? step_pore : 0;
}

static void add_ramp(const lac_load *load, double t, lac_load_state *sum)
{
    (void)load;
    sum->pore += t >= begin ? ramp_rate * (t - begin) : 0;
    sum->pore_rate += t >= begin ? ramp_rate : 0;
}

static double at_begin(const lac_load *load, double t)
{
    (void)load;
    return t < begin ? begin : INFINITY;
}

static const lac_load_kind step_kind = {
    .info = {.name = "step"}, .add = add_step, .next_break = at_begin};
static const lac_load_kind ramp_kind = {
    .info = {.name = "ramp"}, .add = add_ramp, .next_break = at_begin};
static const lac_model step_slot = {.info = &step_kind.info};
static const lac_model ramp_slot = {.info = &ramp_kind.info};

// theta falls by (p1/p0)^(alpha/b), which takes alpha ln(p1/p0) off f at the same rate; the
// traction stays. Linker and Dieterich (1992).
static void state_jumps_with_the_normal_stress(void **state)
{
    (void)state;
    static const double alphas[] = {0, 0.1, 0.3};
    for (size_t k = 0; k < 3; k++) {
        block_def def = start("aging", 1e-3, 50);
        def.alpha = alphas[k];
        def.pore = &step_slot;
        def.pore_count = 1;
        block b;
        block_create(&def, &b);
        double y[2], z[2], share = 1 - step_pore / def.pressure;
        lac_problem_initial(b.problem, y);
        lac_problem_initial(b.problem, z);
        double *work = calloc(lac_problem_work(b.problem), sizeof *work);
        assert_non_null(work);
        assert_true(lac_problem_jump(b.problem, begin, z, work));
        free(work);
        assert_close(exp(z[1] - y[1]), pow(share, -alphas[k] / def.b), 1e-12, "theta");
        double before = lac_friction_coefficient(b.friction, 0, y[0], y[1]);
        double after = lac_friction_coefficient(b.friction, 0, z[0], z[1]);
        assert_close(after * share, before, 1e-13, "traction");
        double same_rate = lac_friction_coefficient(b.friction, 0, y[0], z[1]);
        assert_true(fabs(same_rate - before + alphas[k] * log(share)) < 1e-13);
        block_clear(&b);
    }
}

static lac_status keep_state(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    (void)err;
    *(double *)context = snapshot->state[0];
    return LAC_OK;
}

// At rest the aging law is d(theta p^k)/dt = p^k, k = alpha/b: with p = p0 - s (t - 1) from t = 1,
// theta p^k = (theta0 + 1) p0^k + (p0^(k+1) - p^(k+1))/(s (k + 1)).
static void state_at_rest_follows_a_ramp(void **state)
{
    (void)state;
    static const lac_method methods[] = {LAC_BDF, LAC_ADAMS, LAC_ERK};
    for (size_t i = 0; i < 6; i++) {
        block_def def = start(i % 2 == 0 ? "aging" : "composite", 1e-25, 10);
        def.alpha = i < 3 ? 0.25 : 0.05;
        def.pore = &ramp_slot;
        def.pore_count = 1;
        block b;
        lac_error err = {""};
        lac_run_result result;
        double theta = NAN, end = 21;
        lac_sink sink = {.context = &theta, .snapshot = keep_state};
        lac_run_def how = lac_run_default();
        how.method = methods[i % 3];
        how.rtol = 1e-10;
        how.end = end;
        how.snapshots = true;
        block_create(&def, &b);
        assert_int_equal(lac_run(b.problem, &how, &sink, &result, &err), LAC_OK);
        double k = def.alpha / def.b, p0 = def.pressure, p = p0 - ramp_rate * (end - begin);
        double grown = (1 - pow(p / p0, k + 1)) * p0 / (ramp_rate * (k + 1));
        assert_close(theta, pow(p / p0, -k) * (11 + grown), 1e-7, "theta at rest");
        assert_true(result.balance_residual < 1e-6);
        block_clear(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(composite_limits),
        cmocka_unit_test(composite_at_constant_rate),
        cmocka_unit_test(composite_block_runs_away),
        cmocka_unit_test(blocks_with_cut_offs_run_away),
        cmocka_unit_test(cut_offs_are_okubos),
        cmocka_unit_test(steady_friction_turns_at_the_cut_offs),
        cmocka_unit_test(ratio_to_steady_holds_for_every_law),
        cmocka_unit_test(state_jumps_with_the_normal_stress),
        cmocka_unit_test(state_at_rest_follows_a_ramp),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
