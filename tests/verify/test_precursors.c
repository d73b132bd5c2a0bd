// SPDX-License-Identifier: GPL-3.0-or-later
// Indicators of catalogues and series whose numbers are known.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "lacuna/precursor.h"

enum { N = 5000, CATALOGUES = 40 };

static double magnitude[N];

static double uniform(uint64_t a, uint64_t b)
{
    return lac_random_uniform(17, LAC_STREAM_TEST, a, b);
}

// Magnitudes from `least` on with 10^(-b M).
static void draw(uint64_t catalogue, size_t n, double b, double least)
{
    for (size_t i = 0; i < n; i++) {
        magnitude[i] = least - log10(uniform(catalogue, i)) / b;
    }
}

static void b_values_are_found(void **state)
{
    (void)state;
    static const double known[] = {0.7, 1.0, 1.5};
    for (size_t k = 0; k < 3; k++) {
        double mean = 0.0;
        double positive = 0.0;
        double square = 0.0;
        double errors = 0.0;
        for (uint64_t c = 0; c < CATALOGUES; c++) {
            double error = 0.0;
            size_t used = 0;
            draw(c, N, known[k], 2.0);
            const double b = lac_b_value(N, magnitude, 2.0, 0.0, &error, &used);
            assert_int_equal(used, N);
            mean += b / CATALOGUES;
            square += (b - known[k]) * (b - known[k]) / CATALOGUES;
            errors += error / CATALOGUES;
            positive += lac_b_positive(N, magnitude, 0.2, &error, &used) / CATALOGUES;
        }
        assert_true(fabs(mean - known[k]) < 0.02);
        assert_true(fabs(positive - known[k]) < 0.02);
        assert_true(fabs(sqrt(square) / errors - 1.0) < 0.3); // the error is what is scattered
    }
}

// Rounded to tenths, as catalogues are: the correction of half a bin.
static void rounding_is_corrected(void **state)
{
    (void)state;
    double mean = 0.0;
    double plain = 0.0;
    for (uint64_t c = 0; c < CATALOGUES; c++) {
        double error = 0.0;
        size_t used = 0;
        draw(c, N, 1.0, 1.95);
        for (size_t i = 0; i < N; i++) {
            magnitude[i] = 0.1 * floor(10.0 * magnitude[i] + 0.5);
        }
        mean += lac_b_value(N, magnitude, 2.0, 0.1, &error, &used) / CATALOGUES;
        plain += lac_b_value(N, magnitude, 2.0, 0.0, &error, &used) / CATALOGUES;
    }
    assert_true(fabs(mean - 1.0) < 0.02);
    assert_true(fabs(plain - 1.0) > 0.05);
}

// After each large event small ones are missed for a while, as much as it is larger: b-positive
// does not mind, the plain one does.
static void incompleteness_is_borne(void **state)
{
    (void)state;
    double plain = 0.0;
    double positive = 0.0;
    static double seen[4 * N];
    for (uint64_t c = 0; c < CATALOGUES; c++) {
        double error = 0.0;
        size_t used = 0;
        size_t n = 0;
        double veil = 0.0;
        for (size_t i = 0; n < N && i < 4 * (size_t)N; i++) {
            const double m = -log10(uniform(c, i)) / 1.0;
            const double wait = -log(uniform(c + CATALOGUES, i)) * (i < 2 * (size_t)N ? 1.0 : 0.2);
            veil = fmax(0.0, veil - 0.05 * wait); // the rate changes in the middle
            if (m >= veil) {
                seen[n++] = m;
                veil = fmax(veil, m - 0.2);
            }
        }
        plain += lac_b_value(n, seen, 0.0, 0.0, &error, &used) / CATALOGUES;
        positive += lac_b_positive(n, seen, 0.2, &error, &used) / CATALOGUES;
    }
    assert_true(fabs(plain - 1.0) > 0.1);
    assert_true(fabs(positive - 1.0) < 0.02);
}

static void tau_counts_pairs(void **state)
{
    (void)state;
    const double rising[] = {1, 2, 3, 4}, mixed[] = {1, 3, 2, 4}, tied[] = {1, 1, 1, 1};
    assert_true(lac_kendall(4, rising) == 1.0);
    assert_true(fabs(lac_kendall(4, mixed) - 4.0 / 6.0) < 1e-15);
    assert_true(lac_kendall(4, tied) == 0.0);
    assert_true(isnan(lac_kendall(1, rising)));
}

// White and red noise with no trend: p below 0.05 in one of twenty.
static void surrogates_are_fair(void **state)
{
    (void)state;
    enum { LENGTH = 60, TRIALS = 2000, SURROGATES = 59 };
    static const double phis[] = {0.0, 0.9};
    for (size_t k = 0; k < 2; k++) {
        size_t alarms[2] = {0, 0};
        for (uint64_t trial = 0; trial < TRIALS; trial++) {
            double x[LENGTH], pair[2];
            lac_slowing slowing;
            for (size_t i = 0; i < LENGTH; i++) {
                lac_random_normal(23 + k, LAC_STREAM_TEST, trial, i, pair);
                x[i] =
                    i == 0 ? pair[0] / sqrt(1 - phis[k] * phis[k]) : phis[k] * x[i - 1] + pair[0];
            }
            assert_int_equal(lac_slowing_measure(LENGTH, x, trial, SURROGATES, &slowing, NULL),
                             LAC_OK);
            alarms[0] += slowing.variance_p <= 0.05 ? 1 : 0;
            alarms[1] += slowing.autocorrelation_p <= 0.05 ? 1 : 0;
        }
        // 5 % and one to either side
        for (size_t i = 0; i < 2; i++) {
            print_message("phi %.1f: %zu of %d\n", phis[k], alarms[i], (int)TRIALS);
            assert_true(alarms[i] >= 80 && alarms[i] <= 120);
        }
    }
}

// An autoregression whose memory grows: both indicators rise above their surrogates.
static void slowing_is_seen(void **state)
{
    (void)state;
    enum { LENGTH = 200 };
    size_t seen[2] = {0, 0};
    for (uint64_t trial = 0; trial < 20; trial++) {
        double x[LENGTH], pair[2];
        lac_slowing slowing;
        for (size_t i = 0; i < LENGTH; i++) {
            const double phi = 0.1 + 0.85 * (double)i / LENGTH;
            lac_random_normal(29, LAC_STREAM_TEST, trial, i, pair);
            x[i] = (i == 0 ? 0.0 : phi * x[i - 1]) + pair[0];
        }
        (void)lac_slowing_measure(LENGTH, x, 1, 99, &slowing, NULL);
        seen[0] += slowing.variance_p <= 0.05 ? 1 : 0;
        seen[1] += slowing.autocorrelation_p <= 0.05 ? 1 : 0;
    }
    print_message("seen %zu and %zu of 20\n", seen[0], seen[1]);
    assert_true(seen[0] >= 8 && seen[1] >= 15);
}

static const lac_finding *find(const lac_precursor *all, size_t count, const char *name)
{
    for (size_t k = 0; k < count; k++) {
        if (strcmp(all[k].kind->about.name, name) == 0) {
            return &all[k].found;
        }
    }
    fail_msg("no indicator %s", name);
    return NULL;
}

static double value(const lac_finding *found, const char *key)
{
    for (size_t i = 0; i < found->count; i++) {
        if (strcmp(found->value[i].key, key) == 0) {
            return found->value[i].value;
        }
    }
    fail_msg("no value %s: %s", key, found->reason);
    return NAN;
}

// Events as (tc - t)^-p, an oscillating motion, clusters that grow as (tc - t)^-0.7.
static void rates_lengths_and_oscillations_are_found(void **state)
{
    (void)state;
    enum { READINGS = 150, LEVELS = 3, EVENTS = 2000 };
    static double time[READINGS], displacement[READINGS], length[READINGS], sigma[READINGS];
    static double n_slip[READINGS * LEVELS], event_time[EVENTS], moment[EVENTS];
    const double n_tot[LEVELS] = {64, 16, 4};
    const double tc = 100.0, now = 98.0, p = 0.8;
    for (size_t i = 0; i < READINGS; i++) {
        time[i] = now * (double)i / (READINGS - 1);
        const double left = tc - time[i];
        displacement[i] = -log(left) + 0.01 * cos(9.0 * log(left));
        length[i] = 3.0 * pow(left, -0.7);
        n_slip[i * LEVELS] = (double)(i % 64);
        n_slip[i * LEVELS + 1] = 4;
        n_slip[i * LEVELS + 2] = 1;
    }
    for (size_t i = 0; i < EVENTS; i++) { // the i-th quantile of s^-p on [tc - now, tc]
        const double part = ((double)i + 0.5) / EVENTS;
        const double high = pow(tc, 1 - p);
        const double low = pow(tc - now, 1 - p);
        event_time[i] = tc - pow(high - part * (high - low), 1 / (1 - p));
        moment[i] = i % 2 == 0 ? 1e9 : 3e9;
    }
    lac_motion motion = {.n = READINGS, .time = time, .displacement = displacement, .sigma = sigma};
    const lac_event_list events = {EVENTS, event_time, moment};
    const lac_slip_history slip = {READINGS, LEVELS, time, n_slip, n_tot, length, 0.6};
    const lac_observed seen = {&motion, &events, &slip, tc, 0.0, 1, 59};
    lac_precursor out[LAC_PRECURSORS_MAX];
    size_t count = 0;
    assert_int_equal(lac_precursors_look(&seen, out, &count, NULL), LAC_OK);
    const lac_finding *rate = find(out, count, "event_rate");
    assert_true(fabs(value(rate, "p") - p) < 0.01);
    assert_true(value(rate, "p_error") > 0.005 && value(rate, "p_error") < 0.1);
    const lac_finding *longest = find(out, count, "correlation_length");
    assert_true(fabs(value(longest, "growth_exponent") - 0.7) < 1e-9);
    const lac_finding *waves = find(out, count, "log_periodicity");
    assert_true(fabs(value(waves, "omega") - 9.0) < 0.3);
    assert_true(value(waves, "p") < 0.03 && value(waves, "power") > 0.9);
    const lac_finding *fraction = find(out, count, "slip_fraction");
    assert_true(value(fraction, "slip_fraction") == 21.0 / 64.0);
    assert_true(fabs(value(fraction, "distance") - (0.6 - 21.0 / 64.0)) < 1e-15);
    assert_true(value(fraction, "level_1") == 0.25);
    assert_true(fabs(value(find(out, count, "moment"), "moment_N_m") - 4e12) < 1.0);
    assert_true(find(out, count, "slowing")->reason[0] != '\0'); // no velocities
}

static void what_is_not_there_is_said(void **state)
{
    (void)state;
    double none = 0.0;
    lac_motion motion = {.n = 1, .time = &none, .displacement = &none, .sigma = &none};
    const lac_event_list events = {0, &none, &none};
    const lac_slip_history slip = {.n = 0};
    const lac_observed series = {&motion, NULL, NULL, NAN, NAN, 1, 19};
    const lac_observed run = {&motion, &events, &slip, NAN, NAN, 1, 19};
    lac_precursor out[LAC_PRECURSORS_MAX];
    size_t count = 0;
    assert_int_equal(lac_precursors_look(&series, out, &count, NULL), LAC_OK);
    for (size_t k = 0; k < count; k++) {
        assert_true(out[k].found.reason[0] != '\0' && out[k].kind->estimator[0] != '\0');
        assert_true((out[k].kind->needs == LAC_NEEDS_EVENTS) ==
                    (strstr(out[k].found.reason, "needs a catalogue") != NULL));
    }
    assert_int_equal(lac_precursors_look(&run, out, &count, NULL), LAC_OK);
    for (size_t k = 0; k < count; k++) {
        assert_true(out[k].found.reason[0] != '\0');
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(b_values_are_found),
        cmocka_unit_test(rounding_is_corrected),
        cmocka_unit_test(incompleteness_is_borne),
        cmocka_unit_test(tau_counts_pairs),
        cmocka_unit_test(surrogates_are_fair),
        cmocka_unit_test(slowing_is_seen),
        cmocka_unit_test(rates_lengths_and_oscillations_are_found),
        cmocka_unit_test(what_is_not_there_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
