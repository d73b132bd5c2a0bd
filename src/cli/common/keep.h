/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/kept.h"

/// What is done so far of many tasks, in the folder OUT.nc.runs beside an output until that is
/// written: --resume goes on from it. Its file `done` holds records of one size.
typedef struct cli_keep {
    const char *command; ///< whose it is: "trade"
    size_t size;         ///< of a record's content [bytes], plain memory without pointers
    uint64_t mark; ///< of all that the records follow from; records of another mark are refused
    double every;  ///< what the machine may lose, if it stops [s]; 0: no record. A process that
                   ///< is killed loses none
    char folder[PATH_MAX + 10];
    lac_kept *done; ///< NULL: not open
    double synced;  ///< when last [s]
} cli_keep;

/// A record that an earlier process kept.
typedef void cli_keep_take(void *context, uint64_t key, const void *content);

/// Opens the folder for the caller alone, with `command` to `every` set. With `resume`
/// what is there is given to `take`, in order; a record that was torn is dropped, and what follows
/// it. Files run-N.nc in it, and what stands beside them while they are made, are taken away.
/// @param path  of the output
/// @return LAC_OK; LAC_EIO; LAC_EINPUT where another process is at work there, where the folder has
///         what no such command wrote, or nothing to go on from
lac_status cli_keep_open(cli_keep *keep, const char *path, bool resume, cli_keep_take *take,
                         void *context, lac_error *err);

/// Adds a record. @param key  what it is of: an index, a checksum
/// @return LAC_OK; LAC_EIO
lac_status cli_keep_add(cli_keep *keep, uint64_t key, const void *content, lac_error *err);

/// Closes the folder. @param remove  takes it away with all that is in it
void cli_keep_close(cli_keep *keep, bool remove);
