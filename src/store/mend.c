// SPDX-License-Identifier: GPL-3.0-or-later
// A file whose writer was killed while HDF5 closed it. HDF5 then gives back what it holds free at
// the end: it cuts the file, and only afterwards writes the new length into the superblock. In
// between, which is long where cutting takes the file system long, the file seems truncated.
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/part.h"
#include "lacuna/store_checkpoint.h"

enum {
    GIVEN_BACK_MAX = 2 * 2048, // HDF5's two blocks of free space: of structure, of small data
    SUPERBLOCK = 36,           // up to and with the length
    VERSION = 8,
    WIDTH = 9, // of addresses
    FLAGS = 11,
    LENGTH = 28,
};

// The length that the superblock of an unclosed file states; 0: it is none of that kind.
static uint64_t stated_length(int fd)
{
    static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
    unsigned char block[SUPERBLOCK];
    uint64_t length = 0;
    if (pread(fd, block, sizeof block, 0) != (ssize_t)sizeof block ||
        memcmp(block, signature, sizeof signature) != 0 || block[VERSION] < 2 ||
        block[VERSION] > 3 || block[WIDTH] != 8 || (block[FLAGS] & 1) == 0) {
        return 0;
    }
    for (int i = 7; i >= 0; i--) {
        length = length << 8 | block[LENGTH + i];
    }
    return length;
}

void lac_store_mend(const char *path)
{
    struct stat info;
    if (lac_part_locked(AT_FDCWD, path)) {
        return;
    }
    int fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) {
        return;
    }
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode)) {
        uint64_t length = stated_length(fd);
        uint64_t size = (uint64_t)info.st_size;
        if (length > size && length - size <= GIVEN_BACK_MAX) {
            int failed = ftruncate(fd, (off_t)length); // then it still seems damaged
            (void)failed;
        }
    }
    (void)close(fd);
}
