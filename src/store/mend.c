// SPDX-License-Identifier: GPL-3.0-or-later
// A file that its writer did not close: the journal beside it has all that was synced. It is put
// into a copy, as who reads a file does not change it.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/need.h"
#include "base/temp_file.h"
#include "store/input.h"

bool lac_nc_is_written(const char *path)
{
    char journal[LAC_JOURNAL_NAME];
    return lac_temp_file_locked(AT_FDCWD, path) ||
           (lac_journal_name(path, journal) && lac_temp_file_locked(AT_FDCWD, journal));
}

bool lac_store_is_cut(const char *path)
{
    lac_store_loss loss;
    return !lac_nc_is_written(path) && lac_journal_waits(path, &loss);
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
    char *name = lac_text_join("/tmp/", "", lac_path_last(path));
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
        lac_need_netcdf(NULL) == LAC_OK && nc_open(path, NC_NOWRITE, &id) == NC_NOERR) {
        records = (int64_t)records_of(id);
        (void)nc_close(id);
    }
    lac_temp_file_close(fd);
    return records;
}

// Opened and closed once the copy is no unclosed file any more.
static int close_well(const char *path, const char *copy, uint64_t *records)
{
    int id = 0;
    int code = nc_open(copy, NC_WRITE, &id);
    if (code != NC_NOERR) {
        return code;
    }
    code = lac_journal_replay(path, id);
    *records = records_of(id);
    int closed = nc_close(id);
    return code == NC_NOERR ? closed : code;
}

static lac_status fill_copy(const char *path, int fd, const char *copy, uint64_t *records,
                            lac_error *err)
{
    struct stat info;
    LAC_FAIL_IF(!lac_journal_copy_base(path, fd) || fstat(fd, &info) != 0, err, LAC_EIO,
                "%s: was not closed, and a copy to read cannot be written: %s", path,
                strerror(errno));
    LAC_TRY_RETURN(lac_nc_heap(path, fd, (size_t)info.st_size, err));
    LAC_TRY_RETURN(lac_need_netcdf(err));
    LAC_TRY_RETURN(lac_nc_check(path, close_well(path, copy, records), err, "mend", "it"));
    lac_nc_seal(fd);
    return LAC_OK;
}

lac_status lac_nc_mended_copy(const char *path, bool beside, char **copy, lac_store_loss *loss,
                              lac_error *err)
{
    const bool waits = lac_journal_waits(path, loss);
    *copy = NULL;
    loss->own = loss->damaged ? own_records(path) : -1;
    if (!waits) {
        return LAC_OK;
    }
    lac_status status = LAC_OK;
    char *place = realpath(path, NULL);
    int fd = place != NULL ? open_copy(place, copy) : -1;
    fd = fd < 0 && *copy != NULL && !beside ? open_copy_elsewhere(place, copy) : fd;
    LAC_LEAVE_IF(fd < 0, err, LAC_EIO, "%s: was not closed, and a copy to read cannot be made: %s",
                 path, strerror(errno));
    LAC_TRY(fill_copy(place, fd, *copy, &loss->records, err));
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
    (void)lac_journal_waits(path, loss);
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
// @param replayed  it has all of the journal, which is needed no more
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
    LAC_TRY(lac_nc_mended_copy(path, true, &copy, &loss, err));
    LAC_TRY(check_loss(path, copy, &loss, err));
    if (copy != NULL) {
        LAC_TRY(put_in_place(path, copy, !loss.damaged, err));
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
