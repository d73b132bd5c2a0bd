/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "run/run.h"

/// A checkpoint as it is kept beside the file of its run, in FILE.checkpoint; docs/format.md.
typedef struct lac_checkpoint_file {
    lac_checkpoint from;
    uint64_t records, snapshots, events; ///< in the file by then
    double begun;                        ///< when the file was made first, seconds since 1970
    double last_time;                    ///< of the last of the records [s]
    char *program, *libraries;           ///< that made it, with their versions
    char *case_text;      ///< the whole resolved case, and what the files hold that it names
    unsigned char *bytes; ///< `from` points into them
} lac_checkpoint_file;

/// Reads the checkpoint of a run's file.
/// @param path  of the run's file
/// @param out   to be cleared whatever the status
/// @return LAC_OK; LAC_EINPUT where there is none; LAC_EIO (cannot be read, damaged); LAC_ENOMEM
lac_status lac_checkpoint_file_read(const char *path, lac_checkpoint_file *out, lac_error *err);

void lac_checkpoint_file_clear(lac_checkpoint_file *checkpoint);

/// What this program calls itself in a checkpoint: its name and version.
const char *lac_checkpoint_file_program(void);
