// SPDX-License-Identifier: GPL-3.0-or-later
// A state that is saved and loaded by the same calls: each piece goes to the archive or comes from
// it.
#include "base/archive.h"

static bool make_room(lac_archive *archive, size_t size)
{
    if (size <= archive->room - archive->size) {
        return true;
    }
    size_t room = 2 * archive->room + size + 1024;
    unsigned char *grown = realloc(archive->bytes, room);
    if (grown == NULL) {
        archive->no_memory = true;
        return false;
    }
    archive->bytes = grown;
    archive->room = room;
    return true;
}

void lac_archive_pass(lac_archive *archive, void *piece, size_t size)
{
    if (!lac_archive_good(archive) || size == 0) {
        return;
    }
    if (!archive->loading) {
        if (make_room(archive, size)) {
            memcpy(archive->bytes + archive->size, piece, size);
            archive->size += size;
        }
    } else if (size > archive->size - archive->at) {
        archive->short_of = true;
    } else {
        memcpy(piece, archive->bytes + archive->at, size);
        archive->at += size;
    }
}

uint64_t lac_sum_bytes(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < size; i++) {
        sum = (sum ^ byte[i]) * UINT64_C(0x100000001b3);
    }
    return sum;
}
