/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// What is done so far of a long work, in a file beside the output that it is for: a line that says
/// whose it is and what of, then records, each with its sum behind it. A work that was killed goes
/// on from it.
typedef struct lac_kept lac_kept;

/// Opens the file, which one process at a time holds; it begins anew unless `resume` says
/// otherwise.
/// @param whose   the command that writes it: "fit"; of another one it is refused
/// @param of      what the records follow from: of something else they are refused
/// @param resume  the file must be there
/// @return LAC_OK; LAC_EIO; LAC_EINPUT (another holds it, no such command wrote it, it is of
///         something else); LAC_ENOMEM
lac_status lac_kept_open(const char *path, const char *whose, uint64_t of, bool resume,
                         lac_kept **out, lac_error *err);

/// The next record. @return false: there is none that is whole, nor after it; or `kept` is NULL
bool lac_kept_read(lac_kept *kept, void *bytes, size_t size);

/// Adds a record, in place of what was not read. It outlives the process, however that ends; a
/// machine that stops only once it was synced.
lac_status lac_kept_put(lac_kept *kept, const void *bytes, size_t size, lac_error *err);
lac_status lac_kept_sync(lac_kept *kept, lac_error *err);

/// Whether it has no record, read or put.
bool lac_kept_has_none(const lac_kept *kept);

/// @param kept    NULL is fine
/// @param remove  the file is not needed any more
void lac_kept_close(lac_kept *kept, bool remove);

/// Its descriptor, which children close, so that they do not hold the file; -1: `kept` is NULL.
int lac_kept_file(const lac_kept *kept);

/// Whether a file is such a command's, or as far as its first line got. @param folder  open
bool lac_kept_is_of(int folder, const char *name, const char *whose);
