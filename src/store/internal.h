/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "run/describe.h"
#include "store/writer.h"

struct lac_store {
    lac_nc file;
    lac_run_place place; ///< what is put out now
    lac_dataset *dataset;
    lac_writer writer;
    double now;                     ///< seconds since 1970
    size_t unsynced, sync_every;    ///< records and snapshots
    double last_origin, last_local; ///< of the newest record
    bool has_last;
    char *libraries, *case_text; ///< owned; for the checkpoint
    double begun; ///< when the file, or the one it goes on from, was made; seconds since 1970
    bool has_checkpoint; ///< one of this run is beside the file
};

/// Makes the store the continuation of the file at its path; what it holds up to the checkpoint is
/// copied.
lac_status lac_store_take_over(lac_store *store, const lac_checkpoint_file *from, lac_error *err);

/// Writes the checkpoint beside the file, whole or not at all: one that is there stays until then.
lac_status lac_store_put_checkpoint(const lac_store *store, const lac_checkpoint *checkpoint,
                                    lac_error *err);

/// Removes what checkpoint there is beside a file.
void lac_store_remove_checkpoint(const char *path);
