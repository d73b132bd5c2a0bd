// SPDX-License-Identifier: GPL-3.0-or-later
// Opens other people's netCDF files. The header of a classic one (CDF-1, 2, 5) is held against the
// bytes at hand first: netCDF itself allocates what a count says. (NetCDF Users' Guide, appendix B)
#include <fcntl.h>
#include <netcdf.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/need.h"
#include "base/netcdf.h"

// Tags of the lists of a header.
enum { TAG_NONE = 0, TAG_DIMENSION = 10, TAG_VARIABLE = 11, TAG_ATTRIBUTE = 12 };

// A place in the header. What does not fit sets `bad`; after that nothing moves.
typedef struct cursor {
    const unsigned char *data;
    size_t size, at;
    size_t count_width;  // bytes of a count: 4, or 8 in CDF-5
    size_t offset_width; // of a place in the file: 4 in CDF-1
    bool bad;
} cursor;

static uint64_t take(cursor *c, size_t width)
{
    if (c->bad || c->size - c->at < width) {
        c->bad = true;
        return 0;
    }
    uint64_t value = 0;
    for (size_t i = 0; i < width; i++) {
        value = value << 8 | c->data[c->at + i];
    }
    c->at += width;
    return value;
}

// Skips `count` things of `width` bytes, filled up to four bytes.
static void skip(cursor *c, uint64_t count, size_t width)
{
    uint64_t left = c->size - c->at;
    if (c->bad || count > left / width) {
        c->bad = true;
        return;
    }
    uint64_t size = (count * width + 3) / 4 * 4;
    c->bad = size > left;
    c->at += c->bad ? 0 : (size_t)size;
}

// The length of a list; each entry takes `least` bytes or more.
static uint64_t take_list(cursor *c, uint64_t tag, size_t least)
{
    uint64_t found = take(c, 4);
    uint64_t count = take(c, c->count_width);
    bool fits =
        (found == tag || (found == TAG_NONE && count == 0)) && count <= (c->size - c->at) / least;
    c->bad = c->bad || !fits;
    return c->bad ? 0 : count;
}

static void skip_name(cursor *c) { skip(c, take(c, c->count_width), 1); }

// Bytes of a value of each type: byte, char, short, int, float, double, and those of CDF-5.
static size_t width_of(cursor *c)
{
    static const size_t widths[] = {1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    uint64_t type = take(c, 4);
    c->bad = c->bad || type < 1 || type > sizeof widths / sizeof widths[0];
    return c->bad ? 1 : widths[type - 1];
}

static void skip_attributes(cursor *c)
{
    for (uint64_t n = take_list(c, TAG_ATTRIBUTE, 12); n > 0 && !c->bad; n--) {
        skip_name(c);
        size_t width = width_of(c);
        skip(c, take(c, c->count_width), width);
    }
}

lac_status lac_netcdf_check_header(const char *path, const void *bytes, size_t size, lac_error *err)
{
    const unsigned char *data = bytes;
    if (size < 4 || memcmp(data, "CDF", 3) != 0) {
        return LAC_OK;
    }
    cursor c = {.data = data,
                .size = size,
                .at = 4,
                .count_width = data[3] == 5 ? 8 : 4,
                .offset_width = data[3] == 1 ? 4 : 8};
    (void)take(&c, c.count_width); // records
    for (uint64_t n = take_list(&c, TAG_DIMENSION, 8); n > 0 && !c.bad; n--) {
        skip_name(&c);
        (void)take(&c, c.count_width);
    }
    skip_attributes(&c);
    for (uint64_t n = take_list(&c, TAG_VARIABLE, 24); n > 0 && !c.bad; n--) {
        skip_name(&c);
        skip(&c, take(&c, c.count_width), c.count_width); // dimensions
        skip_attributes(&c);
        (void)width_of(&c);
        (void)take(&c, c.count_width);
        (void)take(&c, c.offset_width);
    }
    return c.bad ? lac_fail(err, LAC_EINPUT,
                            "%s: byte %zu: netCDF cannot read the file: its header says what its "
                            "%zu bytes cannot hold",
                            path, c.at, size)
                 : LAC_OK;
}

static lac_status check_file(const char *path, int fd, lac_error *err)
{
    struct stat info;
    lac_status status = LAC_OK;
    if (fd >= 0 && fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0) {
        const size_t size = (size_t)info.st_size;
        void *bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
        LAC_FAIL_MEMORY_IF(bytes == MAP_FAILED, err);
        status = lac_netcdf_check_header(path, bytes, size, err);
        (void)munmap(bytes, size);
    }
    return status;
}

lac_status lac_netcdf_open(const char *path, int *id, lac_error *err)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    lac_status status = check_file(path, fd, err);
    if (fd >= 0) {
        (void)close(fd);
    }
    LAC_TRY_RETURN(status);
    LAC_TRY_RETURN(lac_need_netcdf(err));
    return lac_netcdf_check(path, nc_open(path, NC_NOWRITE, id), "the file", err);
}
