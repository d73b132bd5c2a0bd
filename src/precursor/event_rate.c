// SPDX-License-Identifier: GPL-3.0-or-later
// How often events come on the way to failure: n ~ (tc - t)^-p.
#include <math.h>

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
    double low = -steepest;
    double high = steepest;
    double found;
    double variance = NAN;
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
    double mean = 0.0;
    double error = NAN;
    for (size_t i = 0; i < e->n; i++) {
        mean += (log(tc - e->time[i]) - nearest) / (double)e->n;
    }
    if (length > 0.0) {
        lac_forecast_fit_add(found, "exponent", find_p(mean, length, (double)e->n, &error));
        lac_forecast_fit_add(found, "exponent_error", error);
    }
}

static lac_status look(const lac_precursor_inputs *observation, lac_forecast_fit *found,
                       lac_error *err)
{
    const lac_event_list *e = observation->events;
    const lac_motion *m = observation->motion;
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
    if (observation->tc > now && e->n >= FEW_TO_FIT) {
        add_exponent(e, observation->tc, now, found);
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
