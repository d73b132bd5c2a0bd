// SPDX-License-Identifier: GPL-3.0-or-later
// How often events come on the way to failure, n ~ (tc - t)^-p, and the moment that they release.
#include "base/rng.h"
#include "base/roots.h"
#include "precursor/kinds.h"

enum { FEW = 5, FEW_TO_FIT = 10, HALVINGS = 100 };
static const double steepest = 20.0;

static const lac_precursor_value numbers[] = {
    {"rate_1_s", "s-1", "events a time, since the first reading"},
    {"share_of_the_last_half", "1", "part of them in the last half of that time"},
    {"rise_p", "1", "chance of as many there at a constant rate"},
    {"exponent", "1", "p of an Omori-type rise (tc - t)^-p"},
    {"exponent_error", "1", "standard error of p"},
};

// Mean and variance of u on [0, length] with density ~ exp(k u).
static void tilted(double k, double length, double *mean, double *variance)
{
    const double x = k * length;
    if (fabs(x) < 1e-4) {
        *mean = length * (0.5 + x / 12.0);
        *variance = length * length / 12.0;
        return;
    }
    const double grown = expm1(x);
    *mean = length * (1.0 + 1.0 / grown) - 1.0 / k;
    *variance = 1.0 / (k * k) - length * length * (1.0 + 1.0 / grown) / grown;
}

// p of n ~ (tc - t)^-p by maximum likelihood: with u = ln(tc - t) less its least value the density
// is ~ exp((1 - p) u), whose mean grows with 1 - p.
static double find_p(double mean, double length, double count, double *error)
{
    double low = -steepest, high = steepest, found, variance = NAN;
    for (int i = 0; i < HALVINGS; i++) {
        tilted(0.5 * (low + high), length, &found, &variance);
        lac_halve(&low, &high, found < mean);
    }
    *error = 1.0 / sqrt(count * variance);
    return 1.0 - 0.5 * (low + high);
}

// The Omori-type rise from the first event to now.
static void add_exponent(const lac_event_list *e, double tc, double now, lac_forecast_fit *found)
{
    const double nearest = log(tc - now);
    const double length = log(tc - e->time[0]) - nearest;
    double mean = 0.0, error = NAN;
    for (size_t i = 0; i < e->n; i++) {
        mean += (log(tc - e->time[i]) - nearest) / (double)e->n;
    }
    if (length > 0.0) {
        lac_forecast_fit_add(found, "exponent", find_p(mean, length, (double)e->n, &error));
        lac_forecast_fit_add(found, "exponent_error", error);
    }
}

static lac_status look(const lac_precursor_inputs *in, lac_forecast_fit *found, lac_error *err)
{
    const lac_event_list *e = in->events;
    const lac_motion *m = in->motion;
    const double first = m->time[0];
    const double now = m->time[m->n - 1];
    size_t late = 0;
    (void)err;
    found->points = e->n;
    if (e->n < FEW) {
        return lac_forecast_fit_refuse(found, "too few events: %zu, at least %d", e->n, (int)FEW);
    }
    if (!(now > first)) {
        return lac_forecast_fit_refuse(found, "there is one reading only");
    }
    for (size_t i = 0; i < e->n; i++) {
        late += e->time[i] > 0.5 * (first + now) ? 1 : 0;
    }
    lac_forecast_fit_add(found, "rate_1_s", (double)e->n / (now - first));
    lac_forecast_fit_add(found, "share_of_the_last_half", (double)late / (double)e->n);
    lac_forecast_fit_add(found, "rise_p", lac_half_p(e->n, late));
    if (in->tc > now && e->n >= FEW_TO_FIT) {
        add_exponent(e, in->tc, now, found);
    }
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_event_rate = {
    .info = LAC_ABOUT("event_rate", "events in time, and the exponent of an Omori-type rise",
                      "Papazachos (1973), Geophys. J. R. Astron. Soc. 33, 421"),
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "rise_p binomial; n ~ (tc - t)^-p by maximum likelihood from the first event to "
                 "now, tc of the log law",
    LAC_PRECURSOR_VALUES(numbers),
    .headline = 2,
    .evaluate = look,
};

// The moment that events release, and whether its release rises.

enum { BITS = 64, WORDS = 4 };

static const lac_precursor_value sums[] = {
    {"moment_N_m", "N m", "sum of the moments"},
    {"largest_N_m", "N m", "the largest moment"},
    {"share_of_the_last_half", "1", "part of the sum in the last half of the time"},
    {"rise_p", "1", "chance of as large a part, if the events came at a constant rate"},
};

// Sum of the moments of events that fall into the last half by the toss of a coin.
static double toss(const lac_event_list *e, uint64_t seed, size_t index)
{
    uint64_t coins[WORDS];
    double late = 0.0;
    for (size_t i = 0; i < e->n; i++) {
        const size_t coin = i % ((size_t)WORDS * BITS);
        if (coin == 0) {
            lac_random(seed, LAC_STREAM_SURROGATE, index, (1ULL << 41) + i, coins);
        }
        const bool heads = (coins[coin / BITS] >> (coin % BITS) & 1) != 0;
        late += heads && e->moment[i] > 0.0 ? e->moment[i] : 0.0;
    }
    return late;
}

// Share of catalogues with the same moments at a constant rate whose last half has as much.
static double significance(const lac_precursor_inputs *in, double late)
{
    size_t above = 0;
    for (size_t s = 0; s < in->surrogates; s++) {
        above += toss(in->events, in->seed, s) >= late ? 1 : 0;
    }
    return (double)(1 + above) / (double)(1 + in->surrogates);
}

static lac_status look_at_moments(const lac_precursor_inputs *in, lac_forecast_fit *found,
                                  lac_error *err)
{
    const lac_event_list *e = in->events;
    const lac_motion *m = in->motion;
    const double middle = 0.5 * (m->time[0] + m->time[m->n - 1]);
    double sum = 0.0, late = 0.0, largest = 0.0;
    (void)err;
    for (size_t i = 0; i < e->n; i++) {
        if (e->moment[i] > 0.0) {
            found->points++;
            sum += e->moment[i];
            late += e->time[i] > middle ? e->moment[i] : 0.0;
            largest = fmax(largest, e->moment[i]);
        }
    }
    if (e->n == 0) {
        return lac_forecast_fit_refuse(found, "no event has ended");
    }
    if (found->points == 0) {
        return lac_forecast_fit_refuse(
            found, "no event has a moment: the case needs material.shear_modulus");
    }
    lac_forecast_fit_add(found, "moment_N_m", sum);
    lac_forecast_fit_add(found, "largest_N_m", largest);
    lac_forecast_fit_add(found, "share_of_the_last_half", late / sum);
    lac_forecast_fit_add(found, "rise_p", significance(in, late));
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_moment = {
    .info = LAC_ABOUT("moment", "seismic moment released by events",
                      "Aki (1966), Bull. Earthq. Res. Inst. 44, 73"),
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "sums over the events that have ended; rise_p: the same moments in either half of "
                 "the time by the toss of a coin",
    LAC_PRECURSOR_VALUES(sums),
    .evaluate = look_at_moments,
};
