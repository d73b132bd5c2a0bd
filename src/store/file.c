// SPDX-License-Identifier: GPL-3.0-or-later
// The life of a file: made under a temporary name, filled with values and attributes, published,
// closed; its errors in words.
#define _GNU_SOURCE // fallocate
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/need.h"
#include "base/temp_file.h"
#include "store/nc.h"

enum { RESERVE = 1 << 20 }; // for HDF5's own records [bytes]

static bool is_disk_error(int code)
{
    return code == ENOSPC || code == EDQUOT || code == EFBIG || code == EIO || code == EROFS ||
           code == ENOENT || code == EACCES;
}

lac_status lac_nc_check(const char *path, int code, lac_error *err, const char *what,
                        const char *name)
{
    // HDF5 says no more than "HDF error"; what the system said is still in errno.
    int reason = errno;
    if (code == NC_NOERR) {
        return LAC_OK;
    }
    LAC_FAIL_MEMORY_IF(code == NC_ENOMEM || code == ENOMEM, err);
    const char *why = nc_strerror(code);
    if (code == NC_EHDFERR) {
        why = is_disk_error(reason) ? strerror(reason) : "the disk is full or the file is damaged";
    }
    return lac_fail(err, LAC_EIO, "%s: cannot %s%s%s: %s", path, what, *name != '\0' ? " " : "",
                    name, why);
}

int lac_nc_put_values(int file, nc_type type, int id, const size_t *start, const size_t *count,
                      const void *values)
{
    return type == NC_UBYTE   ? nc_put_vara_uchar(file, id, start, count, values)
           : type == NC_INT64 ? nc_put_vara_longlong(file, id, start, count, values)
                              : nc_put_vara_double(file, id, start, count, values);
}

lac_status lac_nc_text(const lac_nc *file, int var, const char *name, const char *text,
                       lac_error *err)
{
    if (text == NULL || *text == '\0') {
        return LAC_OK;
    }
    return lac_nc_check(file->path, nc_put_att_text(file->id, var, name, strlen(text), text), err,
                        "write the attribute", name);
}

lac_status lac_nc_number(const lac_nc *file, int var, const char *name, double value, bool whole,
                         lac_error *err)
{
    const bool narrow = value >= INT32_MIN && value <= INT32_MAX;
    const nc_type type = !whole ? NC_DOUBLE : narrow ? NC_INT : NC_INT64;
    return isfinite(value)
               ? lac_nc_check(file->path, nc_put_att_double(file->id, var, name, type, 1, &value),
                              err, "write the attribute", name)
               : LAC_OK;
}

char *lac_nc_text_of(int file, const char *name, size_t bound)
{
    size_t length = 0;
    nc_type type = NC_NAT;
    bool there = nc_inq_att(file, NC_GLOBAL, name, &type, &length) == NC_NOERR && type == NC_CHAR &&
                 length <= bound;
    char *text = calloc((there ? length : 0) + 1, 1);
    if (text != NULL && there && nc_get_att_text(file, NC_GLOBAL, name, text) != NC_NOERR) {
        text[0] = '\0';
    }
    return text;
}

lac_status lac_nc_path(const char *path, bool *exists, lac_error *err)
{
    *exists = false;
    LAC_FAIL_IF(path == NULL || *path == '\0', err, LAC_EIO, "the path of a netCDF file is empty");
    LAC_FAIL_IF(strstr(path, "://") != NULL, err, LAC_EIO, "%s: is an address, not a file", path);
    struct stat info;
    if (stat(path, &info) != 0) {
        int reason = errno;
        LAC_FAIL_IF(reason == ENOENT && lstat(path, &info) == 0, err, LAC_EIO,
                    "%s: is a link to a file that does not exist", path);
        return reason == ENOENT ? LAC_OK : lac_fail(err, LAC_EIO, "%s: %s", path, strerror(reason));
    }
    LAC_FAIL_IF(!S_ISREG(info.st_mode), err, LAC_EIO, "%s: is %s", path,
                S_ISDIR(info.st_mode) ? "a folder" : "not a regular file");
    *exists = true;
    return LAC_OK;
}

static off_t size_of(int fd)
{
    struct stat info;
    return fstat(fd, &info) == 0 ? info.st_size : -1;
}

// What forbids a file to grow by as much; 0: nothing, or nobody knows.
static int reserve(int fd, off_t more)
{
    struct rlimit limit;
    off_t size = fd >= 0 ? size_of(fd) : -1;
    if (size < 0) {
        return 0;
    }
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        (rlim_t)(size + more) > limit.rlim_cur) {
        return EFBIG;
    }
    const bool refused = fallocate(fd, FALLOC_FL_KEEP_SIZE, size, more) != 0;
    return refused && (errno == ENOSPC || errno == EDQUOT || errno == EFBIG) ? errno : 0;
}

lac_status lac_nc_reserve(const lac_nc *file, size_t bytes, lac_error *err)
{
    int reason = reserve(file->fd, (off_t)bytes + RESERVE);
    if (reason == 0 && file->journal != NULL) {
        reason = reserve(file->journal->fd, (off_t)bytes + RESERVE);
    }
    LAC_FAIL_IF(reason != 0, err, LAC_EIO, "%s: cannot write: %s", file->path, strerror(reason));
    return LAC_OK;
}

// Gives back the space that was reserved and not used.
static void end_reserve(const lac_nc *file)
{
    off_t size = file->fd >= 0 ? size_of(file->fd) : -1;
    int wasted = size >= 0 ? ftruncate(file->fd, size) : 0;
    (void)wasted;
}

lac_status lac_nc_create(lac_nc *file, const char *path, bool force, lac_error *err)
{
    *file = (lac_nc){.force = force, .fd = -1};
    bool exists = false;
    lac_status status;
    LAC_TRY_RETURN(lac_nc_path(path, &exists, err));
    LAC_FAIL_IF(exists && !force, err, LAC_EINPUT, "%s: exists", path);
    LAC_TRY_RETURN(lac_need_netcdf(err));
    LAC_FAIL_IF(exists && access(path, W_OK) != 0, err, LAC_EIO, "%s: cannot replace: %s", path,
                strerror(errno));
    LAC_FAIL_IF(exists && lac_nc_is_written(path), err, LAC_EIO,
                "%s: cannot replace: another process is writing it", path);
    file->path = exists ? realpath(path, NULL) : strdup(path); // through its links
    file->part = file->path != NULL ? lac_temp_file_name(file->path) : NULL;
    LAC_TRY(file->part != NULL ? LAC_OK : lac_fail_memory(err));
    file->replaces = exists;
    LAC_LEAVE_IF(exists && stat(file->path, &file->old) != 0, err, LAC_EIO, "%s: %s", file->path,
                 strerror(errno));
    lac_temp_file_sweep(file->path); // what killed ones left of this file
    (void)unlink(file->part);
    file->fd = open(file->part, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    LAC_LEAVE_IF(file->fd < 0, err, LAC_EIO, "%s: cannot create: %s", file->path, strerror(errno));
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

static bool stands_at(const char *path, const struct stat *own)
{
    struct stat info;
    return stat(path, &info) == 0 && info.st_dev == own->st_dev && info.st_ino == own->st_ino;
}

lac_status lac_nc_check_place(const lac_nc *file, lac_error *err)
{
    struct stat own;
    LAC_FAIL_IF(file->fd >= 0 && fstat(file->fd, &own) == 0 && !stands_at(file->path, &own), err,
                LAC_EIO, "%s: was replaced or removed while it was being written", file->path);
    return LAC_OK;
}

// Takes the place of the one file that was there, or of none.
static int take_place(const lac_nc *file)
{
    if (!file->replaces) {
        return lac_temp_file_publish(file->part, file->path, false);
    }
    // Of several that would take the same place one at a time looks who is there.
    int held = -1, failed = -1;
    if (!lac_temp_file_hold(file->path, &held)) {
        errno = EWOULDBLOCK;
        return failed;
    }
    errno = EEXIST;
    if (stands_at(file->path, &file->old)) {
        failed = lac_temp_file_publish(file->part, file->path, true);
    }
    lac_temp_file_close(held);
    return failed;
}

lac_status lac_nc_publish(lac_nc *file, lac_error *err)
{
    if (take_place(file) != 0) {
        LAC_FAIL_IF(errno == EEXIST, err, LAC_EINPUT, "%s: %s", file->path,
                    file->force ? "was replaced meanwhile by another process" : "exists");
        return lac_fail(err, LAC_EIO, "%s: cannot create: %s", file->path,
                        errno == EWOULDBLOCK ? "another process is writing there"
                                             : strerror(errno));
    }
    file->published = true;
    return file->journal != NULL ? lac_journal_publish(file->journal, file->path, err) : LAC_OK;
}

// Where HDF5 fails to write the journal must stay.
static int written(const lac_nc *file, int code)
{
    if (code != NC_NOERR && file->journal != NULL) {
        file->journal->needed = true;
    }
    return code;
}

int lac_nc_append(const lac_nc *file, nc_type type, int id, const size_t *start,
                  const size_t *count, const void *values)
{
    char name[NC_MAX_NAME + 1] = "";
    int rank = 0, code = NC_NOERR;
    if (file->journal != NULL) {
        code = nc_inq_var(file->id, id, name, NULL, &rank, NULL, NULL);
        code = code == NC_NOERR
                   ? lac_journal_put(file->journal, name, type, rank, start, count, values)
                   : code;
    }
    return code != NC_NOERR
               ? code
               : written(file, lac_nc_put_values(file->id, type, id, start, count, values));
}

static lac_status flush(const lac_nc *file, lac_error *err)
{
    errno = 0;
    return lac_nc_check(file->path, written(file, nc_sync(file->id)), err, "write", "");
}

lac_status lac_nc_sync(const lac_nc *file, lac_error *err)
{
    int code = file->journal != NULL
                   ? lac_journal_put(file->journal, "", NC_NAT, 0, NULL, NULL, NULL)
                   : NC_NOERR;
    return code == NC_NOERR ? flush(file, err) : lac_nc_check(file->path, code, err, "write", "");
}

lac_status lac_nc_to_disk(const lac_nc *file, lac_error *err)
{
    LAC_FAIL_IF((file->journal != NULL && fsync(file->journal->fd) != 0) ||
                    (file->fd >= 0 && fsync(file->fd) != 0),
                err, LAC_EIO, "%s: cannot write: %s", file->path, strerror(errno));
    return LAC_OK;
}

// The values are written and synced. Now the reserve is given back, by us: in HDF5's hands, which
// cut the file and only then say so in its first bytes, that would take a thousand times as long.
lac_status lac_nc_close(lac_nc *file, lac_error *err)
{
    end_reserve(file);
    lac_status flushed = flush(file, err);
    file->open = false;
    errno = 0;
    lac_status closed =
        lac_nc_check(file->path, nc_close(file->id), flushed == LAC_OK ? err : NULL, "close", "");
    bool whole =
        flushed == LAC_OK && closed == LAC_OK && (file->journal == NULL || !file->journal->needed);
    lac_status kept = whole ? lac_nc_to_disk(file, err) : LAC_OK;
    kept = whole && kept == LAC_OK && file->published ? lac_nc_check_place(file, err) : kept;
    whole = whole && kept == LAC_OK;
    if (whole && file->fd >= 0) {
        lac_nc_seal(file->fd);
    }
    lac_journal_free(file->journal, whole);
    file->journal = NULL;
    lac_temp_file_close(file->fd);
    file->fd = -1;
    return flushed != LAC_OK ? flushed : closed != LAC_OK ? closed : kept;
}

void lac_nc_clear(lac_nc *file)
{
    if (file->open) {
        (void)lac_nc_close(file, NULL);
    }
    end_reserve(file);
    lac_temp_file_close(file->fd);
    if (file->part != NULL && !file->published) {
        (void)unlink(file->part);
    }
    lac_journal_free(file->journal, !file->published);
    free(file->part);
    free(file->path);
    *file = (lac_nc){.fd = -1};
}
