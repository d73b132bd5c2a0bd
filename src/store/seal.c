// SPDX-License-Identifier: GPL-3.0-or-later
// A checksum of the file behind its end, where HDF5 does not look. HDF5 1.10 leaves some of its
// own structure without checksums and loops or frees wild pointers where that is damaged, so a
// sealed file is checked before HDF5 sees it. HDF5 cuts the seal off when it writes to the file.
#include <sys/stat.h>
#include <unistd.h>

#include "store/nc.h"

enum {
    SEALED_MAX = 1 << 26, // bytes from the start that are summed: all of most files
    BUFFER_WORDS = 8192,
    SCAN_MAX = 1 << 26, // the heap is written with the header, near the start
    HEADER = 16,        // of a heap and of an object in it
};

typedef struct seal {
    char mark[8];
    uint64_t size;   // of the file without the seal
    uint64_t summed; // bytes from the start
    uint64_t sum;
} seal;

static const char mark[8] = {'L', 'A', 'C', 'S', 'E', 'A', 'L', '1'};

// FNV-1a on words of 8 bytes, the last one filled up with zeros, the high half folded in so that
// every bit reaches every other.
uint64_t lac_nc_sum(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t left = size; left > 0;) {
        uint64_t word = 0;
        const size_t part = left < sizeof word ? left : sizeof word;
        memcpy(&word, at, part);
        sum = (sum ^ word) * UINT64_C(0x100000001b3);
        sum ^= sum >> 32;
        at += part;
        left -= part;
    }
    return sum;
}

static bool sum_file(int fd, uint64_t size, uint64_t *sum)
{
    uint64_t bytes[BUFFER_WORDS];
    *sum = size;
    for (uint64_t at = 0; at < size;) {
        uint64_t left = size - at;
        size_t wanted = left < sizeof bytes ? (size_t)left : sizeof bytes;
        ssize_t got = pread(fd, bytes, wanted, (off_t)at);
        if (got < 0 || (size_t)got != wanted) {
            return false;
        }
        *sum = lac_nc_sum(*sum, bytes, wanted);
        at += wanted;
    }
    return true;
}

void lac_nc_seal(int fd)
{
    struct stat info;
    seal s = {.size = 0};
    if (fstat(fd, &info) != 0) {
        return;
    }
    memcpy(s.mark, mark, sizeof mark);
    s.size = (uint64_t)info.st_size;
    s.summed = s.size < SEALED_MAX ? s.size : SEALED_MAX;
    if (!sum_file(fd, s.summed, &s.sum) ||
        pwrite(fd, &s, sizeof s, info.st_size) != (ssize_t)sizeof s) {
        // A file without a seal is whole too; half a seal is none.
        int ignored = ftruncate(fd, info.st_size);
        (void)ignored;
    }
}

lac_seal lac_nc_seal_state(int fd, size_t size)
{
    seal s;
    uint64_t sum = 0;
    if (size <= sizeof s ||
        pread(fd, &s, sizeof s, (off_t)(size - sizeof s)) != (ssize_t)sizeof s ||
        memcmp(s.mark, mark, sizeof mark) != 0) {
        return LAC_SEAL_NONE;
    }
    bool sound = s.size == size - sizeof s && s.summed <= s.size && sum_file(fd, s.summed, &sum) &&
                 sum == s.sum;
    return sound ? LAC_SEAL_SOUND : LAC_SEAL_BROKEN;
}

// HDF5's global heap, which links variables to their dimensions, has no checksum, and an object of
// size 0 in it makes HDF5 1.10 loop for ever. A file whose writer was killed has no seal either, so
// its heap is walked here before HDF5 sees it (HDF5 File Format Specification III.E).
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
