/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LOAD_SIGNAL_H
#define LACUNA_LOAD_SIGNAL_H

#include <math.h>

#include "lacuna/load.h"

/// A quantity and its rate at one time.
typedef struct lac_signal {
    double value, rate;
} lac_signal;

/// An end that may be left out: NaN is never.
static inline double lac_end_of(double end) { return isnan(end) ? INFINITY : end; }

/// The first of the two ends of [start, end) that comes after t; INFINITY if none, or where the
/// window is empty.
static inline double lac_window_break(double start, double end, double t)
{
    if (end <= start) {
        return INFINITY;
    }
    if (t < start) {
        return start;
    }
    return t < end ? end : INFINITY;
}

/// Adds shear stress over the nominal area [Pa], [Pa/s].
static inline void lac_add_stress(lac_load_state *sum, lac_signal s)
{
    sum->stress += s.value;
    sum->stress_rate += s.rate;
}

/// Adds pore pressure [Pa], [Pa/s].
static inline void lac_add_pore(lac_load_state *sum, lac_signal s)
{
    sum->pore += s.value;
    sum->pore_rate += s.rate;
}

#endif
