/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_INTERNAL_H
#define LACUNA_STORE_INTERNAL_H

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
    size_t extras;
    const lac_extra *extra; ///< [extras] what an analysis adds
    int *extra_ids;         ///< [extras]
    size_t levels, width;   ///< of the hierarchy; values that it adds to a record
    double *values;         ///< [capacity][width] not yet written
    lac_event *events;      ///< [capacity] not yet written; NULL: no catalogue
    int event_ids[LAC_EVENT_COLUMNS];
    size_t events_buffered, events_written;
    char *libraries, *case_text; ///< owned; for the checkpoint
    double begun; ///< when the file, or the one it goes on from, was made; seconds since 1970
    bool has_checkpoint; ///< one of this run is beside the file
};

/// Room for a catalogue of events; `capacity` is set.
lac_status lac_store_create_events(lac_store *store, lac_error *err);

/// Its dimension and variables.
lac_status lac_store_define_events(lac_store *store, lac_error *err);

/// Writes the buffered events.
lac_status lac_store_write_events(lac_store *store, lac_error *err);

/// Counts what was buffered or written; syncs the file when there is enough of it.
lac_status lac_store_count(lac_store *store, lac_error *err);

/// Disk space for what netCDF is given. @param bytes  uncompressed
lac_status lac_store_reserve(lac_store *store, size_t bytes, lac_error *err);

/// The sink's `event`. @param context  the store
lac_status lac_store_put_event(void *context, const lac_event *event, lac_error *err);
lac_status lac_store_put_once(void *context, const double *once, lac_error *err);

/// Makes the store the continuation of the file at its path; what it holds up to the checkpoint is
/// copied.
/// @return LAC_OK; LAC_EIO (not a file of Lacuna, damaged, full disk); LAC_ENOMEM
lac_status lac_store_take_over(lac_store *store, const lac_kept_checkpoint *from, lac_error *err);

/// Writes the checkpoint beside the file, whole or not at all: one that is there stays until then.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_store_put_checkpoint(const lac_store *store, const lac_checkpoint *checkpoint,
                                    lac_error *err);

/// Removes what checkpoint there is beside a file.
void lac_store_remove_checkpoint(const char *path);

/// Room for what an analysis adds; `capacity` is set.
lac_status lac_store_create_extras(lac_store *store, const lac_store_def *def, lac_error *err);

/// Its variables, the dimensions being there.
lac_status lac_store_define_extras(lac_store *store, lac_error *err);

/// Its values of the record that is buffered next. @param values  [width]; NULL: none
void lac_store_keep_extras(lac_store *store, const double *values);

/// Writes those of the buffered records.
lac_status lac_store_write_extras(const lac_store *store, lac_error *err);

void lac_store_clear_extras(lac_store *store);

/// Everything of a run's file that is known before the first record.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_store_define(lac_store *store, const lac_store_def *def, lac_error *err);

/// Global attributes of how the run ended.
/// @param result  NULL: not known
lac_status lac_store_put_result(const lac_store *store, const char *status,
                                const lac_run_result *result, double wall_time, lac_error *err);

#endif
