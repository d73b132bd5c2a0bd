// SPDX-License-Identifier: GPL-3.0-or-later
// Size distribution of events: N(>= M) ~ 10^(-b M), and whether it changes; by all magnitudes, and
// by the differences of successive ones, which a completeness that changes does not touch.
#include <gsl/gsl_statistics_double.h>

#include "precursor/kinds.h"

enum { FEW = 20, BINS = 400, STABLE = 5, ENOUGH = 50, HIGHER = 20 };
static const double bin = 0.1, beyond = 0.2, least_step = 0.2;

static const lac_precursor_value numbers[] = {
    {"b", "1", "b-value of N(>= M) ~ 10^(-b M)"},
    {"error", "1", "standard error of b"},
    {"complete_from", "1", "magnitude from which events count"},
    {"change", "1", "b of the later half of these events less that of the earlier"},
    {"fall_p", "1", "chance of a fall as large, if b did not change"},
};

// Moment magnitudes (Hanks & Kanamori 1979) of the events that have a moment; the caller frees.
static lac_status find_magnitudes(const lac_event_list *events, double **magnitude, size_t *n,
                                  lac_error *err)
{
    *n = 0;
    *magnitude = malloc((events->n + 1) * sizeof **magnitude);
    LAC_FAIL_MEMORY_IF(*magnitude == NULL, err);
    for (size_t i = 0; i < events->n; i++) {
        if (events->moment[i] > 0.0 && isfinite(events->moment[i])) {
            (*magnitude)[(*n)++] = 2.0 / 3.0 * (log10(events->moment[i]) - 9.1);
        }
    }
    return LAC_OK;
}

// Lower edge of the fullest bin.
static double fullest_bin(size_t n, const double *magnitude)
{
    size_t count[BINS] = {0};
    size_t best = 0;
    const double lowest = bin * floor(gsl_stats_min(magnitude, 1, n) / bin);
    for (size_t i = 0; i < n; i++) {
        const double at = (magnitude[i] - lowest) / bin;
        count[at < BINS ? (size_t)at : BINS - 1]++;
    }
    for (size_t k = 1; k < BINS; k++) {
        best = count[k] > count[best] ? k : best;
    }
    return lowest + bin * (double)best;
}

// Whether b from mc on is, within its error, the mean of those from the next bins on too.
static bool is_stable(size_t n, const double *magnitude, double mc)
{
    double error, other_error, mean = 0.0;
    size_t used;
    const double b = lac_b_value(n, magnitude, mc, &error, &used);
    for (size_t k = 0; k < STABLE; k++) {
        mean += lac_b_value(n, magnitude, mc + bin * (double)k, &other_error, &used) / STABLE;
    }
    return used >= ENOUGH && fabs(mean - b) <= error;
}

// From which magnitude on a catalogue is complete: 0.2 above the fullest bin of 0.1 (Woessner &
// Wiemer 2005), and on from there until b is stable within its error over half a magnitude (Cao &
// Gao 2002); where it never is, the first. @param n  at least 1
static double complete_from(size_t n, const double *magnitude)
{
    const double first = fullest_bin(n, magnitude) + beyond;
    for (size_t k = 0; k < HIGHER; k++) {
        if (is_stable(n, magnitude, first + bin * (double)k)) {
            return first + bin * (double)k;
        }
    }
    return first;
}

// Puts the magnitudes from mc on in front, in their order. @return how many
static size_t keep_from(size_t n, double *magnitude, double mc)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (magnitude[i] >= mc) {
            magnitude[kept++] = magnitude[i];
        }
    }
    return kept;
}

// b of the later half of the magnitudes from mc on, against the earlier half's.
static void add_change(size_t n, double *magnitude, double mc, lac_forecast_fit *found)
{
    double error[2];
    size_t used[2];
    const size_t kept = keep_from(n, magnitude, mc);
    const size_t half = kept / 2;
    const double early = lac_b_value(half, magnitude, mc, &error[0], &used[0]);
    const double late = lac_b_value(kept - half, magnitude + half, mc, &error[1], &used[1]);
    const double both = hypot(error[0], error[1]);
    if (half >= FEW && both > 0.0) {
        lac_forecast_fit_add(found, "change", late - early);
        lac_forecast_fit_add(found, "fall_p", 0.5 * erfc((early - late) / (both * sqrt(2.0))));
    }
}

static void measure(size_t n, double *magnitude, lac_forecast_fit *found)
{
    double error = NAN;
    const double mc = complete_from(n, magnitude);
    const double b = lac_b_value(n, magnitude, mc, &error, &found->points);
    if (found->points < FEW) {
        (void)lac_forecast_fit_refuse(found, "too few events above %.2f: %zu, at least %d", mc,
                                      found->points, (int)FEW);
        return;
    }
    lac_forecast_fit_add(found, "b", b);
    lac_forecast_fit_add(found, "error", error);
    lac_forecast_fit_add(found, "complete_from", mc);
    add_change(n, magnitude, mc, found);
}

static lac_status look(const lac_precursor_inputs *in, lac_forecast_fit *found, lac_error *err)
{
    double *magnitude = NULL;
    size_t n = 0;
    LAC_TRY_RETURN(find_magnitudes(in->events, &magnitude, &n, err));
    if (n < FEW) {
        (void)lac_forecast_fit_refuse(found, "too few events with a moment: %zu, at least %d", n,
                                      (int)FEW);
    } else {
        measure(n, magnitude, found);
    }
    free(magnitude);
    return LAC_OK;
}

lac_status lac_events_b_value(const lac_event_list *events, double *b, lac_error *err)
{
    const lac_precursor_inputs in = {.events = events};
    lac_precursor seen = {0};
    const lac_status status = look(&in, &seen.found, err);
    *b = lac_forecast_fit_find(&seen.found, numbers[0].key);
    return status;
}

const lac_precursor_kind lac_precursor_b_value = {
    .info =
        LAC_ABOUT("b_value", "size distribution of events, by maximum likelihood",
                  "Aki (1965), Bull. Earthq. Res. Inst. 43, 237; Shi & Bolt (1982), Bull. Seismol. "
                  "Soc. Am. 72, 1677; Woessner & Wiemer (2005), Bull. Seismol. Soc. Am. 95, 684"),
    .needs = LAC_NEEDS_EVENTS,
    .page = true,
    .estimator = "b = log10(e)/(mean - mc) over magnitudes from mc: the fullest bin of 0.1 and "
                 "0.2, and on until b is stable over 0.5; fall_p: the later half of them against "
                 "the earlier, normal errors",
    LAC_PRECURSOR_VALUES(numbers),
    .evaluate = look,
};

static lac_status look_at_steps(const lac_precursor_inputs *in, lac_forecast_fit *found,
                                lac_error *err)
{
    double *magnitude = NULL;
    double error = NAN;
    size_t n = 0;
    LAC_TRY_RETURN(find_magnitudes(in->events, &magnitude, &n, err));
    n = n > 0 ? keep_from(n, magnitude, complete_from(n, magnitude)) : 0;
    const double b = lac_b_positive(n, magnitude, least_step, &error, &found->points);
    if (found->points < FEW) {
        (void)lac_forecast_fit_refuse(
            found, "too few events larger by %.1f than the one before: %zu, at least %d",
            least_step, found->points, (int)FEW);
    } else {
        lac_forecast_fit_add(found, "b", b);
        lac_forecast_fit_add(found, "error", error);
    }
    free(magnitude);
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_b_positive = {
    .info = LAC_ABOUT(
        "b_positive", "the same from positive differences of successive magnitudes",
        "van der Elst (2021), J. Geophys. Res. 126, e2020JB021027, doi 10.1029/2020JB021027"),
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "b = log10(e)/(mean - 0.2) over the differences of 0.2 or more of successive "
                 "magnitudes from mc, that of b_value",
    .value_count = 2,
    .value = numbers,
    .evaluate = look_at_steps,
};
