// SPDX-License-Identifier: GPL-3.0-or-later
// How often events come, and what moment they release, on the way to failure.
#include <math.h>

#include "precursor/kinds.h"

enum { FEW = 10, HALVINGS = 100 };
static const double steepest = 20.0;

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
        const double k = 0.5 * (low + high);
        tilted(k, length, &found, &variance);
        if (found < mean) {
            low = k;
        } else {
            high = k;
        }
    }
    *error = 1.0 / sqrt(count * variance);
    return 1.0 - 0.5 * (low + high);
}

static lac_status look_rate(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    const lac_event_list *e = seen->events;
    const lac_motion *m = seen->motion;
    (void)err;
    found->points = e->n;
    if (e->n < FEW) {
        return lac_finding_refuse(found, "too few events: %zu, at least %d", e->n, (int)FEW);
    }
    const double now = m->time[m->n - 1];
    size_t late = 0;
    for (size_t i = 0; i < e->n; i++) {
        late += e->time[i] > 0.5 * (e->time[0] + now) ? 1 : 0;
    }
    lac_finding_add(found, "rate_1_s", (double)e->n / (now - e->time[0]));
    lac_finding_add(found, "share_of_the_last_half", (double)late / (double)e->n);
    if (!(seen->tc > now)) {
        return LAC_OK; // no time of failure to count from
    }
    const double nearest = log(seen->tc - now);
    const double length = log(seen->tc - e->time[0]) - nearest;
    double mean = 0.0;
    double error = NAN;
    for (size_t i = 0; i < e->n; i++) {
        mean += (log(seen->tc - e->time[i]) - nearest) / (double)e->n;
    }
    lac_finding_add(found, "p", find_p(mean, length, (double)e->n, &error));
    lac_finding_add(found, "p_error", error);
    return LAC_OK;
}

static lac_status look_moment(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    const lac_event_list *e = seen->events;
    const lac_motion *m = seen->motion;
    double sum = 0.0;
    double late = 0.0;
    double largest = 0.0;
    (void)err;
    for (size_t i = 0; i < e->n; i++) {
        if (e->moment[i] > 0.0) {
            found->points++;
            sum += e->moment[i];
            late += e->time[i] > 0.5 * (e->time[0] + m->time[m->n - 1]) ? e->moment[i] : 0.0;
            largest = fmax(largest, e->moment[i]);
        }
    }
    if (found->points == 0) {
        return lac_finding_refuse(found, "no event has a moment: the case needs "
                                         "material.shear_modulus");
    }
    lac_finding_add(found, "moment_N_m", sum);
    lac_finding_add(found, "largest_N_m", largest);
    lac_finding_add(found, "share_of_the_last_half", late / sum);
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_event_rate = {
    .about = {.name = "event_rate",
              .summary = "events in time, and the exponent of an Omori-type rise",
              .reference = "Papazachos (1973), Geophys. J. R. Astron. Soc. 33, 421"},
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "n ~ (tc - t)^-p by maximum likelihood from the first event to now, tc of the log "
                 "law",
    .look = look_rate,
};

const lac_precursor_kind lac_precursor_moment = {
    .about = {.name = "moment",
              .summary = "seismic moment released by events",
              .reference = "Aki (1966), Bull. Earthq. Res. Inst. 44, 73"},
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "sums over the events that have ended",
    .look = look_moment,
};
