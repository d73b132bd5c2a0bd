// SPDX-License-Identifier: GPL-3.0-or-later
// Fits of one block, from a case in memory to the result: the likelihood against a dense normal one
// over an exact solution, the least squares against parameters that are known.
#include <stdio.h>

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_sf_lambert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fit/fit.h"
#include "support/test.h"

enum { READINGS = 24 };

static const double day = 86400.0;

// m = 2; a start at 0.8 theta_ss.
static const char head[] =
    "lacuna: 1\n"
    "load: {normal: {pressure: \"1 MPa\"}}\n"
    "friction: {aging: {f0: 0.6, a: 0.010, b: 0.020, dc: \"0.1 m\", v0: \"1 um/s\"}}\n"
    "initial: {slip_rate: \"2 mm/day\", state: {ratio_to_steady: 0.8}}\n"
    "time: {end: \"400 day\"}\n";

// With a step of the shear load on day 15.
static const char stepped[] =
    "lacuna: 1\n"
    "load: {normal: {pressure: \"1 MPa\"}, shear: [{step: {value: \"2 kPa\", at: \"15 day\"}}]}\n"
    "friction: {aging: {f0: 0.6, a: 0.020, b: 0.010, dc: \"1 mm\", v0: \"1 um/s\"}}\n"
    "initial: {slip_rate: \"2 mm/day\", state: {ratio_to_steady: 1}}\n"
    "time: {end: \"400 day\"}\n";

static lac_case *read_case(const char *tail)
{
    char text[4096];
    lac_case *c = NULL;
    lac_case_issues report;
    lac_error err = {""};
    const lac_case_request how = {LAC_FOR_FIT, NULL, 0};
    (void)snprintf(text, sizeof text, "%s%s", tail[0] == '#' ? stepped : head, tail);
    lac_status status =
        lac_case_read_text("case.yaml", text, strlen(text), &how, &c, &report, &err);
    lac_case_issues_clear(&report);
    if (status != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return c;
}

// Readings at uneven times, in memory.
typedef struct readings {
    double time[READINGS], displacement[READINGS], velocity[READINGS], sigma[READINGS];
    size_t line[READINGS];
    lac_series series;
} readings;

static double exact_slip(double dc, double rate, double x, double t)
{
    double scale = dc / (rate * x * x);
    double now = 1.0 + gsl_sf_lambert_W0(-exp(x + log(1.0 - x) + t / scale - 1.0));
    return dc * log((1.0 / now - 1.0) / (1.0 / x - 1.0));
}

static void make_readings(readings *r, double dc, double rate, double x, double noise,
                          uint64_t seed)
{
    *r = (readings){0};
    for (size_t i = 0; i < READINGS; i++) {
        double e[2];
        lac_random_normal(seed, LAC_STREAM_TEST, i, 0, e);
        r->time[i] = day * (2.0 * (double)i + 0.7 * sin((double)(i * i)) + 1.0);
        r->displacement[i] = 0.05 + exact_slip(dc, rate, x, r->time[i]) + noise * e[0];
        r->velocity[i] = NAN;
        r->sigma[i] = 1e-3 * (1.0 + 0.5 * sin((double)i));
        r->line[i] = i + 2;
    }
    r->series = (lac_series){.n = READINGS,
                             .time = r->time,
                             .displacement = r->displacement,
                             .value = r->sigma,
                             .line = r->line};
}

static lac_fit *make_fit(const lac_case *c, const readings *r)
{
    lac_fit *fit = NULL;
    lac_error err = {""};
    if (lac_fit_create(c, &r->series, 1, &fit, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return fit;
}

// ln of a normal density with covariance C + K 1 1^T, K so large that the offset is free, less what
// K alone adds: -ln(2 pi K)/2.
static double dense_likelihood(size_t n, gsl_matrix *c, const double *residual)
{
    const double wide = 100.0;
    const double two_pi = 2.0 * acos(-1.0);
    gsl_vector *solved = gsl_vector_alloc(n);
    gsl_vector_const_view r = gsl_vector_const_view_array(residual, n);
    double sum = 0.0;
    gsl_matrix_add_constant(c, wide);
    assert_int_equal(gsl_linalg_cholesky_decomp1(c), 0);
    assert_int_equal(gsl_linalg_cholesky_solve(c, &r.vector, solved), 0);
    for (size_t i = 0; i < n; i++) {
        sum -= 0.5 * residual[i] * gsl_vector_get(solved, i) + log(gsl_matrix_get(c, i, i)) +
               0.5 * log(two_pi);
    }
    gsl_vector_free(solved);
    return sum + 0.5 * log(two_pi * wide);
}

// Errors correlated in time, of an unknown size on a column of sigmas, a lognormal prior.
static void likelihood_is_normal(void **state)
{
    (void)state;
    readings r;
    lac_case *c = read_case("solver: {rtol: 1e-11}\n"
                            "fit: {parameters: {friction.aging.dc: {prior: {lognormal: {median: "
                            "\"0.2 m\", sigma: 0.7}}}, initial.slip_rate: {range: [\"1 mm/day\", "
                            "\"9 mm/day\"]}}, time: t, displacement: d, sigma: s, errors: ar1}\n");
    make_readings(&r, 0.12, 2.2e-3 / day, 0.8, 1e-3, 5);
    lac_fit *fit = make_fit(c, &r);
    const double dc = 0.11, rate = 2.1e-3 / day, factor = 1.7, tau = 3.0 * day;
    const double x[4] = {log(dc), log(rate), log(factor), log(tau)};
    gsl_matrix *covariance = gsl_matrix_alloc(READINGS, READINGS);
    double residual[READINGS];
    for (size_t i = 0; i < READINGS; i++) {
        residual[i] = r.displacement[i] - exact_slip(dc, rate, 0.8, r.time[i]);
        for (size_t j = 0; j < READINGS; j++) {
            gsl_matrix_set(covariance, i, j,
                           factor * factor * r.sigma[i] * r.sigma[j] *
                               exp(-fabs(r.time[i] - r.time[j]) / tau));
        }
    }
    double z = log(dc / 0.2) / 0.7;
    double want = dense_likelihood(READINGS, covariance, residual) - 0.5 * z * z;
    double got = lac_fit_log_posterior(fit, 0, x);
    if (!(fabs(got - want) < 2e-4)) { // the dense form loses digits to the wide offset
        fail_msg("ln posterior %.10g, expected %.10g", got, want);
    }
    const double outside[4] = {log(dc), log(0.5e-3 / day), log(factor), log(tau)};
    assert_true(lac_fit_log_posterior(fit, 0, outside) == -INFINITY);
    const double early[4] = {log(0.01), log(8e-3 / day), log(factor), log(tau)};
    assert_true(lac_fit_log_posterior(fit, 0, early) == -INFINITY);
    gsl_matrix_free(covariance);
    lac_fit_free(fit);
    lac_case_free(c);
}

static const char two[] = "fit: {parameters: {friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
                          "initial.slip_rate: {range: [\"0.5 mm/day\", \"10 mm/day\"]}}, time: t, "
                          "displacement: d, starts: 8, steps: 0}\n";

static void run_fit(const char *tail, const readings *r, lac_fit_result *result)
{
    lac_error err = {""};
    lac_case *c = read_case(tail);
    lac_fit *fit = make_fit(c, r);
    if (lac_fit_run(fit, NULL, result, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    for (size_t k = 0; k < result->unknowns; k++) { // their names go with the case
        result->unknown[k].key = NULL;
    }
    lac_fit_free(fit);
    lac_case_free(c);
}

// Twenty series with errors: the estimates scatter about the truth as their standard errors say.
static void least_squares_know_their_errors(void **state)
{
    (void)state;
    const int series = 20;
    double squares = 0.0;
    for (int i = 0; i < series; i++) {
        readings r;
        lac_fit_result result;
        double dc = 0.08 * exp(0.5 * lac_random_uniform(9, LAC_STREAM_TEST, (uint64_t)i, 0));
        double rate =
            2e-3 / day * (0.8 + 0.4 * lac_random_uniform(9, LAC_STREAM_TEST, (uint64_t)i, 1));
        make_readings(&r, dc, rate, 0.8, 1e-3, 100 + (uint64_t)i);
        run_fit(two, &r, &result);
        assert_int_equal(result.unknown[0].by, LAC_BY_SENSITIVITY);
        assert_true(result.displacement_rms < 1.6e-3 && result.displacement_rms > 0.5e-3);
        squares += pow(log(result.unknown[0].best / dc) / result.unknown[0].error, 2.0);
        squares += pow(log(result.unknown[1].best / rate) / result.unknown[1].error, 2.0);
        double fails = -0.8 - log(0.2);
        double tc = dc / (rate * 0.64) * fails;
        assert_true(fabs(result.failure - tc) < 4.0 * result.failure_error + 1e-4 * tc);
    }
    // chi-squared with 40 degrees of freedom: 1 in 1000 each way, errors from 22 degrees each
    assert_true(squares > 17.0 && squares < 90.0);
}

// How far the top of the posterior, as the sampler has it, lies from the best fit along one
// coordinate, over its width there.
static double off_the_top(lac_fit *fit, const double *best, size_t n, size_t k)
{
    double x[LAC_FIT_UNKNOWNS];
    double slope = 0.0;
    double bend = INFINITY;
    memcpy(x, best, n * sizeof *x);
    double top = lac_fit_log_posterior(fit, 0, x);
    for (double h = 0.1; !(bend * h * h < 0.1); h *= 0.5) { // to a third of the width
        x[k] = best[k] + h;
        double more = lac_fit_log_posterior(fit, 0, x);
        x[k] = best[k] - h;
        double less = lac_fit_log_posterior(fit, 0, x);
        bend = (2.0 * top - more - less) / (h * h);
        slope = (more - less) / (2.0 * h);
        assert_true(h > 1e-6);
    }
    assert_true(bend > 0.0);
    return fabs(slope) / sqrt(bend);
}

// Least squares go by the likelihood of the sampler, also where errors are correlated.
static void both_have_one_likelihood(void **state)
{
    (void)state;
    const char *errors[] = {"white", "ar1"};
    for (size_t i = 0; i < 2; i++) {
        char tail[600];
        double best[LAC_FIT_UNKNOWNS];
        double error = 0.0;
        readings r;
        lac_fit_result result;
        lac_error err = {""};
        make_readings(&r, 0.08, 2e-3 / day, 0.8, 0.0, 1);
        for (uint64_t k = 0; k < READINGS; k++) { // over some four days
            double e[2];
            lac_random_normal(21, LAC_STREAM_TEST, k, 0, e);
            error = (i == 1 ? 0.6 * error : 0.0) + 1e-3 * e[0];
            r.displacement[k] += error;
        }
        (void)snprintf(tail, sizeof tail,
                       "solver: {rtol: 1e-11}\n"
                       "fit: {parameters: {friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
                       "initial.slip_rate: {range: [\"0.5 mm/day\", \"10 mm/day\"]}}, time: t, "
                       "displacement: d, starts: 8, steps: 0, errors: %s}\n",
                       errors[i]);
        lac_case *c = read_case(tail);
        lac_fit *fit = make_fit(c, &r);
        assert_int_equal(lac_fit_run(fit, NULL, &result, &err), LAC_OK);
        assert_int_equal(result.unknowns, 3 + i);
        for (size_t k = 0; k < result.unknowns; k++) {
            best[k] = log(result.unknown[k].best);
        }
        for (size_t k = 0; k < result.unknowns; k++) {
            double off = off_the_top(fit, best, result.unknowns, k);
            if (!(off < 0.02)) {
                fail_msg("%s: %s is %g of its width off the top", errors[i], result.unknown[k].key,
                         off);
            }
        }
        // as many numbers as unknowns and the offset; the likelihood at the top of the offset
        double ln = lac_fit_log_posterior(fit, 0, best);
        assert_true(fabs(result.log_likelihood - ln) < 1e-3);
        assert_true(result.bic > (double)(4 + i) * log(READINGS) - 2.0 * ln - 20.0);
        lac_fit_free(fit);
        lac_case_free(c);
    }
}

// Without errors the truth itself comes back, from far away.
static void least_squares_find_the_truth(void **state)
{
    (void)state;
    readings r;
    lac_fit_result result;
    make_readings(&r, 0.07, 1.7e-3 / day, 0.8, 0.0, 1);
    run_fit(two, &r, &result);
    assert_true(fabs(result.unknown[0].best / 0.07 - 1.0) < 1e-4);
    assert_true(fabs(result.unknown[1].best / (1.7e-3 / day) - 1.0) < 1e-5);
    assert_true(fabs(result.offset - 0.05) < 1e-5);
    assert_true(result.displacement_rms < 1e-5);
}

// (m/dc)(1 - x^(m-1)) is known where dc and x are not.
static void the_combination_is_known(void **state)
{
    (void)state;
    readings r;
    lac_fit_result result;
    make_readings(&r, 0.2, 2e-3 / day, 0.8, 0.1e-3, 2);
    run_fit("fit: {parameters: {friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
            "initial.state.ratio_to_steady: {range: [0.3, 0.99]}, "
            "initial.slip_rate: {range: [\"0.5 mm/day\", \"10 mm/day\"]}}, time: t, "
            "displacement: d, starts: 8, steps: 300, burn: 150, rounds: 0, walkers: 20}\n",
            &r, &result);
    assert_true(result.one_block && result.sampled);
    double true_shape = 2.0 / 0.2 * (1.0 - 0.8);
    double of_dc = log(result.unknown[0].quantile[4] / result.unknown[0].quantile[0]);
    double of_shape = log(result.shape.quantile[4] / result.shape.quantile[0]);
    if (!(of_shape < 0.5 * of_dc)) {
        fail_msg("shape to %g, dc to %g; R-hat %g", of_shape, of_dc,
                 result.unknown[0].converged.rhat);
    }
    assert_true(result.shape.quantile[0] < true_shape && true_shape < result.shape.quantile[4]);
    assert_true(fabs(result.correlation[0][1]) > 0.8);
    assert_true(result.axis[0].sigma > result.axis[2].sigma);
}

// The sampler begins about the best fit as wide as the least squares know it: neither from one
// point, from which it would have to spread, nor from the ends of the ranges.
static void walkers_start_as_far_apart_as_the_errors(void **state)
{
    (void)state;
    enum { WALKERS = 60 };
    readings r;
    lac_fit_result result;
    lac_error err = {""};
    make_readings(&r, 0.08, 2e-3 / day, 0.8, 1e-3, 4);
    lac_case *c =
        read_case("fit: {parameters: {friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
                  "initial.slip_rate: {range: [\"0.5 mm/day\", \"10 mm/day\"]}}, time: t, "
                  "displacement: d, starts: 8, steps: 8, burn: 0, rounds: 0, walkers: 60}\n");
    lac_fit *fit = make_fit(c, &r);
    if (lac_fit_run(fit, NULL, &result, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    const size_t row = result.chain->dimension;
    for (size_t k = 0; k < 2; k++) {
        double squares = 0.0;
        for (size_t w = 0; w < WALKERS; w++) {
            squares += pow(result.chain->x[w * row + k] - log(result.unknown[k].best), 2.0);
        }
        double wide = sqrt(squares / WALKERS) / result.unknown[k].error;
        print_message("%zu: %.2f errors\n", k, wide);
        assert_true(wide > 0.5 && wide < 2.0);
    }
    lac_fit_free(fit);
    lac_case_free(c);
}

// When a load comes changes when it breaks: that derivative is by runs.
static void a_time_is_fitted_by_runs(void **state)
{
    (void)state;
    readings r;
    lac_fit_result result;
    make_readings(&r, 0.2, 1e-3 / day, 0.8, 0.0, 3);
    // A jump of the rate by exp(0.5) on day 20 of a block that creeps evenly, nearly so.
    for (size_t i = 0; i < READINGS; i++) {
        double t = r.time[i] / day;
        r.displacement[i] = 1e-3 * (t + (t > 20.0 ? (t - 20.0) * 0.6 : 0.0));
    }
    run_fit("#\nfit: {parameters: {load.shear.0.step.at: {range: [\"12 day\", \"30 day\"], prior: "
            "{uniform: {}}}, initial.slip_rate: {range: [\"0.1 mm/day\", \"3 mm/day\"]}}, time: t, "
            "displacement: d, starts: 16, steps: 0}\n",
            &r, &result);
    assert_int_equal(result.unknown[0].by, LAC_BY_RUNS);
    assert_int_equal(result.unknown[1].by, LAC_BY_SENSITIVITY);
}

// What a watcher was told, by stage.
typedef struct told {
    size_t stages, calls[4], done;
    const char *stage[4];
} told;

static void count_calls(void *context, const char *stage, size_t done, size_t total)
{
    told *t = context;
    if (t->stages == 0 || strcmp(t->stage[t->stages - 1], stage) != 0) {
        t->stage[t->stages++] = stage;
        t->done = 0;
    }
    assert_true(t->stages <= 4 && t->done <= done && done <= total);
    t->done = done;
    t->calls[t->stages - 1]++;
}

// Every run of the least squares, every step and every draw is told of: long ones show how far
// they are.
static void every_run_is_told_of(void **state)
{
    (void)state;
    static const char *const stages[] = {"starts tried", "least-squares descents",
                                         "steps of the sampler", "draws run on"};
    readings r;
    lac_fit_result result;
    make_readings(&r, 0.2, 2e-3 / day, 0.8, 0.1e-3, 2);
    for (int sampled = 0; sampled < 2; sampled++) {
        char tail[512];
        told t = {0};
        (void)snprintf(tail, sizeof tail,
                       "fit: {parameters: {friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
                       "initial.slip_rate: {range: [\"0.5 mm/day\", \"10 mm/day\"]}}, time: t, "
                       "displacement: d, starts: 8, steps: %d, burn: 5, rounds: 0, walkers: 10}\n",
                       sampled ? 10 : 0);
        lac_case *c = read_case(tail);
        lac_fit *fit = make_fit(c, &r);
        const lac_fit_watch watch = {.progress = count_calls, .context = &t};
        assert_int_equal(lac_fit_run(fit, &watch, &result, NULL), LAC_OK);
        assert_int_equal(t.stages, sampled ? 4 : 2);
        for (size_t i = 0; i < t.stages; i++) {
            assert_string_equal(t.stage[i], stages[i]);
        }
        assert_int_equal(t.calls[0], 8);
        if (sampled) {
            assert_int_equal(t.calls[2], 15);
            assert_int_equal(t.calls[3], result.draws);
        } else {
            assert_int_equal(t.calls[0] + t.calls[1] + 1, result.runs); // the one that judges
        }
        lac_fit_free(fit);
        lac_case_free(c);
    }
}

static void too_few_readings(void **state)
{
    (void)state;
    readings r;
    lac_error err = {""};
    lac_fit *fit = NULL;
    lac_case *c = read_case(two);
    make_readings(&r, 0.08, 2e-3 / day, 0.8, 0.0, 1);
    r.series.n = 4;
    assert_int_equal(lac_fit_create(c, &r.series, 1, &fit, &err), LAC_EINPUT);
    assert_null(fit);
    assert_non_null(strstr(err.message, "4 readings"));
    r.series.n = READINGS;
    r.series.dated = true;
    assert_int_equal(lac_fit_create(c, &r.series, 1, &fit, &err), LAC_EINPUT);
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(likelihood_is_normal),
        cmocka_unit_test(least_squares_find_the_truth),
        cmocka_unit_test(least_squares_know_their_errors),
        cmocka_unit_test(both_have_one_likelihood),
        cmocka_unit_test(the_combination_is_known),
        cmocka_unit_test(walkers_start_as_far_apart_as_the_errors),
        cmocka_unit_test(a_time_is_fitted_by_runs),
        cmocka_unit_test(every_run_is_told_of),
        cmocka_unit_test(too_few_readings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
