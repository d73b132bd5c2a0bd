// SPDX-License-Identifier: GPL-3.0-or-later
// The ensemble sampler on densities whose moments are known, and the measures of its convergence.
#include <stdio.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fit/sampler.h"
#include "support/test.h"

// Normal in two dimensions: means 1 and -2, deviations 0.01 and 100, correlation 0.95.
static double normal(void *context, int thread, const double *x)
{
    (void)context, (void)thread;
    double a = (x[0] - 1.0) / 0.01;
    double b = (x[1] + 2.0) / 100.0;
    return -0.5 * (a * a - 1.9 * a * b + b * b) / (1.0 - 0.95 * 0.95);
}

// A bent normal: x standard, y = x^2 + normal/4; so E y = 1, var y = 2 + 1/16.
static double banana(void *context, int thread, const double *x)
{
    (void)context, (void)thread;
    double b = 4.0 * (x[1] - x[0] * x[0]);
    return -0.5 * (x[0] * x[0] + b * b);
}

static double half_plane(void *context, int thread, const double *x)
{
    return x[0] < 0.0 ? NAN : banana(context, thread, x);
}

static lac_chain *sample(double (*density)(void *, int, const double *), int threads, size_t steps,
                         double drawing, double stretching)
{
    enum { WALKERS = 20 };
    double start[WALKERS * 2];
    lac_chain *chain = NULL;
    lac_error err = {""};
    lac_sampler_def def = {.dimension = 2,
                           .walkers = WALKERS,
                           .steps = steps,
                           .burn = 500,
                           .drawing = drawing,
                           .stretching = stretching,
                           .seed = 7,
                           .threads = threads,
                           .log_density = density};
    for (size_t k = 0; k < WALKERS; k++) {
        start[2 * k] = 0.8 + 0.3 * lac_random_uniform(3, LAC_STREAM_TEST, k, 0);
        start[2 * k + 1] = lac_random_uniform(3, LAC_STREAM_TEST, k, 1);
    }
    if (lac_sampler_run(&def, start, &chain, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return chain;
}

static void moments(const lac_chain *chain, size_t k, double *mean, double *variance)
{
    size_t n = chain->walkers * chain->steps;
    *mean = *variance = 0.0;
    for (size_t i = 0; i < n; i++) {
        *mean += chain->x[i * chain->dimension + k] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        double d = chain->x[i * chain->dimension + k] - *mean;
        *variance += d * d / (double)n;
    }
}

// Within four standard errors, from the effective sample size, which is checked to be sensible.
static void check(const lac_chain *chain, size_t k, double mean, double variance, double kurtosis)
{
    double got[2];
    lac_convergence c;
    lac_error err;
    assert_int_equal(lac_chain_converged(chain, k, &c, &err), LAC_OK);
    moments(chain, k, &got[0], &got[1]);
    double n = (double)(chain->walkers * chain->steps);
    if (!(c.rhat < 1.08 && c.ess > 150.0 && c.ess <= n)) {
        fail_msg("coordinate %zu: R-hat %g, ESS %g of %g", k, c.rhat, c.ess, n);
    }
    if (fabs(got[0] - mean) > 4.0 * sqrt(variance / c.ess) ||
        fabs(got[1] / variance - 1.0) > 4.0 * sqrt((kurtosis - 1.0) / c.ess)) {
        fail_msg("coordinate %zu: mean %g (%g), variance %g (%g), ESS %g", k, got[0], mean, got[1],
                 variance, c.ess);
    }
}

static void known_moments(void **state)
{
    (void)state;
    const double shares[][2] = {{0.0, 1.0}, {0.0, 0.5}, {0.0, 0.0}, {1.0, 0.0}, {0.7, 0.15}};
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        lac_chain *chain = sample(normal, 1, 2000, shares[i][0], shares[i][1]);
        check(chain, 0, 1.0, 1e-4, 3.0);
        check(chain, 1, -2.0, 1e4, 3.0);
        lac_chain_free(chain);
        chain = sample(banana, 1, 4000, shares[i][0], shares[i][1]);
        check(chain, 0, 0.0, 1.0, 3.0);
        check(chain, 1, 1.0, 2.0625, 14.5);
        lac_chain_free(chain);
    }
}

// Half of the banana: |x| in place of x, E |x| = sqrt(2/pi); NaN is no density.
static void walls(void **state)
{
    (void)state;
    lac_chain *chain = sample(half_plane, 1, 2000, 0.7, 0.15);
    check(chain, 0, sqrt(2.0 / acos(-1.0)), 1.0 - 2.0 / acos(-1.0), 3.87);
    for (size_t i = 0; i < chain->walkers * chain->steps; i++) {
        assert_true(chain->x[2 * i] >= 0.0);
    }
    lac_chain_free(chain);
}

static void any_number_of_threads(void **state)
{
    (void)state;
    lac_chain *one = sample(banana, 1, 50, 0.7, 0.15);
    lac_chain *three = sample(banana, 3, 50, 0.7, 0.15);
    size_t n = one->walkers * one->steps;
    assert_memory_equal(one->x, three->x, 2 * n * sizeof *one->x);
    assert_memory_equal(one->log_density, three->log_density, n * sizeof *one->log_density);
    assert_memory_equal(one->acceptance, three->acceptance, one->walkers * sizeof(double));
    lac_chain_free(one);
    lac_chain_free(three);
}

// A chain of which everything is known: first-order autoregressive, x_i = 0.9 x_(i-1) + e, whose
// time is (1 + 0.9)/(1 - 0.9) = 19; with walkers apart or of different spread R-hat rises.
static lac_chain *autoregressive(double apart, double wider)
{
    enum { WALKERS = 8, STEPS = 6000 };
    lac_chain *chain = malloc(sizeof *chain + WALKERS * STEPS * sizeof *chain->x);
    *chain = (lac_chain){.dimension = 1, .walkers = WALKERS, .steps = STEPS};
    chain->x = (double *)(chain + 1);
    for (size_t k = 0; k < WALKERS; k++) {
        double x = 0.0;
        for (size_t i = 0; i < STEPS; i++) {
            double e[2];
            lac_random_normal(11, LAC_STREAM_TEST, k, i, e);
            x = 0.9 * x + sqrt(1.0 - 0.81) * e[0];
            chain->x[i * WALKERS + k] = (k == 0 ? apart : 0.0) + (k == 0 ? wider : 1.0) * x;
        }
    }
    return chain;
}

static void convergence(void **state)
{
    (void)state;
    lac_error err;
    lac_convergence c;
    const double cases[][2] = {{0.0, 1.0}, {3.0, 1.0}, {0.0, 20.0}};
    for (size_t i = 0; i < 3; i++) {
        lac_chain *chain = autoregressive(cases[i][0], cases[i][1]);
        assert_int_equal(lac_chain_converged(chain, 0, &c, &err), LAC_OK);
        if (i == 0) {
            assert_true(c.rhat < 1.01);
            assert_true(fabs(c.time / 19.0 - 1.0) < 0.3);
        } else {
            assert_true(c.rhat > 1.05); // the second only by the folded draws
        }
        lac_chain_free(chain);
    }
}

static bool stop(void *context) { return ++*(int *)context > 10; }

static void refusals(void **state)
{
    (void)state;
    lac_chain *chain = NULL;
    lac_error err;
    int asked = 0;
    double start[12] = {0.1, 0.2, 0.3, 0.1, 0.5, 0.9, 0.2, 0.8, 0.7, 0.4, 0.6, 0.35};
    lac_sampler_def def = {.dimension = 2, .walkers = 5, .steps = 20, .log_density = banana};
    assert_int_equal(lac_sampler_run(&def, start, &chain, &err), LAC_EINPUT);
    assert_null(chain);
    def.walkers = 4;
    assert_int_equal(lac_sampler_run(&def, start, &chain, &err), LAC_EINPUT);
    def.walkers = 6;
    start[4] = -1.0;
    def.log_density = half_plane;
    assert_int_equal(lac_sampler_run(&def, start, &chain, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "walker 2"));
    def.log_density = banana;
    def.watch = &(lac_fit_watch){.interrupted = stop, .context = &asked};
    assert_int_equal(lac_sampler_run(&def, start, &chain, &err), LAC_EINTERRUPT);
    assert_int_equal(chain->steps, 11);
    lac_chain_free(chain);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_moments),
        cmocka_unit_test(walls),
        cmocka_unit_test(any_number_of_threads),
        cmocka_unit_test(convergence),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
