/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SUPPORT_DRIVEN_H
#define LACUNA_TESTS_SUPPORT_DRIVEN_H

// Slopes that rain or a lake drives, day by day, in closed form but for the random numbers.

#include <stdint.h>

#include "forecast/driver.h"

enum { DRIVEN_MOST = 400 };

typedef enum driven_weather {
    DRIVEN_WHITE, ///< independent normal numbers
    DRIVEN_RED,   ///< a first-order autoregression that remembers 5 days
    DRIVEN_RAIN,  ///< one day in four, exponential
    DRIVEN_WET,   ///< the same, five times as much in the last third
} driven_weather;

typedef struct driven_def {
    size_t days;
    uint64_t seed;
    driven_weather weather;
    double answer; ///< mm/day for one unit of the reservoir; 0: none
    double memory; ///< of it [day]
    size_t lag;    ///< [day], instead of it where not 0
    double change; ///< mm for one unit of the driver's change, instead of both where not 0
    double noise;  ///< of a rate [mm/day]
    bool red;      ///< that noise remembers 5 days
    double rise;   ///< of a hyperbola, to a twentieth of the record behind its end [mm/day]
} driven_def;

typedef struct driven {
    size_t n; ///< days + 1 readings, and as many values
    double time[DRIVEN_MOST], displacement[DRIVEN_MOST], value[DRIVEN_MOST]; ///< [s] [m]
    lac_readings readings;                                                   ///< of these
    lac_driver driver;
} driven;

/// Makes one; driver and readings point into it.
void driven_make(const driven_def *def, driven *out);

/// What the driver explains of the readings, cleaned of nothing.
void driven_explain(const driven *of, lac_driver_effect *effect);

#endif
