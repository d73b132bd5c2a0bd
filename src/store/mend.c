// SPDX-License-Identifier: GPL-3.0-or-later
// A file that its writer did not close. Where a journal is beside it, that has all that was synced.
// An older one may have been cut while HDF5 closed it: HDF5 then gives back what it holds free at
// the end: it cuts the file, and only afterwards writes the new length into the superblock. In
// between the file seems truncated; with the bytes put back it can be read. Either is done in a
// copy: who reads a file does not change it.
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "store/input.h"
#include "store/store_file.h"

enum {
    GIVEN_BACK_MAX = 2 * 2048, // HDF5's two blocks of free space: of structure, of small data
    SUPERBLOCK = 36,           // up to and with the length
    VERSION = 8,
    WIDTH = 9, // of addresses
    FLAGS = 11,
    LENGTH = 28,
    BLOCK = 1 << 16, // bytes copied at once
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

// The length of a file that lacks what HDF5 has cut off; 0: it lacks nothing, or more than that.
static uint64_t length_of_cut(int fd)
{
    struct stat info;
    if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
        return 0;
    }
    uint64_t length = stated_length(fd);
    uint64_t size = (uint64_t)info.st_size;
    return length > size && length - size <= GIVEN_BACK_MAX ? length : 0;
}

lac_cut lac_nc_cut(const char *path, lac_store_loss *loss)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    *loss = (lac_store_loss){.own = -1};
    if (fd < 0) {
        return LAC_CUT_NONE;
    }
    lac_cut cut = lac_journal_waits(path, loss) ? LAC_CUT_JOURNAL
                  : length_of_cut(fd) > 0       ? LAC_CUT_SHORT
                                                : LAC_CUT_NONE;
    (void)close(fd);
    return cut;
}

bool lac_nc_is_written(const char *path)
{
    char journal[LAC_JOURNAL_NAME];
    return lac_temp_file_locked(AT_FDCWD, path) ||
           (lac_journal_name(path, journal) && lac_temp_file_locked(AT_FDCWD, journal));
}

bool lac_store_is_cut(const char *path)
{
    lac_store_loss loss;
    return !lac_nc_is_written(path) && lac_nc_cut(path, &loss) != LAC_CUT_NONE;
}

static bool copy_bytes(int from, int to)
{
    char *block = malloc(BLOCK);
    ssize_t got = -1;
    bool good = block != NULL;
    for (off_t at = 0; good && (got = pread(from, block, BLOCK, at)) > 0; at += got) {
        good = lac_temp_file_write(to, block, (size_t)got);
    }
    free(block);
    return good && got == 0;
}

static bool pad(const char *path, int to)
{
    int from = open(path, O_RDONLY | O_CLOEXEC);
    uint64_t length = from >= 0 ? length_of_cut(from) : 0;
    bool good = length > 0 && copy_bytes(from, to) && ftruncate(to, (off_t)length) == 0;
    lac_temp_file_close(from);
    return good;
}

// A new file, its owner's only as the file may be: `FOLDER/.NAME.mended.lacuna-PID.part`.
static int open_copy(const char *path, char **copy)
{
    char *name = lac_text_join(path, "", ".mended");
    *copy = name != NULL ? lac_temp_file_name(name) : NULL;
    int fd = -1;
    if (*copy != NULL) {
        lac_temp_file_sweep(name);
        (void)unlink(*copy);
        fd = open(*copy, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    }
    free(name);
    return fd;
}

// The same in the folder for temporary files, where the file's own cannot be written.
static int open_copy_elsewhere(const char *path, char **copy)
{
    const char *slash = strrchr(path, '/');
    char *name = lac_text_join("/tmp/", "", slash != NULL ? slash + 1 : path);
    free(*copy);
    *copy = NULL;
    int fd = name != NULL ? open_copy(name, copy) : -1;
    free(name);
    return fd;
}

// Records, or steps of a history: along the longest of the dimensions that grow.
static size_t records_of(int id)
{
    int dims[NC_MAX_DIMS];
    int n = 0;
    size_t longest = 0;
    if (nc_inq_unlimdims(id, &n, NULL) != NC_NOERR || n > NC_MAX_DIMS ||
        nc_inq_unlimdims(id, &n, dims) != NC_NOERR) {
        return 0;
    }
    for (int d = 0; d < n; d++) {
        size_t length = 0;
        (void)nc_inq_dimlen(id, dims[d], &length);
        longest = length > longest ? length : longest;
    }
    return longest;
}

// Those of a file as it is; -1: it cannot be opened.
static int64_t own_records(const char *path)
{
    struct stat info;
    int id = 0;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    int64_t records = -1;
    if (fd >= 0 && fstat(fd, &info) == 0 &&
        lac_nc_heap(path, fd, (size_t)info.st_size, NULL) == LAC_OK &&
        nc_open(path, NC_NOWRITE, &id) == NC_NOERR) {
        records = (int64_t)records_of(id);
        (void)nc_close(id);
    }
    lac_temp_file_close(fd);
    return records;
}

// Opened and closed once the copy is no unclosed file any more.
static int close_well(const char *path, lac_cut cut, const char *copy, uint64_t *records)
{
    int id = 0;
    int code = nc_open(copy, NC_WRITE, &id);
    if (code != NC_NOERR) {
        return code;
    }
    code = cut == LAC_CUT_JOURNAL ? lac_journal_replay(path, id) : NC_NOERR;
    *records = records_of(id);
    int closed = nc_close(id);
    return code == NC_NOERR ? closed : code;
}

static lac_status fill_copy(const char *path, lac_cut cut, int fd, const char *copy,
                            uint64_t *records, lac_error *err)
{
    struct stat info;
    LAC_FAIL_IF(!(cut == LAC_CUT_JOURNAL ? lac_journal_copy_base(path, fd) : pad(path, fd)) ||
                    fstat(fd, &info) != 0,
                err, LAC_EIO, "%s: was not closed, and a copy to read cannot be written: %s", path,
                strerror(errno));
    LAC_TRY_RETURN(lac_nc_heap(path, fd, (size_t)info.st_size, err));
    LAC_TRY_RETURN(lac_nc_check(path, close_well(path, cut, copy, records), err, "mend", "it"));
    lac_nc_seal(fd);
    return LAC_OK;
}

lac_status lac_nc_mended_copy(const char *path, bool beside, char **copy, lac_store_loss *loss,
                              lac_error *err)
{
    const lac_cut cut = lac_nc_cut(path, loss);
    *copy = NULL;
    loss->own = loss->damaged ? own_records(path) : -1;
    if (cut == LAC_CUT_NONE) {
        return LAC_OK;
    }
    lac_status status = LAC_OK;
    char *place = realpath(path, NULL);
    int fd = place != NULL ? open_copy(place, copy) : -1;
    fd = fd < 0 && *copy != NULL && !beside ? open_copy_elsewhere(place, copy) : fd;
    LAC_LEAVE_IF(fd < 0, err, LAC_EIO, "%s: was not closed, and a copy to read cannot be made: %s",
                 path, strerror(errno));
    LAC_TRY(fill_copy(place, cut, fd, *copy, &loss->records, err));
out:
    if (status != LAC_OK && fd >= 0) {
        (void)unlink(*copy);
    }
    lac_temp_file_close(fd);
    if (status != LAC_OK) {
        free(*copy);
        *copy = NULL;
    }
    free(place);
    return status;
}

bool lac_store_is_damaged(const char *path, lac_store_loss *loss)
{
    char *copy = NULL;
    if (lac_nc_is_written(path)) {
        return false;
    }
    (void)lac_nc_cut(path, loss);
    if (loss->damaged) {
        (void)lac_nc_mended_copy(path, false, &copy, loss, NULL);
    }
    if (copy != NULL) {
        (void)unlink(copy);
        free(copy);
    }
    return loss->damaged;
}

// What netCDF shows of the file must not become less.
static lac_status check_loss(const char *path, const char *copy, const lac_store_loss *loss,
                             lac_error *err)
{
    if (!loss->damaged || (copy != NULL && loss->own <= (int64_t)loss->records)) {
        return LAC_OK;
    }
    char own[64] = "cannot be opened without it";
    if (loss->own >= 0) {
        (void)snprintf(own, sizeof own, "shows %lld as it is", (long long)loss->own);
    }
    return lac_fail(err, LAC_EIO,
                    "%s.journal: is damaged: its last %llu bytes, from byte %llu on, cannot be "
                    "read; it gives %llu records, %s %s, nothing is changed",
                    path, (unsigned long long)loss->unread, (unsigned long long)loss->at,
                    (unsigned long long)loss->records, path, own);
}

// The copy takes the file's place, with its rights.
// @param replayed  it has all values of the file's journal, which is needed no more
static lac_status put_in_place(const char *path, const char *copy, bool replayed, lac_error *err)
{
    struct stat info;
    lac_status status = LAC_OK;
    char journal[LAC_JOURNAL_NAME];
    char *place = realpath(path, NULL);
    int fd = open(copy, O_RDONLY | O_CLOEXEC);
    LAC_LEAVE_IF(place == NULL || !lac_journal_name(path, journal) || fd < 0 ||
                     stat(place, &info) != 0 || fchmod(fd, info.st_mode & 07777) != 0 ||
                     fsync(fd) != 0 || rename(copy, place) != 0,
                 err, LAC_EIO, "%s: cannot be mended: %s", path, strerror(errno));
    lac_temp_file_sync_folder(place);
    if (replayed) {
        (void)unlink(journal);
    }
out:
    lac_temp_file_close(fd);
    free(place);
    return status;
}

lac_status lac_store_mend(const char *path, bool *mended, lac_error *err)
{
    lac_stored_file *in = NULL;
    lac_store_loss loss;
    char *copy = NULL;
    lac_status status = LAC_OK;
    *mended = false;
    LAC_LEAVE_IF(lac_nc_is_written(path), err, LAC_EIO, "%s: another process is writing it", path);
    const bool journal = lac_nc_cut(path, &loss) == LAC_CUT_JOURNAL;
    LAC_TRY(lac_nc_mended_copy(path, true, &copy, &loss, err));
    LAC_TRY(check_loss(path, copy, &loss, err));
    if (copy != NULL) {
        LAC_TRY(put_in_place(path, copy, journal && !loss.damaged, err));
        *mended = true;
    }
    LAC_TRY(lac_stored_file_open(path, &in, err));
out:
    lac_stored_file_close(in);
    if (copy != NULL && !*mended) {
        (void)unlink(copy);
    }
    free(copy);
    return status;
}
