// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5's global heap, which links variables to their dimensions, has no checksum, and an object of
// size 0 in it makes HDF5 1.10 loop for ever. A file whose writer was killed has no seal either, so
// its heap is walked here before HDF5 sees it (HDF5 File Format Specification III.E).
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "store/nc.h"

enum {
    SCAN_MAX = 1 << 26, // the heap is written with the header, near the start
    HEADER = 16,        // of a heap and of an object in it
};

static const unsigned char signature[8] = {'G', 'C', 'O', 'L', 1, 0, 0, 0};

static uint64_t little_endian(const unsigned char *bytes, size_t count)
{
    uint64_t value = 0;
    for (size_t i = count; i-- > 0;) {
        value = value << 8 | bytes[i];
    }
    return value;
}

// Whether the objects of a heap follow one another up to its end. Object 0 is the free space,
// whose size counts its header.
static bool is_heap_sound(const unsigned char *heap, size_t size)
{
    size_t at = HEADER;
    while (at + HEADER <= size) {
        uint64_t index = little_endian(heap + at, 2);
        uint64_t length = little_endian(heap + at + 8, 8);
        if (length > size - at || (index == 0 && length < HEADER)) {
            return false;
        }
        at += (size_t)(index == 0 ? length : HEADER + (length + 7) / 8 * 8);
    }
    return at <= size;
}

static const unsigned char *find_heap(const unsigned char *at, const unsigned char *end)
{
    while (end - at >= HEADER) {
        at = memchr(at, signature[0], (size_t)(end - at) - HEADER + 1);
        if (at == NULL || memcmp(at, signature, sizeof signature) == 0) {
            return at;
        }
        at++;
    }
    return NULL;
}

static bool are_heaps_sound(const unsigned char *bytes, size_t size)
{
    const unsigned char *end = bytes + size;
    const unsigned char *heap = find_heap(bytes, end);
    while (heap != NULL) {
        uint64_t length = little_endian(heap + 8, 8);
        // One that runs past what was read is left to HDF5, which bounds it by the file.
        if (length <= (uint64_t)(end - heap) && !is_heap_sound(heap, (size_t)length)) {
            return false;
        }
        heap = find_heap(heap + sizeof signature, end);
    }
    return true;
}

lac_status lac_nc_heap(const char *path, int fd, size_t size, lac_error *err)
{
    size = size < SCAN_MAX ? size : SCAN_MAX;
    unsigned char *bytes = malloc(size > 0 ? size : 1);
    LAC_FAIL_MEMORY_IF(bytes == NULL, err);
    ssize_t got = pread(fd, bytes, size, 0);
    bool sound = got >= 0 && are_heaps_sound(bytes, (size_t)got);
    free(bytes);
    return sound ? LAC_OK : lac_fail(err, LAC_EIO, "%s: is damaged", path);
}
