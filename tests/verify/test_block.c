// SPDX-License-Identifier: GPL-3.0-or-later
// One block under constant load against the exact solutions of docs/theory/creep.md.
#include <stdio.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_sf_expint.h>
#include <gsl/gsl_sf_lambert.h>
#include <math.h>

#include "lacuna/simulation.h"
#include "support/block.h"
#include "support/quadrature.h"
#include "support/slot.h"
#include "support/test.h"

static void assert_close(double got, double want, double relative, const char *what)
{
    if (!(fabs(got - want) <= relative * fabs(want))) {
        fail_msg("%s: %.15g, expected %.15g within %g", what, got, want, relative);
    }
}

static lac_run_result run(const block_def *def, const lac_run_def *how, history *h)
{
    block b;
    lac_error err = {""};
    lac_run_result result;
    block_create(def, &b);
    lac_sink sink = history_sink(h);
    lac_status status = lac_run(b.problem, how, &sink, &result, &err);
    block_clear(&b);
    if (status != LAC_OK) {
        fail_msg("run: %s", err.message);
    }
    return result;
}

static lac_run_def to_failure(double rtol, double rate)
{
    lac_run_def how = lac_run_default();
    how.rtol = rtol;
    how.failure_rate = rate;
    how.end = 1e30;
    return how;
}

// Exact time from the start to a mean rate, O3 by quadrature.
static double time_to_rate(const block_def *def, double rate)
{
    double m = def->b / def->a;
    double x = pow(rate / block_steady_rate(def), -1.0 / m);
    return block_steady_state(def) * aging_time(m, def->x, x);
}

static void quadrature_meets_the_published_numbers(void **state)
{
    (void)state;
    const double table[][3] = {{1.35, 0.5, 0.856272305814},
                               {1.2, 0.9, 8.44551837851},
                               {1.35, 0.999, 17.6180127079},
                               {2.0, 0.9, 1.40258509299},
                               {3.0, 0.9, 0.572219489583}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        assert_close(aging_time(table[i][0], table[i][1], 1e-40), table[i][2], 2e-11, "tc");
    }
    assert_close(aging_time(2.0, 0.9, 1e-40), -0.9 - log(0.1), 1e-12, "O4");
    assert_close(aging_time(3.0, 0.9, 1e-40), atanh(0.9) - 0.9, 1e-12, "O5");
}

// O3: the time of failure, and how its error falls with the tolerance.
static void time_of_failure(void **state)
{
    const double cases[][2] = {{1.35, 0.5}, {1.2, 0.9}, {1.35, 0.999}, {2.0, 0.9}, {3.0, 0.9}};
    const double rate = 1e9;
    printf("relative error of the time of failure (BDF)\n  m     x      ");
    for (int k = 4; k <= 10; k++) {
        printf("  rtol 1e-%-2d", k);
    }
    printf("\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        block_def def = block_default(cases[i][0], cases[i][1]);
        def.formulation = chosen(state);
        double exact = time_to_rate(&def, rate);
        double error[11];
        printf("  %-5g %-5g", cases[i][0], cases[i][1]);
        for (int k = 4; k <= 10; k++) {
            lac_run_def how = to_failure(pow(10.0, -k), rate);
            history h = {0};
            lac_run_result result = run(&def, &how, &h);
            assert_true(result.failed);
            double tc = result.failure_origin + result.failure_local;
            error[k] = fabs(tc / exact - 1.0);
            printf("  %9.1e", error[k]);
            history_clear(&h);
        }
        printf("\n");
        assert_true(error[10] <= 1e-6);
        // Two decades of tolerance must show each time, until rounding is reached.
        assert_true(error[6] < error[4] && error[8] < error[6] && error[10] < error[8]);
    }
}

// O1: slip as a function of state; O2: rate alone, both along the whole run.
static void slip_and_rate_along_the_run(void **state)
{
    block_def def = block_default(1.5, 0.8);
    def.formulation = chosen(state);
    double m = 1.5;
    double v_star = block_steady_rate(&def);
    history h = {0};
    lac_run_def how = to_failure(1e-10, 1e6);
    (void)run(&def, &how, &h);
    for (size_t i = 1; i < h.n; i++) {
        double x = pow(h.line[i].observation.mean_rate / v_star, -1.0 / m);
        double z = fabs(1.0 - pow(x, 1.0 - m));
        double slip = def.dc / (m - 1.0) * log(z / fabs(1.0 - pow(def.x, 1.0 - m)));
        assert_true(fabs(h.line[i].observation.mean_slip - slip) < 1e-7 * (slip + 1e-2));
        double t = block_steady_state(&def) * aging_time(m, def.x, x);
        assert_true(fabs(history_time(&h, i) - t) < 1e-7 * time_to_rate(&def, 1e6));
    }
    assert_true(h.n > 100);
    history_clear(&h);
}

// O4: m = 2 has x(T) in closed form with Lambert's W.
static void lambert(void **state)
{
    block_def def = block_default(2.0, 0.9);
    def.formulation = chosen(state);
    lac_run_def how = to_failure(1e-10, 1e12);
    how.end = 1.3;
    history h = {0};
    lac_run_result result = run(&def, &how, &h);
    assert_false(result.failed);
    for (size_t i = 1; i < h.n; i++) {
        double shift = def.x + log(1.0 - def.x) + history_time(&h, i) - 1.0;
        double x = 1.0 + gsl_sf_lambert_W0(-exp(shift));
        assert_close(h.line[i].observation.mean_rate, pow(x, -2.0), 1e-6, "O4 rate");
    }
    history_clear(&h);
}

// O6: v (tc - t) m/dc -> 1, from above by x^(m-1) alpha/(alpha+1).
static void approach_to_failure(void **state)
{
    double m = 2.0;
    block_def def = block_default(m, 0.5);
    def.formulation = chosen(state);
    double tc = block_steady_state(&def) * aging_time(m, 0.5, 1e-40);
    lac_run_def how = to_failure(1e-11, 1e7);
    history h = {0};
    (void)run(&def, &how, &h);
    size_t used = 0;
    for (size_t i = 0; i < h.n; i++) {
        double v = h.line[i].observation.mean_rate;
        if (v > 1e4 && v < 1e5) {
            double x = pow(v, -1.0 / m);
            double alpha = m / (m - 1.0);
            double want = 1.0 + x * alpha / (alpha + 1.0);
            assert_close(v * (tc - history_time(&h, i)) * m / def.dc, want, 2e-4, "O6");
            used++;
        }
    }
    assert_true(used > 3);
    history_clear(&h);
}

// O7: m > 1, x > 1 relaxes as a power law with finite slip.
static void relaxation(void **state)
{
    block_def def = block_default(1.5, 1.2);
    def.formulation = chosen(state);
    lac_run_def how = lac_run_default();
    how.rtol = 1e-10;
    how.end = 1e14;
    history h = {0};
    lac_run_result result = run(&def, &how, &h);
    assert_false(result.failed);
    // v -> v* (t/theta_ss)^-m, from the exact dT = dx/(1 - x^(1-m)): T = x + O(ln x or x^(2-m)).
    double last = h.line[h.n - 1].observation.mean_rate;
    double x = pow(last / block_steady_rate(&def), -1.0 / 1.5);
    assert_close(aging_time(1.5, 1.2, x) * block_steady_state(&def), 1e14, 1e-7, "O7 time");
    assert_close(last, pow(1e14, -1.5), 1e-5, "O7 rate");
    assert_close(result.mean_slip, 4.88072937 * def.dc, 1e-6, "O7 slip");
    history_clear(&h);
}

// O8: m < 1 goes to steady sliding exponentially, from either side.
static void approach_to_steady_sliding(void **state)
{
    const double starts[] = {0.5, 2.0};
    for (size_t s = 0; s < 2; s++) {
        double m = 0.6;
        block_def def = block_default(m, starts[s]);
        def.formulation = chosen(state);
        lac_run_def how = lac_run_default();
        how.rtol = 1e-11;
        how.end = 25.0;
        how.failure_rate = 1e3;
        history h = {0};
        lac_run_result result = run(&def, &how, &h);
        assert_false(result.failed);
        size_t first = 0;
        size_t last = 0;
        for (size_t i = 0; i < h.n; i++) {
            double off = fabs(log(h.line[i].observation.mean_rate));
            first = off > 3e-3 ? i : first;
            last = off > 3e-4 ? i : last;
        }
        double decay = log(log(h.line[first].observation.mean_rate) /
                           log(h.line[last].observation.mean_rate)) /
                       (history_time(&h, last) - history_time(&h, first));
        assert_close(decay, (1.0 - m) / block_steady_state(&def), 5e-3, "O8");
        history_clear(&h);
    }
}

// The four quadrants: only m > 1 with x < 1 fails.
static void quadrants(void **state)
{
    const double m[] = {0.7, 0.7, 1.4, 1.4};
    const double x[] = {0.6, 1.5, 0.6, 1.5};
    for (size_t i = 0; i < 4; i++) {
        block_def def = block_default(m[i], x[i]);
        def.formulation = chosen(state);
        lac_run_def how = to_failure(1e-8, 1e6);
        how.end = 1e4;
        history h = {0};
        lac_run_result result = run(&def, &how, &h);
        assert_int_equal(result.failed, i == 2);
        double last = h.line[h.n - 1].observation.mean_rate;
        if (i < 2) {
            assert_close(last, block_steady_rate(&def), 1e-6, "steady");
        } else if (i == 3) {
            assert_true(last < 1e-4);
        }
        history_clear(&h);
    }
}

// A load given by a function of time, for the tests.
typedef struct callback {
    double (*ratio)(double t);
    double (*rate)(double t);
    double jump_time;
} callback;

static void add_callback(const lac_load *load, double t, lac_load_state *sum)
{
    const callback *c = load->params;
    sum->ratio += c->ratio(t);
    sum->ratio_rate += c->rate(t);
}

static double callback_break(const lac_load *load, double t)
{
    const callback *c = load->params;
    return t < c->jump_time ? c->jump_time : INFINITY;
}

static const lac_load_kind callback_kind = {
    .info = {.name = "callback"}, .add = add_callback, .next_break = callback_break};

static double drive(double t) { return 1.1 + 0.3 * sin(t); }
static double driven_ratio(double t) { return 0.01 * log(drive(t)); }
static double driven_rate(double t) { return 0.01 * 0.3 * cos(t) / drive(t); }

// A block with m = 1 and dc = v0 = 1 that starts with theta = 2 under S = drive: v = S/theta.
static void create_driven(const lac_model *model, double start_drive, lac_formulation formulation,
                          block *b)
{
    block_def def = block_default(1.0, 1.0);
    lac_error err;
    block_create(&def, b);
    lac_problem_free(b->problem);
    lac_load_set_clear(&b->loads);
    b->loads = test_load_set(&(lac_load_models){.shear = model, .shear_count = 1});
    double u = log(start_drive / 2.0);
    double w = log(2.0);
    lac_problem_def problem = {.domain = b->domain,
                               .friction = b->friction,
                               .transfer = &b->transfer,
                               .loads = b->loads,
                               .log_rate = &u,
                               .log_state = &w,
                               .formulation = formulation};
    assert_int_equal(lac_problem_create(&problem, &b->problem, &err), LAC_OK);
}

// O9: m = 1 under any drive S(t): theta = theta_i + t - integral of S.
static void driven_block(void **state)
{
    callback c = {driven_ratio, driven_rate, INFINITY};
    lac_model model = {.info = &callback_kind.info, .params = &c};
    block b;
    lac_error err;
    lac_run_result result;
    create_driven(&model, drive(0.0), chosen(state), &b);
    history h = {0};
    lac_sink sink = history_sink(&h);
    lac_run_def how = to_failure(1e-11, 1e8);
    assert_int_equal(lac_run(b.problem, &how, &sink, &result, &err), LAC_OK);
    assert_true(result.failed);
    assert_close(result.failure_origin + result.failure_local, 14.908571437, 1e-8, "O9");
    for (size_t i = 0; i < h.n && h.line[i].observation.mean_rate < 1e3; i++) {
        double t = history_time(&h, i);
        double theta = 2.0 - 0.1 * t - 0.3 * (1.0 - cos(t));
        assert_close(h.line[i].observation.mean_rate, drive(t) / theta, 1e-5, "O9 rate");
    }
    history_clear(&h);
    block_clear(&b);
}

// A ramp that starts at 1 s and ends at 2 s, ln S from 0 to 1/2: theta stays 2, then bends twice.
static void ramped_block(void **state)
{
    lac_model model = test_slot_shear("ramp");
    test_slot_set(&model, "rate", 5e3);
    test_slot_set(&model, "start", 1.0);
    test_slot_set(&model, "end", 2.0);
    block b;
    lac_error err;
    lac_run_result result;
    create_driven(&model, 1.0, chosen(state), &b);
    history h = {0};
    lac_sink sink = history_sink(&h);
    lac_run_def how = to_failure(1e-10, 1e8);
    assert_int_equal(lac_run(b.problem, &how, &sink, &result, &err), LAC_OK);
    assert_true(result.failed && result.restarts >= 2);
    double after = 3.0 - 2.0 * expm1(0.5); // theta at 2 s
    assert_close(result.time, 2.0 + after / expm1(0.5), 1e-7, "ramp");
    for (size_t i = 0; i < h.n; i++) {
        double t = history_time(&h, i);
        if (t <= 1.0) {
            assert_close(h.line[i].observation.mean_rate, 0.5, 1e-9, "before the ramp");
        } else if (t <= 2.0) {
            double theta = 2.0 + (t - 1.0) - 2.0 * expm1(0.5 * (t - 1.0));
            assert_close(h.line[i].observation.mean_rate, exp(0.5 * (t - 1.0)) / theta, 1e-6,
                         "ramp");
        }
    }
    history_clear(&h);
    lac_model_clear(&model);
    block_clear(&b);
}

static const double jump_at = 1.0;
static double jump_size;
static double jumping_ratio(double t) { return t < jump_at ? 0.0 : jump_size; }
static double no_rate(double t)
{
    (void)t;
    return 0.0;
}

// O10: a step of the load divides x by exp(step/(b-a)); it triggers failure iff x falls below 1.
static void load_step(void **state)
{
    const double m = 1.5;
    callback c = {jumping_ratio, no_rate, jump_at};
    lac_model model = {.info = &callback_kind.info, .params = &c};
    block_def def = block_default(m, 1.3);
    def.formulation = chosen(state);
    def.shear = &model;
    def.shear_count = 1;

    // x at the step, by bisection on the exact time.
    double low = def.x;
    double high = 10.0;
    for (int i = 0; i < 100; i++) {
        double x = 0.5 * (low + high);
        if (aging_time(m, def.x, x) * block_steady_state(&def) < jump_at) {
            low = x;
        } else {
            high = x;
        }
    }
    double threshold = (def.b - def.a) * log(low);
    const double factors[] = {0.9, 0.99, 1.01, 1.1};
    for (size_t i = 0; i < 4; i++) {
        jump_size = factors[i] * threshold;
        lac_run_def how = to_failure(1e-10, 1e6);
        how.end = 1e6;
        history h = {0};
        lac_run_result result = run(&def, &how, &h);
        assert_int_equal(result.failed, factors[i] > 1.0);
        if (result.failed) {
            double scale = exp(jump_size / (def.b - def.a));
            double steady = block_steady_state(&def) * scale;
            double x_f = pow(1e6 * steady / def.dc, -1.0 / m);
            double tc = jump_at + steady * aging_time(m, low / scale, x_f);
            assert_close(result.failure_origin + result.failure_local, tc, 1e-6, "O10");
        }
        history_clear(&h);
    }
}

// O11: the slip law.
static void slip_law(void **state)
{
    const double table[][3] = {{1.3, 0.2, 0.919294157325}, {2.0, 0.5, 0.219383934396}};
    for (size_t i = 0; i < 2; i++) {
        double m = table[i][0];
        double phi = table[i][1];
        block_def def = block_default(m, exp(-phi / (m - 1.0)));
        def.formulation = chosen(state);
        def.law = "slip";
        double exponent = m / (m - 1.0);
        double v_f = 1e5;
        double phi_f = log(v_f) / exponent;
        double rest = gsl_sf_expint_E1(exponent * phi_f) / (m - 1.0);
        lac_run_def how = to_failure(1e-10, v_f);
        history h = {0};
        lac_run_result result = run(&def, &how, &h);
        assert_true(result.failed);
        assert_close(result.failure_origin + result.failure_local + rest, table[i][2], 1e-6, "O11");
        for (size_t k = 0; k < h.n; k++) {
            double now = log(h.line[k].observation.mean_rate) / exponent;
            double want = phi * exp((m - 1.0) * h.line[k].observation.mean_slip / def.dc);
            assert_close(now, want, 1e-6, "O11 phi");
        }
        history_clear(&h);
    }
}

// O12: radiation damping has no singularity: -sigma a/v + eta ln v grows as (sigma b/dc) t.
static void damped(void **state)
{
    block_def def = block_default(3.0, 1e-4); // theta v/dc = 1e8: healing stays negligible
    def.formulation = chosen(state);
    def.slip_rate = 1.0;
    def.damping = 1e3; // v_c = a sigma/eta = 10 m/s
    lac_run_def how = to_failure(1e-10, 200.0);
    history h = {0};
    lac_run_result result = run(&def, &how, &h);
    assert_true(result.failed);
    double slope = def.pressure * def.b / def.dc;
    const lac_record *end = &h.line[h.n - 1];
    double v_end = end->observation.mean_rate;
    double reference = -def.pressure * def.a / v_end + def.damping * log(v_end);
    for (size_t i = 0; i + 1 < h.n; i++) {
        double v = h.line[i].observation.mean_rate;
        double dt =
            (end->time_origin - h.line[i].time_origin) + (end->time_local - h.line[i].time_local);
        double now = -def.pressure * def.a / v + def.damping * log(v);
        assert_true(fabs(reference - now - slope * dt) < 1e-6 * (reference - now) + 1e-3);
    }
    assert_true(h.n > 100);
    history_clear(&h);
}

int main(void)
{
    gsl_set_error_handler_off();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quadrature_meets_the_published_numbers),
        FOR_EACH_FORMULATION(time_of_failure),
        FOR_EACH_FORMULATION(slip_and_rate_along_the_run),
        FOR_EACH_FORMULATION(lambert),
        FOR_EACH_FORMULATION(approach_to_failure),
        FOR_EACH_FORMULATION(relaxation),
        FOR_EACH_FORMULATION(approach_to_steady_sliding),
        FOR_EACH_FORMULATION(quadrants),
        FOR_EACH_FORMULATION(driven_block),
        FOR_EACH_FORMULATION(ramped_block),
        FOR_EACH_FORMULATION(load_step),
        FOR_EACH_FORMULATION(slip_law),
        FOR_EACH_FORMULATION(damped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
