/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_TRADE_H
#define LACUNA_STORE_TRADE_H

#include "lacuna/linkage.h"
#include "lacuna/store.h"

LAC_BEGIN_C

/// One run of a trade, as it is written. NaN: missing.
typedef struct lac_trade_row {
    const char *settings; ///< "solver.rtol=1e-05 solver.method=bdf"
    const char *end;      ///< done, broken, given up
    double value, error, uncertainty;
    double wall_time, cpu_time, memory, output; ///< [s], [bytes]
    double steps, evaluations;
    bool on_front;
} lac_trade_row;

/// A trade, as it is written.
typedef struct lac_trade_view {
    const char *quantity, *unit, *about; ///< name, SI unit, what it is
    double value, uncertainty;           ///< of the reference; relative
    const char *reference;               ///< its settings
    const char *recommended;             ///< settings; NULL: none
    const char *sentence;
    size_t runs;
    const lac_trade_row *row; ///< [runs]
} lac_trade_view;

/// Writes the table of a trade to a netCDF-4 file of its own; docs/format.md.
/// @return as lac_store_create
lac_status lac_store_trade(const char *path, bool force, const lac_provenance *provenance,
                           const lac_trade_view *view, lac_error *err);

LAC_END_C

#endif
