/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_STORE_H
#define LACUNA_STORE_STORE_H

#include "store/columns.h"

struct lac_store {
    lac_nc file;
    unsigned fields;
    size_t cells;
    char time_unit[64];
    bool dated;
    double start_date, now; ///< seconds since 1970
    int columns[LAC_COLUMNS], field_ids[LAC_FIELDS], snapshot_time;
    lac_row *rows;            ///< [capacity] not yet written
    size_t buffered, written; ///< records in `rows`, in the file
    size_t capacity;
    size_t pending;                 ///< given to netCDF and not yet synced [bytes]
    size_t snapshots;               ///< in the file
    size_t unsynced, sync_every;    ///< records and snapshots
    double last_origin, last_local; ///< of the newest record
    bool has_last;
};

/// Everything of a run's file that is known before the first record.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_store_define(lac_store *store, const lac_store_def *def, lac_error *err);

/// Global attributes of how the run ended.
/// @param result  NULL: not known
lac_status lac_store_put_result(const lac_store *store, const char *status,
                                const lac_run_result *result, double wall_time, lac_error *err);

#endif
