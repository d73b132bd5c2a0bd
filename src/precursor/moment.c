// SPDX-License-Identifier: GPL-3.0-or-later
// The moment that events release, and whether its release rises.
#include <math.h>

#include "base/rng.h"
#include "precursor/kinds.h"

enum { BITS = 64, WORDS = 4 };

static const lac_precursor_value numbers[] = {
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
static double significance(const lac_precursor_inputs *observation, double late)
{
    size_t above = 0;
    for (size_t s = 0; s < observation->surrogates; s++) {
        above += toss(observation->events, observation->seed, s) >= late ? 1 : 0;
    }
    return (double)(1 + above) / (double)(1 + observation->surrogates);
}

static lac_status look(const lac_precursor_inputs *observation, lac_forecast_fit *found,
                       lac_error *err)
{
    const lac_event_list *e = observation->events;
    const lac_motion *m = observation->motion;
    const double middle = 0.5 * (m->time[0] + m->time[m->n - 1]);
    double sum = 0.0;
    double late = 0.0;
    double largest = 0.0;
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
    lac_forecast_fit_add(found, "rise_p", significance(observation, late));
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_moment = {
    .info = LAC_ABOUT("moment", "seismic moment released by events",
                      "Aki (1966), Bull. Earthq. Res. Inst. 44, 73"),
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "sums over the events that have ended; rise_p: the same moments in either half of "
                 "the time by the toss of a coin",
    LAC_PRECURSOR_VALUES(numbers),
    .evaluate = look,
};
