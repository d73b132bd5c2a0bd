/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// A state written to memory or read back: one function that passes every piece of it, in one
/// order, serves both ways.
typedef struct lac_archive {
    bool loading;         ///< pieces are read from `bytes`; else added to them
    bool no_memory;       ///< to save in, or for what is loaded
    bool short_of;        ///< while loading: the bytes ended, or did not fit
    const char *refused;  ///< name of what keeps no state; NULL: nothing
    unsigned char *bytes; ///< owned by whoever saves
    size_t size;          ///< [bytes]
    size_t at;            ///< read so far
    size_t room;          ///< allocated
} lac_archive;

/// Passes a piece: copied to the archive, or from it. After a failure nothing happens any more.
void lac_archive_pass(lac_archive *archive, void *piece, size_t size);

/// Zeroed room for `count` things that take at least `least` bytes each on the archive, and for one
/// more; NULL where it cannot hold as many, or is no good.
void *lac_archive_room(lac_archive *archive, size_t count, size_t least, size_t size);

/// Passes the length of a text and its bytes; NULL is an empty one. While loading it is allocated.
void lac_archive_text(lac_archive *archive, char **text);

/// A whole thing as a piece.
#define LAC_PASS(archive, thing) lac_archive_pass(archive, &(thing), sizeof(thing))

/// The members of a struct from one to another, which no padding parts: one put between them is in
/// the archive too.
#define LAC_PASS_RUN(archive, first, last) \
    lac_archive_pass(archive, &(first), (size_t)((char *)(&(last) + 1) - (char *)&(first)))

/// Whether everything went well so far.
static inline bool lac_archive_good(const lac_archive *archive)
{
    return !archive->no_memory && !archive->short_of && archive->refused == NULL;
}

/// FNV-1a of bytes. @param sum  to go on from, LAC_SUM_OF_NOTHING at first
uint64_t lac_sum_bytes(uint64_t sum, const void *bytes, size_t size);
#define LAC_SUM_OF_NOTHING UINT64_C(0xcbf29ce484222325)
