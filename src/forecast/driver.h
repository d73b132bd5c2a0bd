/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// What drives a slope from outside, and whether it explains how fast the slope moves.

#include "series/motion.h"

enum { LAC_DRIVER_SHIFTS = 199, LAC_DRIVER_LEAST = 15, LAC_DRIVER_TEXT = 200, LAC_DRIVERS_MAX = 8 };

/// Measured beside a slope on a clock of its own: rain, a lake, a temperature. A value is the mean,
/// or with `sum` the amount, since the value before, but of one median step at most where that is
/// more than two steps ago; with `days` that of the day that begins at its time. Between such steps
/// it is not known; an amount is 0 there.
typedef struct lac_driver {
    const char *name, *unit;
    bool sum, days;
    size_t n;
    const double *time;  ///< [n] strictly increasing, on the readings' clock [s]
    const double *value; ///< [n] [unit]; NaN: not known
} lac_driver;

/// How a slope may answer to a driver.
typedef enum lac_response {
    LAC_RESPONSE_LAG = 0, ///< to its value, some time later
    LAC_RESPONSE_MEMORY,  ///< to what a reservoir that it fills, and that empties itself, holds
    LAC_RESPONSE_CHANGE,  ///< to how fast such a reservoir fills; not of amounts
} lac_response;

typedef enum lac_explains {
    LAC_EXPLAINS_UNKNOWN = 0, ///< cannot be told
    LAC_EXPLAINS,
    LAC_EXPLAINS_NOT,
} lac_explains;

typedef enum lac_remains {
    LAC_REMAINS_UNKNOWN = 0, ///< cannot be told
    LAC_REMAINS_RISING,      ///< accelerates
    LAC_REMAINS_LEVEL,       ///< does not accelerate
} lac_remains;

/// What a driver does to a motion.
typedef struct lac_driver_effect {
    const lac_driver *driver; ///< borrowed
    lac_explains verdict;
    char reason[LAC_DRIVER_TEXT]; ///< why it cannot be told; "": it can
    size_t intervals;             ///< of the readings, or of groups of them, that are compared
    double p;     ///< chance of such a fit if the driver had come at another time; NaN: no test
    double share; ///< of the variance of the rate about its own rise that the driver explains
    lac_response response;
    double scale;        ///< memory or lag [s]
    double slope;        ///< rate for one unit of the response [m/s per unit; change: m per unit]
    lac_remains remains; ///< of the rate without the driver's part
    size_t n;            ///< readings of the motion
    double *value;       ///< [n] mean of the driver since the reading before [unit], of amounts per
                         ///< second; NaN: not known; owned
    double *part;        ///< [n] what it adds to the mean rate since the reading before [m/s]; NaN:
                         ///< it explains nothing
} lac_driver_effect;

/// Asks whether a driver explains the rate of a motion, from what was known at its last reading
/// (docs/theory/forecasting.md, "Drivers").
/// @param level  p up to which it does
/// @param out    to be freed by lac_driver_effect_clear in any case
/// @return LAC_OK; LAC_ENOMEM
/// @cost   10 to 20 ms; O(n + n of the driver)
lac_status lac_driver_explain(const lac_motion *motion, const lac_driver *driver, double level,
                              lac_driver_effect *out, lac_error *err);

void lac_driver_effect_clear(lac_driver_effect *effect);

/// The driver explains the rate, and what remains does not accelerate.
bool lac_driver_withholds(const lac_driver_effect *effect);
