/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LOAD_LAGGED_H
#define LACUNA_LOAD_LAGGED_H

#include "load/signal.h"

/// What follows a drive p(t) of straight pieces with a lag T: T du/dt = p - u; T = 0: u = p.
typedef struct lac_lagged {
    size_t n;      ///< pieces; the last one goes on for ever
    double *t;     ///< [n] where each begins [s], rising
    double *drive; ///< [n] p there [Pa]
    double *slope; ///< [n] of p on the piece [Pa/s]
    double *u;     ///< [n] response there [Pa]
    double lag;    ///< T [s]
} lac_lagged;

/// Room for up to `n` pieces, none of which is there yet.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_lagged_create(size_t n, double lag, lac_lagged *out, lac_error *err);

/// Appends a piece that begins at t, later than the one before.
void lac_lagged_add(lac_lagged *lagged, double t, double drive, double slope);

/// Response at every piece's beginning; before the first it is at rest at `first`.
void lac_lagged_settle(lac_lagged *lagged, double first);

/// Exact response and its rate.
lac_signal lac_lagged_at(const lac_lagged *lagged, double t);

void lac_lagged_clear(lac_lagged *lagged);

#endif
