/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LOAD_SIGNAL_H
#define LACUNA_LOAD_SIGNAL_H

#include <math.h>

#include "load/load.h"

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

/// Adds shear stress over the nominal area [Pa], [Pa/s], to what the load is shared as.
static inline void lac_add_stress(const lac_load *load, lac_load_state *sum, lac_signal s)
{
    // A spring's stress is the same on all cells; here it has no stiffness.
    bool equal = load->share == LAC_SHARE_EQUAL, elastic = load->share == LAC_SHARE_ELASTIC;
    double *value = equal ? &sum->spring_stress : elastic ? &sum->elastic : &sum->stress;
    double *rate = equal ? &sum->spring_rate : elastic ? &sum->elastic_rate : &sum->stress_rate;
    *value += s.value;
    *rate += s.rate;
}

/// Adds a constant Q/P [1] to what the load is shared as.
static inline void lac_add_ratio(const lac_load *load, lac_load_state *sum, double ratio)
{
    bool equal = load->share == LAC_SHARE_EQUAL, elastic = load->share == LAC_SHARE_ELASTIC;
    double *to = equal ? &sum->equal_ratio : elastic ? &sum->elastic_ratio : &sum->ratio;
    *to += ratio;
}

/// Adds pore pressure [Pa], [Pa/s].
static inline void lac_add_pore(lac_load_state *sum, lac_signal s)
{
    sum->pore += s.value;
    sum->pore_rate += s.rate;
}

#endif
