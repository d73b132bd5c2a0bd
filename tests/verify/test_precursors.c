// SPDX-License-Identifier: GPL-3.0-or-later
// Indicators of catalogues and series whose numbers are known.
#include <stdlib.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "precursor/precursor.h"
#include "support/test.h"

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
            const double b = lac_b_value(N, magnitude, 2.0, &error, &used);
            assert_int_equal(used, N);
            mean += b / CATALOGUES;
            square += (b - known[k]) * (b - known[k]) / CATALOGUES;
            errors += error / CATALOGUES;
            positive += lac_b_positive(N, magnitude, 0.2, &error, &used) / CATALOGUES;
        }
        print_message("b %.1f: %.4f, %.4f\n", known[k], mean, positive);
        assert_true(fabs(mean - known[k]) < 0.02);
        assert_true(fabs(positive - known[k]) < 0.02);
        assert_true(fabs(sqrt(square) / errors - 1.0) < 0.3); // the error is what is scattered
    }
}

// Differences 0.5, -0.3, 1: two count, by their mean; what comes after the n-th is not looked at.
static void positive_differences_are_counted(void **state)
{
    (void)state;
    const double listed[] = {1.0, 1.5, 1.2, 2.2, 9.0};
    double error = 0.0;
    size_t used = 0;
    const double b = lac_b_positive(4, listed, 0.2, &error, &used);
    assert_int_equal(used, 2);
    assert_true(fabs(b - 1.0 / (0.55 * log(10.0))) < 1e-14);
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
        plain += lac_b_value(n, seen, 0.0, &error, &used) / CATALOGUES;
        positive += lac_b_positive(n, seen, 0.2, &error, &used) / CATALOGUES;
    }
    print_message("hidden after large ones: %.4f, %.4f\n", plain, positive);
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

// White and red noise with no trend: p below 0.05 in one of twenty, within one of a hundred. Phases
// of a spectrum that a parabola was taken from alarm a little less often where noise is very red.
static void surrogates_are_fair(void **state)
{
    (void)state;
    enum { LENGTH = 60, TRIALS = 5000, SURROGATES = 19 };
    static const double phis[] = {0.0, 0.6, 0.9};
    for (size_t k = 0; k < 3; k++) {
        size_t alarms[4] = {0};
        for (uint64_t trial = 0; trial < TRIALS; trial++) {
            double x[LENGTH], pair[2];
            lac_slowing slowing;
            for (size_t i = 0; i < LENGTH; i++) {
                lac_random_normal(41 + k, LAC_STREAM_TEST, trial, i, pair);
                x[i] =
                    i == 0 ? pair[0] / sqrt(1 - phis[k] * phis[k]) : phis[k] * x[i - 1] + pair[0];
            }
            assert_int_equal(lac_slowing_measure(LENGTH, x, trial, SURROGATES, &slowing, NULL),
                             LAC_OK);
            alarms[0] += slowing.variance_p <= 0.05 ? 1 : 0;
            alarms[1] += slowing.autocorrelation_p <= 0.05 ? 1 : 0;
            alarms[2] += slowing.variance_phase_p <= 0.05 ? 1 : 0;
            alarms[3] += slowing.autocorrelation_phase_p <= 0.05 ? 1 : 0;
        }
        print_message("phi %.1f: %zu, %zu; phases %zu, %zu of %d\n", phis[k], alarms[0], alarms[1],
                      alarms[2], alarms[3], (int)TRIALS);
        for (size_t i = 0; i < 4; i++) {
            const size_t least = i >= 2 && phis[k] > 0.8 ? TRIALS / 40 : TRIALS / 25;
            assert_true(alarms[i] >= least && alarms[i] <= 3 * TRIALS / 50);
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

static double value(const lac_precursor *all, size_t count, const char *name, const char *key)
{
    for (size_t k = 0; k < count; k++) {
        if (strcmp(all[k].kind->info.name, name) == 0) {
            return lac_forecast_fit_find(&all[k].found, key);
        }
    }
    fail_msg("no indicator %s", name);
    return NAN;
}

// All indicators of events, in a motion of two readings that are as far apart.
static size_t look_at_events(const lac_event_list *events, double length, lac_precursor *out)
{
    double time[2] = {0.0, length};
    double displacement[2] = {0.0, 0.0};
    size_t count = 0;
    lac_motion motion = {.n = 2, .time = time, .displacement = displacement};
    const lac_precursor_inputs seen = {&motion, events, NULL, NAN, NAN, 1, 59};
    assert_int_equal(lac_precursors_evaluate(&seen, out, &count, NULL), LAC_OK);
    return count;
}

static double detected(double m) { return 0.5 * (1.0 + erf((m - 0.5) / (0.2 * sqrt(2.0)))); }

// Catalogues of which small events are missed the more the smaller they are, half of them at 0.5:
// the indicators find from where on they are complete. As many events as make 5 000 from 0.8 on.
static void incomplete_catalogues_are_cut(void **state)
{
    (void)state;
    enum { MOST = 20 * N };
    static const double known[] = {0.7, 1.0, 1.5};
    static double time[MOST], moment[MOST];
    for (size_t k = 0; k < 3; k++) {
        double b = 0.0;
        double positive = 0.0;
        for (uint64_t c = 0; c < CATALOGUES; c++) {
            lac_precursor out[LAC_PRECURSORS_MAX];
            size_t n = 0;
            size_t complete = 0;
            for (uint64_t i = 0; complete < N && n < MOST; i++) {
                const double m = -log10(uniform(c, i)) / known[k];
                if (uniform(c + CATALOGUES, i) < detected(m)) {
                    time[n] = (double)n;
                    moment[n++] = pow(10.0, 1.5 * m + 9.1);
                    complete += m >= 0.8 ? 1 : 0;
                }
            }
            const lac_event_list events = {n, time, moment, NULL};
            const size_t count = look_at_events(&events, (double)n, out);
            b += value(out, count, "b_value", "b") / CATALOGUES;
            positive += value(out, count, "b_positive", "b") / CATALOGUES;
        }
        print_message("b %.1f: %.4f, %.4f\n", known[k], b, positive);
        assert_true(fabs(b - known[k]) < 0.02);
        assert_true(fabs(positive - known[k]) < 0.02);
    }
}

static void halves_are_binomial(void **state)
{
    (void)state;
    assert_true(fabs(lac_half_p(5, 5) - 1.0 / 32.0) < 1e-15);
    assert_true(fabs(lac_half_p(12, 7) - 0.38720703125) < 1e-14);
    assert_true(fabs(lac_half_p(1000, 540) - 0.0062220731385858995) < 1e-12);
    assert_true(lac_half_p(7, 0) == 1.0 && lac_half_p(0, 0) == 1.0);
}

// Values that hold until the next: ranks of the last of 20 parts.
static void rises_are_ranks(void **state)
{
    (void)state;
    double time[40], x[40];
    for (size_t i = 0; i < 40; i++) {
        time[i] = (double)i * (double)i;
        x[i] = (double)i;
    }
    assert_true(lac_rise_p(40, time, x) == 1.0 / LAC_RISE_PARTS);
    x[39] = 0.0; // the one before stood when the last part, from 0.95 39^2 on, began
    assert_true(lac_rise_p(40, time, x) == 2.0 / LAC_RISE_PARTS);
    x[3] = 1e9; // in the first part
    assert_true(lac_rise_p(40, time, x) == 3.0 / LAC_RISE_PARTS);
    for (size_t i = 0; i < 40; i++) {
        x[i] = 0.0;
    }
    assert_true(lac_rise_p(40, time, x) == 1.0);
    assert_true(isnan(lac_rise_p(1, time, x)) && isnan(lac_rise_p(0, time, x)));
}

// Events at a constant rate, of one size distribution; values that know no time.
static void rises_are_fair(void **state)
{
    (void)state;
    enum { EVENTS = 150, TRIALS = 2000 };
    double time[EVENTS], moment[EVENTS];
    size_t alarms[4] = {0};
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        lac_precursor out[LAC_PRECURSORS_MAX];
        double before = 0.0;
        for (size_t i = 0; i < EVENTS; i++) { // waits of a Poisson process, over their sum
            before -= log(uniform(trial, 3 * i));
            time[i] = before;
            moment[i] = 1e9 * pow(uniform(trial, 3 * i + 1), -1.5);
        }
        before -= log(uniform(trial, 3 * (uint64_t)EVENTS));
        const lac_event_list events = {EVENTS, time, moment, NULL};
        const size_t count = look_at_events(&events, before, out);
        alarms[0] += value(out, count, "event_rate", "rise_p") <= 0.05 ? 1 : 0;
        alarms[1] += value(out, count, "moment", "rise_p") <= 0.05 ? 1 : 0;
        alarms[2] += value(out, count, "b_value", "fall_p") <= 0.05 ? 1 : 0;
        alarms[3] += lac_rise_p(EVENTS, time, moment) <= 0.05 ? 1 : 0;
    }
    print_message("rate %zu, moment %zu, b %zu, rank %zu of %d\n", alarms[0], alarms[1], alarms[2],
                  alarms[3], (int)TRIALS);
    assert_true(alarms[0] >= 70 && alarms[0] <= 120); // the exact test of 150 allows 4.1 %
    for (size_t i = 1; i < 4; i++) {
        assert_true(alarms[i] >= 80 && alarms[i] <= 120);
    }
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
    const lac_event_list events = {EVENTS, event_time, moment, NULL};
    const lac_slip_history slip = {READINGS, LEVELS, time, n_slip, n_tot, length, 0.6};
    const lac_precursor_inputs seen = {&motion, &events, &slip, tc, 0.0, 1, 59};
    lac_precursor out[LAC_PRECURSORS_MAX];
    size_t count = 0;
    assert_int_equal(lac_precursors_evaluate(&seen, out, &count, NULL), LAC_OK);
    assert_true(fabs(value(out, count, "event_rate", "exponent") - p) < 0.01);
    const double error = value(out, count, "event_rate", "exponent_error");
    assert_true(error > 0.005 && error < 0.1);
    assert_true(fabs(value(out, count, "correlation_length", "growth_exponent") - 0.7) < 1e-9);
    assert_true(fabs(value(out, count, "log_periodicity", "omega") - 9.0) < 0.3);
    assert_true(value(out, count, "log_periodicity", "p") < 0.03);
    assert_true(value(out, count, "log_periodicity", "power") > 0.9);
    assert_true(value(out, count, "slip_fraction", "slip_fraction") == 21.0 / 64.0);
    assert_true(fabs(value(out, count, "slip_fraction", "distance") - (0.6 - 21.0 / 64.0)) < 1e-15);
    assert_true(value(out, count, "slip_fraction", "level_1") == 0.25);
    assert_true(value(out, count, "correlation_length", "rise_p") == 1.0 / LAC_RISE_PARTS);
    assert_true(fabs(value(out, count, "moment", "moment_N_m") - 4e12) < 1.0);
    assert_true(isnan(value(out, count, "slowing", "variance_p"))); // no velocities
}

static void what_is_not_there_is_said(void **state)
{
    (void)state;
    double none = 0.0;
    lac_motion motion = {.n = 1, .time = &none, .displacement = &none, .sigma = &none};
    const lac_event_list events = {0, &none, &none, NULL};
    const lac_slip_history slip = {.n = 0};
    const lac_precursor_inputs series = {&motion, NULL, NULL, NAN, NAN, 1, 19};
    const lac_precursor_inputs run = {&motion, &events, &slip, NAN, NAN, 1, 19};
    lac_precursor out[LAC_PRECURSORS_MAX];
    size_t count = 0;
    assert_int_equal(lac_precursors_evaluate(&series, out, &count, NULL), LAC_OK);
    for (size_t k = 0; k < count; k++) {
        assert_true(out[k].found.reason[0] != '\0' && out[k].kind->estimator[0] != '\0');
        assert_true((out[k].kind->needs == LAC_NEEDS_EVENTS) ==
                    (strstr(out[k].found.reason, "needs a catalogue") != NULL));
    }
    assert_int_equal(lac_precursors_evaluate(&run, out, &count, NULL), LAC_OK);
    for (size_t k = 0; k < count; k++) {
        assert_true(out[k].found.reason[0] != '\0');
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(b_values_are_found),
        cmocka_unit_test(positive_differences_are_counted),
        cmocka_unit_test(incompleteness_is_borne),
        cmocka_unit_test(incomplete_catalogues_are_cut),
        cmocka_unit_test(halves_are_binomial),
        cmocka_unit_test(rises_are_ranks),
        cmocka_unit_test(rises_are_fair),
        cmocka_unit_test(tau_counts_pairs),
        cmocka_unit_test(surrogates_are_fair),
        cmocka_unit_test(slowing_is_seen),
        cmocka_unit_test(rates_lengths_and_oscillations_are_found),
        cmocka_unit_test(what_is_not_there_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
