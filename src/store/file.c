// SPDX-License-Identifier: GPL-3.0-or-later
// The life of a file: made under a temporary name, published, closed.
#define _GNU_SOURCE // fallocate
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/part.h"
#include "store/nc.h"

enum { RESERVE = 1 << 20 }; // for HDF5's own records [bytes]

lac_status lac_nc_path(const char *path, bool *exists, lac_error *err)
{
    *exists = false;
    if (path == NULL || *path == '\0') {
        return lac_fail(err, LAC_EIO, "the path of a netCDF file is empty");
    }
    if (strstr(path, "://") != NULL) {
        return lac_fail(err, LAC_EIO, "%s: is an address, not a file", path);
    }
    struct stat info;
    if (stat(path, &info) != 0) {
        if (errno == ENOENT) {
            return LAC_OK;
        }
        return lac_fail(err, LAC_EIO, "%s: %s", path, strerror(errno));
    }
    if (!S_ISREG(info.st_mode)) {
        return lac_fail(err, LAC_EIO, "%s: is %s", path,
                        S_ISDIR(info.st_mode) ? "a folder" : "not a regular file");
    }
    *exists = true;
    return LAC_OK;
}

// The place a path leads to, through its links where the file exists.
static char *resolve(const char *path, bool exists)
{
    return exists ? realpath(path, NULL) : strdup(path);
}

// Takes the temporary name for this process; what killed ones left of this file is removed.
static lac_status take_part(lac_nc *file, lac_error *err)
{
    lac_part_sweep(file->path);
    (void)unlink(file->part);
    file->fd = open(file->part, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    return file->fd >= 0
               ? LAC_OK
               : lac_fail(err, LAC_EIO, "%s: cannot create: %s", file->path, strerror(errno));
}

static off_t size_of(int fd)
{
    struct stat info;
    return fstat(fd, &info) == 0 ? info.st_size : -1;
}

lac_status lac_nc_reserve(const lac_nc *file, size_t bytes, lac_error *err)
{
    struct rlimit limit;
    off_t more = (off_t)bytes + RESERVE;
    off_t size = file->fd >= 0 ? size_of(file->fd) : -1;
    int reason = 0;
    if (size < 0) {
        return LAC_OK;
    }
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        (rlim_t)(size + more) > limit.rlim_cur) {
        reason = EFBIG;
    } else if (fallocate(file->fd, FALLOC_FL_KEEP_SIZE, size, more) != 0) {
        reason = errno;
    }
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG) {
        return lac_fail(err, LAC_EIO, "%s: cannot write: %s", file->path, strerror(reason));
    }
    return LAC_OK;
}

// Gives back the space that was reserved and not used, and seals a file that is whole.
static void end_reserve(lac_nc *file, bool whole)
{
    if (file->fd < 0) {
        return;
    }
    off_t size = size_of(file->fd);
    int wasted = size >= 0 ? ftruncate(file->fd, size) : 0;
    (void)wasted;
    if (whole) {
        lac_nc_seal(file->fd);
    }
    (void)close(file->fd);
    file->fd = -1;
}

lac_status lac_nc_create(lac_nc *file, const char *path, bool force, lac_error *err)
{
    *file = (lac_nc){.force = force, .fd = -1};
    bool exists = false;
    lac_status status = lac_nc_path(path, &exists, err);
    if (status != LAC_OK) {
        return status;
    }
    if (exists && !force) {
        return lac_fail(err, LAC_EINPUT, "%s: exists", path);
    }
    if (exists && access(path, W_OK) != 0) {
        return lac_fail(err, LAC_EIO, "%s: cannot replace: %s", path, strerror(errno));
    }
    if (exists && lac_part_locked(AT_FDCWD, path)) {
        return lac_fail(err, LAC_EIO, "%s: cannot replace: another process is writing it", path);
    }
    file->path = resolve(path, exists);
    file->part = file->path != NULL ? lac_part_name(file->path) : NULL;
    if (file->part == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(take_part(file, err));
    errno = 0;
    int code = nc_create(file->part, NC_NETCDF4 | NC_CLOBBER, &file->id);
    file->open = code == NC_NOERR;
    LAC_TRY(lac_nc_check(file->path, code, err, "create", ""));
out:
    if (status != LAC_OK) {
        lac_nc_clear(file);
    }
    return status;
}

lac_status lac_nc_pin_old(lac_nc *file, lac_error *err)
{
    struct stat info;
    if (stat(file->path, &info) != 0) {
        return lac_fail(err, LAC_EIO, "%s: %s", file->path, strerror(errno));
    }
    file->old_pinned = true;
    file->old_dev = info.st_dev;
    file->old_inode = info.st_ino;
    return LAC_OK;
}

static bool stands_at(const char *path, dev_t dev, ino_t inode)
{
    struct stat info;
    return stat(path, &info) == 0 && info.st_dev == dev && info.st_ino == inode;
}

lac_status lac_nc_check_place(const lac_nc *file, lac_error *err)
{
    struct stat own;
    if (file->fd < 0 || fstat(file->fd, &own) != 0 ||
        stands_at(file->path, own.st_dev, own.st_ino)) {
        return LAC_OK;
    }
    return lac_fail(err, LAC_EIO, "%s: was replaced or removed while it was being written",
                    file->path);
}

lac_status lac_nc_publish(lac_nc *file, lac_error *err)
{
    if (file->old_pinned && !stands_at(file->path, file->old_dev, file->old_inode)) {
        return lac_fail(err, LAC_EINPUT, "%s: was replaced meanwhile by another process",
                        file->path);
    }
    if (lac_part_publish(file->part, file->path, file->force) != 0) {
        if (errno == EEXIST && !file->force) {
            return lac_fail(err, LAC_EINPUT, "%s: exists", file->path);
        }
        return lac_fail(err, LAC_EIO, "%s: cannot create: %s", file->path, strerror(errno));
    }
    file->published = true;
    return LAC_OK;
}

lac_status lac_nc_close(lac_nc *file, lac_error *err)
{
    file->open = false;
    errno = 0;
    lac_status status = lac_nc_check(file->path, nc_close(file->id), err, "close", "");
    end_reserve(file, status == LAC_OK);
    return status;
}

void lac_nc_clear(lac_nc *file)
{
    if (file->open) {
        (void)lac_nc_close(file, NULL);
    }
    end_reserve(file, false);
    if (file->part != NULL && !file->published) {
        (void)unlink(file->part);
    }
    free(file->part);
    free(file->path);
    file->part = NULL;
    file->path = NULL;
}

lac_status lac_nc_write(const char *path, bool force, const lac_provenance *provenance,
                        const char *summary, lac_nc_put put, void *context, lac_error *err)
{
    lac_nc file = {0};
    lac_status status;
    LAC_TRY(lac_nc_create(&file, path, force, err));
    LAC_TRY(lac_nc_provenance(&file, provenance, summary, err));
    LAC_TRY(put(&file, context, err));
    LAC_TRY(lac_nc_close(&file, err));
    LAC_TRY(lac_nc_publish(&file, err));
out:
    lac_nc_clear(&file);
    return status;
}
