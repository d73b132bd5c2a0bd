// SPDX-License-Identifier: GPL-3.0-or-later
// One block with numbers of extreme size, in every formulation and method, against an integral in
// long double (support/one_cell.h). A run gives the right time, or one line that says what happened
// and when; the table that this prints is in docs/limits.md.
#include <stdio.h>
#include <string.h>

#include <complex.h>
#include <math.h>

#include "support/one_cell.h"
#include "support/slot.h"
#include "support/test.h"

static const lac_method methods[] = {LAC_BDF, LAC_ADAMS, LAC_ERK};
static const char *const method_names[] = {"bdf", "adams", "erk"};

static const double year = 365.25 * 86400.0;

static lac_run_def to_rate(lac_method method, double rate, double rtol)
{
    lac_run_def how = lac_run_default();
    how.method = method;
    how.rtol = rtol;
    how.end = 1e45;
    how.failure_rate = rate;
    how.max_steps = 50000;
    return how;
}

// A line that says what happened and when.
static void assert_explained(const one_cell_outcome *out)
{
    if (strstr(out->message, "t = ") == NULL) {
        fail_msg("no time in: %s", out->message);
    }
}

// Relative error of the time of failure; fails the test where it is more than `most`.
static double compare(const block_def *def, const lac_run_def *how, double exact, double most)
{
    one_cell_outcome out = one_cell_run(def, how);
    if (out.status != LAC_OK) {
        fail_msg("%s, %s: %s", method_names[how->method], lac_formulation_name(def->formulation),
                 out.message);
    }
    assert_true(out.finite && out.result.failed);
    double got = out.result.failure_origin + out.result.failure_local;
    double error = fabs(got / exact - 1.0);
    if (!(error <= most)) {
        fail_msg("%s, %s: v %g, theta %g, dc %g, a %g, b %g: t %.12g, exact %.12g, error %.2g",
                 method_names[how->method], lac_formulation_name(def->formulation), def->slip_rate,
                 def->theta, def->dc, def->a, def->b, got, exact, error);
    }
    return error;
}

// In both forms of friction: where f is above 20 a the regularised one is the plain one to the last
// bit.
static double all_methods(block_def *def, void **state, double rate, double most)
{
    double worst = 0.0, exact = one_cell_time(def, rate);
    def->formulation = chosen(state);
    for (size_t i = 0; i < 6; i++) {
        def->form = i < 3 ? LAC_FORM_PLAIN : LAC_FORM_REGULARISED;
        lac_run_def how = to_rate(methods[i % 3], rate, 1e-9);
        worst = fmax(worst, compare(def, &how, exact, most));
    }
    return worst;
}

static void report(void **state, const char *what, double worst)
{
    printf("%-34s %-9s worst relative error of the time %.1e\n", what,
           lac_formulation_name(chosen(state)), worst);
}

// From creep at 1e-30, 1e-20 ... m/s to 1e3 m/s, all in one run.
static void slip_rate(void **state)
{
    double worst = 0.0;
    for (int k = -30; k <= 2; k += 8) {
        block_def def = block_default(1.5, 0.5);
        def.slip_rate = pow(10.0, k);
        worst = fmax(worst, all_methods(&def, state, 1e3, 1e-6));
    }
    report(state, "v 1e-30 ... 1e3 m/s", worst);
}

// Failure of a block that is as old as that, and healing over 1e30 times the state at the start.
static void state_variable(void **state)
{
    double worst = 0.0;
    for (int k = -12; k <= 18; k += 5) {
        block_def def = block_default(1.5, 0.5);
        def.theta = pow(10.0, k);
        def.dc = k < -2 ? 1e-9 : 1.0;
        def.slip_rate = 2.0 * def.dc / def.theta;
        worst = fmax(worst, all_methods(&def, state, 1e8 * def.slip_rate, 1e-6));
    }
    report(state, "theta 1e-12 ... 1e18 s", worst);
}

static void healing(void **state)
{
    double worst = 0.0;
    for (size_t i = 0; i < 3; i++) {
        block_def def = block_default(1.5, 1.2);
        def.formulation = chosen(state);
        lac_run_def how = to_rate(methods[i], 1e3, 1e-9);
        how.end = 1e30;
        one_cell_outcome out = one_cell_run(&def, &how);
        if (out.status != LAC_OK) {
            fail_msg("%s: %s", method_names[i], out.message);
        }
        assert_true(out.finite && !out.result.failed);
        double exact = one_cell_time(&def, out.last_rate);
        worst = fmax(worst, fabs(exact / 1e30 - 1.0));
        assert_true(out.last_rate < 1e-40);
    }
    assert_true(worst < 1e-6);
    report(state, "theta 1 ... 1e30 s in one run", worst);
}

static void slip_to_renew(void **state)
{
    double worst = 0.0;
    for (int k = -18; k <= 0; k++) { // from the smallest that a law takes
        block_def def = block_default(1.35, 0.5);
        def.dc = pow(10.0, k);
        def.slip_rate = 1e-9;
        def.v0 = 1e-6;
        worst = fmax(worst, all_methods(&def, state, 1.0, 1e-6));
    }
    report(state, "dc 1e-18 ... 1 m", worst);
}

// Slip of 2000 dc at rtol 1e-13, which is finer than a double resolves beyond 450 dc. b = a/2:
// v settles at 1, and what slip is ahead of t is the integral of x^-1/2 over x = theta/theta_ss.
static void slip_far_beyond_dc(void **state)
{
    double worst = 0.0;
    for (size_t i = 0; i < 3; i++) {
        block_def def = block_default(0.5, 0.9);
        def.formulation = chosen(state);
        lac_run_def how = to_rate(methods[i], 1e3, 1e-13);
        how.end = 2000.0;
        one_cell_outcome out = one_cell_run(&def, &how);
        if (out.status != LAC_OK) {
            fail_msg("%s: %s", method_names[i], out.message);
        }
        double exact = how.end + 2.0 * (1.0 - sqrt(def.x));
        worst = fmax(worst, fabs(out.result.mean_slip / exact - 1.0));
    }
    assert_true(worst < 1e-11);
    printf("%-34s %-9s worst relative error of slip %.1e\n", "slip 2000 dc, rtol 1e-13",
           lac_formulation_name(chosen(state)), worst);
}

// a falls, b stays: the weaker the direct effect, the more sudden the failure.
static void direct_effect(void **state, double damping, const char *what)
{
    double worst = 0.0;
    for (int k = -2; k >= -8; k--) {
        block_def def = block_default(1.5, 0.5);
        def.a = pow(10.0, k);
        def.b = 0.015;
        def.damping = damping;
        def.slip_rate = 1e-3;
        def.theta = 2.0 * def.dc / def.slip_rate;
        worst = fmax(worst, all_methods(&def, state, damping > 0 ? 0.05 : 1e2, 1e-6));
    }
    report(state, what, worst);
}

static void direct_effect_undamped(void **state) { direct_effect(state, 0.0, "a 1e-2 ... 1e-8"); }

static void direct_effect_damped(void **state)
{
    direct_effect(state, 1e4, "a 1e-2 ... 1e-8, damped");
}

// Without direct effect damping alone tells the rate: where v is solved for, an error of ln theta
// is b p/(eta v) = 1500 times that in ln v.
static void no_direct_effect(void **state)
{
    block_def def = block_default(1.5, 0.5);
    def.a = 0.0;
    def.b = 0.015;
    def.damping = 1e4;
    def.slip_rate = 1e-3;
    def.theta = 2.0 * def.dc / def.slip_rate;
    report(state, "a = 0, damped", all_methods(&def, state, 0.05, 1e-5));
}

static void equal_effects(void **state)
{
    block_def def = block_default(1.0, 0.5);
    def.slip_rate = 1e-6;
    def.theta = 2.0 * def.dc / def.slip_rate;
    // theta falls by 1 - v theta/dc = -1 a second
    assert_true(fabs(one_cell_time(&def, 1e3) / def.theta - 1.0) < 1e-8);
    report(state, "b = a", all_methods(&def, state, 1e3, 1e-6));
}

static void strong_evolution(void **state)
{
    double worst = 0.0;
    const double ratios[] = {0.01, 0.1, 3.0, 10.0, 100.0};
    for (size_t i = 0; i < 5; i++) {
        block_def def = block_default(ratios[i], 0.5);
        def.slip_rate = 1e-6;
        // below b = a a block speeds up towards its steady rate, x of it: half an e-fold
        bool steady = ratios[i] < 1.0;
        def.theta = (steady ? 3.0 : 2.0) * def.dc / def.slip_rate;
        if (steady) {
            // v theta/dc falls to 1 at an e-fold of ln(3)/(1/m - 1) in v
            double folds = log(3.0) / (1.0 / ratios[i] - 1.0);
            worst = fmax(worst, all_methods(&def, state, 1e-6 * exp(0.5 * folds), 1e-6));
        } else {
            worst = fmax(worst, all_methods(&def, state, 1e3, 1e-6));
        }
    }
    report(state, "b/a 0.01 ... 100", worst);
}

static void time_span(void **state)
{
    double worst = 0.0;
    const double spans[] = {1e-3, 1.0, 1e4, year, 1e3 * year, 1e6 * year};
    for (size_t i = 0; i < 6; i++) {
        block_def def = block_default(1.5, 0.5);
        def.dc = 1e-5;
        def.slip_rate = def.dc / spans[i]; // fails after 0.9 of it
        worst = fmax(worst, all_methods(&def, state, fmax(1.0, 1e3 * def.slip_rate), 1e-6));
    }
    report(state, "1 ms ... 1e6 years", worst);
}

// Every tolerance gives its error or says why not; none is worse than ten times the one before.
static void tolerance(void **state)
{
    block_def def = block_default(1.5, 0.5);
    def.formulation = chosen(state);
    for (size_t i = 0; i < 3; i++) {
        printf("%-9s %-5s rtol 1e-2 ... 1e-13:", lac_formulation_name(def.formulation),
               method_names[i]);
        double exact = one_cell_time(&def, 1e3), best = INFINITY;
        for (int k = 2; k <= 13; k++) {
            lac_run_def how = to_rate(methods[i], 1e3, pow(10.0, -k));
            one_cell_outcome out = one_cell_run(&def, &how);
            assert_true(out.finite);
            if (out.status != LAC_OK) {
                printf(" [%s]", out.message);
                assert_explained(&out);
                continue;
            }
            double got = out.result.failure_origin + out.result.failure_local;
            double error = fabs(got / exact - 1.0);
            printf(" %.0e", error);
            assert_true(error < 10.0 * pow(how.rtol, 0.8) && error < fmax(10.0 * best, 1e-11));
            best = fmin(best, error);
        }
        printf("\n");
    }
}

// ln v one second after ln theta was put off by 1 in a slider that slid steadily at 1 m/s, linear
// theory with kappa = k dc/(a p): u' = (m - kappa) u + m w, w' = -u - w.
static double slider_response(double m, double kappa)
{
    double complex half = 0.5 * (m - 1.0 - kappa), root = csqrt(half * half - kappa);
    double complex fast = half - root, slow = kappa / fast; // their product is kappa
    return creal(m * (cexp(slow) - cexp(fast)) / (slow - fast));
}

// Springs from none to 1e6 k_crit. Explicit methods may run out of steps at the stiff end.
static void spring_stiffness(void **state)
{
    const double off = 1e-5, m = 1.5;
    const double ratios[] = {0.0, 1e-6, 0.01, 0.99, 1.01, 1e2, 1e4, 1e6};
    double worst = 0.0;
    for (size_t i = 0; i < 24; i++) {
        block_def def = block_default(m, 1.0);
        def.formulation = chosen(state);
        def.theta = def.dc * (1.0 + off);
        double k = ratios[i / 3] * def.pressure * (def.b - def.a) / def.dc;
        lac_model spring = test_slot_shear("spring");
        test_slot_set(&spring, "stiffness", k);
        test_slot_set(&spring, "speed", 1.0);
        def.shear = &spring;
        def.shear_count = 1;
        lac_run_def how = to_rate(methods[i % 3], 1e3, 1e-10);
        how.end = 1.0;
        one_cell_outcome out = one_cell_run(&def, &how);
        lac_model_clear(&spring);
        assert_true(out.finite);
        if (out.status != LAC_OK && methods[i % 3] != LAC_BDF) {
            assert_explained(&out);
            printf("k = %g k_crit, %s: %s\n", ratios[i / 3], method_names[i % 3], out.message);
            continue;
        }
        assert_int_equal(out.status, LAC_OK);
        double want = off * slider_response(m, k * def.dc / (def.a * def.pressure));
        worst = fmax(worst, fabs(log(out.last_rate) - want) / off);
    }
    printf("%-34s %-9s worst error of ln v over the disturbance %.1e\n", "k 0 ... 1e6 k_crit",
           lac_formulation_name(chosen(state)), worst);
    assert_true(worst < 1e-3);
}

typedef struct jump {
    double time, size;
} jump;

static void add_jump(const lac_load *load, double t, lac_load_state *sum)
{
    const jump *j = load->params;
    sum->ratio += t < j->time ? 0.0 : j->size;
}

static double jump_break(const lac_load *load, double t)
{
    const jump *j = load->params;
    return t < j->time ? j->time : INFINITY;
}

static const lac_load_kind jump_kind = {
    .info = {.name = "jump"}, .add = add_jump, .next_break = jump_break};

static one_cell_outcome jumped(block_def *def, lac_method method, double size)
{
    jump j = {.time = 2.0, .size = size};
    lac_model model = {.info = &jump_kind.info, .params = &j};
    lac_run_def how = to_rate(method, 1.5, 1e-8);
    def->shear = &model;
    def->shear_count = 1;
    one_cell_outcome out = one_cell_run(def, &how);
    assert_true(out.finite);
    return out;
}

// ln v after a jump: a (u - u0) + eta (e^u - e^u0)/p = size, by bisection in long double.
static double rate_after(const block_def *def, double before, double size)
{
    long double low = logl(before), high = low + 1e3L;
    for (int i = 0; i < 200; i++) {
        long double u = (low + high) / 2;
        long double more = def->a * (u - logl(before)) +
                           def->damping / def->pressure * (expl(u) - before) - (long double)size;
        *(more > 0 ? &high : &low) = u;
    }
    return (double)expl(low);
}

// A load that steps to ten times the strength: with damping the rate that balances it; without,
// an error in the place of the huge one that friction alone asks for.
static void load_step(void **state)
{
    const double damping[] = {5e6, 0.0};
    for (size_t i = 0; i < 6; i++) {
        block_def def = block_default(0.5, 1.0); // steady at 1 m/s
        def.formulation = chosen(state);
        def.damping = damping[i % 2];
        one_cell_outcome out = jumped(&def, methods[i / 2], 6.0);
        if (!(def.damping > 0.0)) {
            assert_int_equal(out.status, LAC_ENUMERIC);
            assert_explained(&out);
            continue;
        }
        assert_int_equal(out.status, LAC_OK);
        assert_true(out.result.failed && out.result.time == 2.0);
        double want = rate_after(&def, 1.0, 6.0);
        double error = fabs(log(out.last_rate) - log(want)) / fmax(1.0, log(want));
        if (!(error < 1e-6)) {
            fail_msg("%g m/s, not %g", out.last_rate, want);
        }
    }
}

static void load_step_beyond_numbers(void **state)
{
    for (size_t i = 0; i < 3; i++) {
        block_def def = block_default(0.5, 1.0);
        def.formulation = chosen(state);
        def.a = 0.001;
        def.b = 0.0005;
        one_cell_outcome out = jumped(&def, methods[i], 6.0); // e^6000
        if (out.status == LAC_OK) {
            fail_msg("complete at %g m/s", out.result.max_slip_rate);
        }
        assert_explained(&out);
        printf("%s, %s: %s\n", lac_formulation_name(def.formulation), method_names[i], out.message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        FOR_EACH_FORMULATION(slip_rate),
        FOR_EACH_FORMULATION(state_variable),
        FOR_EACH_FORMULATION(healing),
        FOR_EACH_FORMULATION(slip_to_renew),
        FOR_EACH_FORMULATION(slip_far_beyond_dc),
        FOR_EACH_FORMULATION(direct_effect_undamped),
        FOR_EACH_FORMULATION(direct_effect_damped),
        FOR_EACH_FORMULATION(no_direct_effect),
        FOR_EACH_FORMULATION(equal_effects),
        FOR_EACH_FORMULATION(strong_evolution),
        FOR_EACH_FORMULATION(time_span),
        FOR_EACH_FORMULATION(spring_stiffness),
        FOR_EACH_FORMULATION(tolerance),
        FOR_EACH_FORMULATION(load_step),
        FOR_EACH_FORMULATION(load_step_beyond_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
