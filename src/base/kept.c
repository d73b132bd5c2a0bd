// SPDX-License-Identifier: GPL-3.0-or-later
// Records of what is done so far. What was torn is cut away.
#include "base/kept.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/archive.h"
#include "base/temp_file.h"

enum { LINE = 64 };

struct lac_kept {
    int fd;
    bool reading;   // records may still come
    bool cut;       // nothing is behind `at`
    off_t head, at; // behind the first line, behind the last record
    char *path;
};

// The first line; @return how much of it says whose it is
static size_t write_head(char head[LINE], const char *whose, uint64_t of)
{
    const int n = snprintf(head, LINE, "lacuna %s 1 ", whose);
    (void)snprintf(head + n, (size_t)(LINE - n), "%016" PRIx64 "\n", of);
    return (size_t)n;
}

// Whether a file begins as one of these, or as far as the first line got.
static bool begins_so(int fd, const char *head, size_t whose)
{
    char found[LINE];
    const ssize_t n = pread(fd, found, whose, 0);
    return n >= 0 && memcmp(found, head, (size_t)n) == 0;
}

bool lac_kept_is_of(int folder, const char *name, const char *whose)
{
    char head[LINE];
    struct stat info;
    const size_t known = write_head(head, whose, 0);
    const int fd = openat(folder, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    const bool is =
        fd >= 0 && fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && begins_so(fd, head, known);
    lac_temp_file_close(fd);
    return is;
}

int lac_kept_file(const lac_kept *kept) { return kept != NULL ? kept->fd : -1; }

bool lac_kept_has_none(const lac_kept *kept)
{
    return kept != NULL && kept->at == kept->head && !kept->reading;
}

void lac_kept_close(lac_kept *kept, bool remove)
{
    if (kept != NULL) {
        if (remove && kept->fd >= 0) {
            (void)unlink(kept->path);
        }
        lac_temp_file_close(kept->fd);
        free(kept->path);
        free(kept);
    }
}

static lac_status say(const lac_kept *kept, bool resume, lac_error *err)
{
    return lac_fail(err, LAC_EIO, "%s%s: %s", resume ? "--resume: " : "", kept->path,
                    errno != 0 ? strerror(errno) : "could not be written");
}

// What stands at the beginning: of these records to go on from them, of any such command to begin
// anew.
static lac_status look(lac_kept *kept, const char *whose, uint64_t of, bool resume, lac_error *err)
{
    char head[LINE], found[LINE] = "";
    const size_t known = write_head(head, whose, of), size = strlen(head);
    LAC_FAIL_IF(!begins_so(kept->fd, head, known), err, LAC_EINPUT,
                "%s: was not written by %s; move it away", kept->path, whose);
    kept->reading = resume && pread(kept->fd, found, size, 0) == (ssize_t)size;
    LAC_FAIL_IF(kept->reading && memcmp(found, head, size) != 0, err, LAC_EINPUT,
                "--resume: %s: is of another case, or of other readings, settings or options; "
                "without --resume the %s begins anew",
                kept->path, whose);
    kept->at = kept->head = (off_t)size;
    errno = 0;
    const bool good =
        kept->reading || (ftruncate(kept->fd, 0) == 0 && lac_temp_file_write(kept->fd, head, size));
    return good ? LAC_OK : say(kept, resume, err);
}

lac_status lac_kept_open(const char *path, const char *whose, uint64_t of, bool resume,
                         lac_kept **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_kept *kept = calloc(1, sizeof *kept);
    *out = NULL;
    LAC_FAIL_MEMORY_IF(kept == NULL, err);
    kept->fd = -1;
    kept->path = strdup(path);
    LAC_TRY(kept->path != NULL ? LAC_OK : lac_fail_memory(err));
    kept->fd =
        open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | (resume ? 0 : O_CREAT), 0666);
    LAC_TRY(kept->fd >= 0 ? LAC_OK : say(kept, resume, err));
    LAC_TRY(flock(kept->fd, LOCK_EX | LOCK_NB) == 0
                ? LAC_OK
                : lac_fail(err, LAC_EINPUT, "%s: another %s is at work there", path, whose));
    LAC_TRY(look(kept, whose, of, resume, err));
    *out = kept;
    kept = NULL;
out:
    lac_kept_close(kept, false);
    return status;
}

bool lac_kept_read(lac_kept *kept, void *bytes, size_t size)
{
    uint64_t sum = 0;
    if (kept == NULL || !kept->reading) {
        return false;
    }
    void *found = malloc(size); // a torn one leaves `bytes` as they are
    kept->reading = found != NULL && pread(kept->fd, found, size, kept->at) == (ssize_t)size &&
                    pread(kept->fd, &sum, sizeof sum, kept->at + (off_t)size) == sizeof sum &&
                    sum == lac_sum_bytes(LAC_SUM_OF_NOTHING, found, size);
    if (kept->reading) {
        memcpy(bytes, found, size);
        kept->at += (off_t)(size + sizeof sum);
    }
    free(found);
    return kept->reading;
}

lac_status lac_kept_put(lac_kept *kept, const void *bytes, size_t size, lac_error *err)
{
    if (kept == NULL) {
        return LAC_OK;
    }
    const uint64_t sum = lac_sum_bytes(LAC_SUM_OF_NOTHING, bytes, size);
    errno = 0;
    kept->reading = false;
    kept->cut = kept->cut || (ftruncate(kept->fd, kept->at) == 0 &&
                              lseek(kept->fd, kept->at, SEEK_SET) == kept->at);
    kept->cut = kept->cut && lac_temp_file_write(kept->fd, bytes, size) &&
                lac_temp_file_write(kept->fd, &sum, sizeof sum);
    LAC_TRY_RETURN(kept->cut ? LAC_OK : say(kept, false, err));
    kept->at += (off_t)(size + sizeof sum);
    return LAC_OK;
}

lac_status lac_kept_sync(lac_kept *kept, lac_error *err)
{
    return fsync(kept->fd) == 0 ? LAC_OK : say(kept, false, err);
}
