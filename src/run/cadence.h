/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_CADENCE_H
#define LACUNA_RUN_CADENCE_H

#include <math.h>

#include "run/run.h"

// Keeps track of when something is due next.
typedef struct lac_clock {
    lac_cadence every;
    int64_t count;        // multiples of every.time passed
    int64_t steps;        // since the last time it was due
    double last_log_rate; // log10 of the mean rate then
} lac_clock;

static inline lac_clock lac_clock_start(lac_cadence every, double mean_rate)
{
    return (lac_clock){.every = every, .count = 1, .last_log_rate = log10(mean_rate)};
}

// The next exact time at which it is due [s]; INFINITY if it is not due by time.
static inline double lac_clock_next(const lac_clock *clock)
{
    return isnan(clock->every.time) ? INFINITY : (double)clock->count * clock->every.time;
}

// Whether it is due at the end of this step; by steps or by rate, not by time.
static inline bool lac_clock_due(lac_clock *clock, double mean_rate)
{
    double log_rate = log10(mean_rate);
    clock->steps++;
    bool by_steps = clock->every.steps > 0 && clock->steps >= clock->every.steps;
    bool by_rate = !isnan(clock->every.per_decade) &&
                   fabs(log_rate - clock->last_log_rate) * clock->every.per_decade >= 1.0;
    if (by_steps || by_rate) {
        clock->steps = 0;
        clock->last_log_rate = log_rate;
    }
    return by_steps || by_rate;
}

#endif
