// SPDX-License-Identifier: GPL-3.0-or-later
// A state that is saved and loaded by the same calls: each piece goes to the archive or comes from
// it.
#include "base/archive.h"

void lac_archive_pass(lac_archive *archive, void *piece, size_t size)
{
    if (!lac_archive_good(archive) || size == 0) {
        return;
    }
    if (!archive->loading) {
        archive->no_memory =
            lac_grow(&archive->bytes, &archive->room, archive->size + size, 1, NULL) != LAC_OK;
        if (!archive->no_memory) {
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

void *lac_archive_room(lac_archive *archive, size_t count, size_t least, size_t size)
{
    if (!lac_archive_good(archive) || count > (archive->size - archive->at) / least) {
        archive->short_of |= lac_archive_good(archive);
        return NULL;
    }
    void *room = calloc(count + 1, size);
    archive->no_memory = room == NULL;
    return room;
}

void lac_archive_text(lac_archive *archive, char **text)
{
    uint64_t length = archive->loading || *text == NULL ? 0 : strlen(*text);
    LAC_PASS(archive, length);
    if (archive->loading) {
        *text = lac_archive_room(archive, length, 1, 1);
    }
    lac_archive_pass(archive, *text, length);
}

uint64_t lac_sum_bytes(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < size; i++) {
        sum = (sum ^ byte[i]) * UINT64_C(0x100000001b3);
    }
    return sum;
}
