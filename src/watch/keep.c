// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a watch go on as if nothing had been: the state, in which all is known up to some
// line; the journal, which has the lines of standard input since; the output, which is cut to what
// the state knows of it. DIR/state takes its name when it is whole and on the disk; then a new
// journal begins, whose number the state has.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "watch/internal.h"

enum { NUMBER = 40 };

static lac_status refuse_file(const char *path, lac_error *err)
{
    return lac_fail(err, LAC_EIO, "%s: %s", path, strerror(errno));
}

static char *name_of(const lac_watch *w, const char *file, uint64_t number)
{
    const size_t size = strlen(w->def.state) + strlen(file) + NUMBER;
    char *name = malloc(size);
    if (name != NULL) {
        (void)snprintf(name, size, number > 0 ? "%s/%s-%" PRIu64 : "%s/%s", w->def.state, file,
                       number);
    }
    return name;
}

// One at a time; the lock goes with the process, however it ends.
static lac_status lock(lac_watch *w, lac_error *err)
{
    lac_status status = LAC_OK;
    LAC_FAIL_IF(mkdir(w->def.state, 0777) != 0 && errno != EEXIST, err, LAC_EIO, "%s: %s",
                w->def.state, strerror(errno));
    char *name = name_of(w, "lock", 0);
    LAC_FAIL_MEMORY_IF(name == NULL, err);
    w->lock = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (w->lock < 0) {
        status = refuse_file(name, err);
    } else if (flock(w->lock, LOCK_EX | LOCK_NB) != 0) {
        status = lac_fail(err, LAC_EIO, "%s: another lacuna watch goes on there", w->def.state);
    }
    free(name);
    return status;
}

static lac_status open_output(lac_watch *w, bool found, int64_t length, lac_error *err)
{
    const char *path = w->def.output;
    struct stat info;
    if (path == NULL) {
        return LAC_OK;
    }
    const bool there = stat(path, &info) == 0;
    LAC_FAIL_IF(there && !S_ISREG(info.st_mode), err, LAC_EIO, "%s: is not a regular file", path);
    LAC_FAIL_IF(there && !found && info.st_size > 0 && !w->def.force, err, LAC_EINPUT,
                "%s: exists already, and no state goes on from it; --force replaces it", path);
    LAC_FAIL_IF(found && (!there || info.st_size < length), err, LAC_EINPUT,
                "%s: is not the output that %s goes on from, which has %" PRId64 " bytes", path,
                w->def.state, length);
    const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    LAC_FAIL_IF(fd < 0, err, LAC_EIO, "%s: %s", path, strerror(errno));
    const bool good = ftruncate(fd, length) == 0 && lseek(fd, length, SEEK_SET) == length;
    w->out = good ? fdopen(fd, "wb") : NULL;
    if (w->out == NULL) {
        const lac_status status = refuse_file(path, err);
        (void)close(fd);
        return status;
    }
    w->owned = true;
    return LAC_OK;
}

static lac_status open_journal(lac_watch *w, lac_error *err)
{
    lac_status status = LAC_OK;
    char *name = name_of(w, "journal", w->generation);
    LAC_FAIL_MEMORY_IF(name == NULL, err);
    w->journal = open(name, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    status = w->journal < 0 ? refuse_file(name, err) : LAC_OK;
    free(name);
    return status;
}

static void remove_journal(const lac_watch *w, uint64_t generation)
{
    char *name = generation > 0 ? name_of(w, "journal", generation) : NULL;
    if (name != NULL) {
        (void)unlink(name);
    }
    free(name);
}

// What stands in the journal before lines: their bytes, and the time that it was when they came.
typedef struct piece {
    double now;
    uint64_t left;
} piece;

// Does the lines of the journal again, each at its time; what a kill left of the last one is not
// taken.
static lac_status replay(lac_watch *w, lac_error *err)
{
    char bytes[4096];
    piece p;
    int64_t at = 0;
    ssize_t n = 0;
    const int journal = w->journal;
    const uint64_t before = w->counts.lines;
    lac_status status = LAC_OK;
    w->journal = -1; // what is in it is not noted again
    while (status == LAC_OK && (n = pread(journal, &p, sizeof p, at)) == (ssize_t)sizeof p) {
        w->now = p.now;
        at += n;
        while (status == LAC_OK && p.left > 0 &&
               (n = pread(journal, bytes, p.left < sizeof bytes ? p.left : sizeof bytes, at)) > 0) {
            p.left -= (uint64_t)n;
            at += n;
            status = lac_watch_stream(w, bytes, (size_t)n, err);
        }
    }
    w->journal = journal;
    w->now = NAN;
    w->waiting = 0;
    w->counts.restored = w->counts.lines - before;
    return status == LAC_OK && n < 0 ? refuse_file(w->def.state, err) : status;
}

lac_status lac_watch_note(lac_watch *w, const char *bytes, size_t n, lac_error *err)
{
    const piece p = {.now = w->now, .left = n};
    LAC_FAIL_IF(w->journal >= 0 && n > 0 &&
                    !(lac_temp_file_write(w->journal, (const void *)&p, sizeof p) &&
                      lac_temp_file_write(w->journal, bytes, n)),
                err, LAC_EIO, "%s/journal-%" PRIu64 ": %s", w->def.state, w->generation,
                strerror(errno));
    return LAC_OK;
}

void lac_watch_forget(lac_watch *w)
{
    if (w->journal >= 0 && ftruncate(w->journal, 0) != 0) {
        remove_journal(w, w->generation);
    }
}

lac_status lac_watch_flush(lac_watch *w, bool sync, lac_error *err)
{
    const char *path = w->def.output != NULL ? w->def.output : "standard output";
    errno = 0;
    const bool failed = fflush(w->out) != 0 || ferror(w->out) != 0;
    LAC_FAIL_IF(failed || (sync && w->owned && fsync(fileno(w->out)) != 0), err, LAC_EIO, "%s: %s",
                path, errno != 0 ? strerror(errno) : "could not be written");
    return LAC_OK;
}

lac_status lac_watch_checkpoint(lac_watch *w, lac_error *err)
{
    char *name = NULL;
    lac_status status;
    LAC_TRY_RETURN(lac_watch_flush(w, w->def.state != NULL, err));
    if (w->def.state == NULL) {
        w->since = 0;
        w->opened = false;
        return LAC_OK;
    }
    name = name_of(w, "state", 0);
    LAC_FAIL_MEMORY_IF(name == NULL, err);
    w->generation++;
    LAC_TRY(lac_state_write(w, name, w->owned ? (int64_t)ftello(w->out) : 0, err));
    if (w->journal >= 0) {
        (void)close(w->journal);
        w->journal = -1;
    }
    LAC_TRY(open_journal(w, err));
    remove_journal(w, w->generation - 1);
    w->since = 0;
    w->opened = false;
out:
    free(name);
    return status;
}

lac_status lac_watch_open(lac_watch *w, lac_error *err)
{
    bool found = false;
    int64_t length = 0;
    char *name = NULL;
    lac_status status = LAC_OK;
    if (w->def.state != NULL) {
        LAC_TRY(lock(w, err));
        name = name_of(w, "state", 0);
        LAC_TRY(name != NULL ? LAC_OK : lac_fail_memory(err));
        lac_temp_file_sweep(name);
        LAC_TRY(lac_state_read(w, name, &found, &length, err));
    }
    LAC_TRY(lac_watch_find_files(w, err));
    LAC_TRY(open_output(w, found, length, err));
    if (found) {
        remove_journal(w, w->generation - 1);
        LAC_TRY(open_journal(w, err));
        LAC_TRY(replay(w, err));
        w->skip = w->def.fleet->stream == LAC_STREAM_REPLAYED ? w->counts.lines : 0;
    }
    LAC_TRY(w->def.state != NULL ? lac_watch_checkpoint(w, err) : LAC_OK);
out:
    free(name);
    return status;
}
