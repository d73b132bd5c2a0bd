/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "lacuna/simulation.h"
#include "trade/trade.h"

/// What looks at a run for the quantities and passes everything on.
typedef struct lac_trade_probe {
    lac_sink next;     ///< first: its address is the probe's
    double friction;   ///< Coulomb's f of Q_nom [1]; NaN: none
    double rate, load; ///< at the last record; largest Q/Q_nom so far; NaN: no record
    int64_t events;    ///< so far
} lac_trade_probe;

/// The sink of a run of the case. @param probe  must outlive it
lac_sink lac_trade_probe_start(lac_trade_probe *probe, const lac_case *c, const lac_sink *next);

/// The quantities of a run that is over.
/// @param catalogue  whether events were looked for
/// @param value      [LAC_QUANTITIES] gets those of a run; the others stay
void lac_trade_probe_values(const lac_trade_probe *probe, const lac_run_result *result,
                            bool catalogue, double *value);
