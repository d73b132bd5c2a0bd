// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of a sampler beside the output that it is for, so that one which was killed goes on: a
// line that says what they are of, then records of one size, each with its sum behind it. What was
// torn is cut away.
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/archive.h"
#include "base/temp_file.h"
#include "fit/sampler.h"

static const char heading[] = "lacuna fit 1 ";
enum { HEADING = sizeof heading - 1, HEAD = HEADING + 17 };

struct lac_kept {
    int fd;
    bool reading; // records may still come
    off_t at;     // behind the last record
    char *path;
};

void lac_kept_close(lac_kept *kept, bool remove)
{
    if (kept != NULL) {
        const bool empty = kept->at == HEAD && !kept->reading;
        if ((remove || empty) && kept->fd >= 0) {
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

// What stands at the beginning: of these draws to go on from them, of any fit to begin anew.
static lac_status look(lac_kept *kept, const char *head, bool resume, lac_error *err)
{
    char found[HEAD + 1] = "";
    const ssize_t n = pread(kept->fd, found, HEAD, 0);
    const size_t known = n < HEADING ? (size_t)(n > 0 ? n : 0) : HEADING;
    LAC_FAIL_IF(n < 0 || strncmp(found, heading, known) != 0, err, LAC_EINPUT,
                "%s: no fit wrote that; move it away", kept->path);
    kept->reading = resume && n == HEAD;
    LAC_FAIL_IF(kept->reading && memcmp(found, head, HEAD) != 0, err, LAC_EINPUT,
                "--resume: %s: is of another case, of other readings or of other settings than "
                "fit.burn, fit.steps and fit.rounds; without --resume the fit begins anew",
                kept->path);
    kept->at = HEAD;
    errno = 0;
    const bool good =
        kept->reading || (ftruncate(kept->fd, 0) == 0 && lac_temp_file_write(kept->fd, head, HEAD));
    return good ? LAC_OK : say(kept, resume, err);
}

lac_status lac_kept_open(const char *path, uint64_t of, bool resume, lac_kept **out, lac_error *err)
{
    char head[HEAD + 1];
    lac_status status = LAC_OK;
    lac_kept *kept = calloc(1, sizeof *kept);
    *out = NULL;
    LAC_FAIL_MEMORY_IF(kept == NULL, err);
    kept->fd = -1;
    kept->path = strdup(path);
    LAC_TRY(kept->path != NULL ? LAC_OK : lac_fail_memory(err));
    (void)snprintf(head, sizeof head, "%s%016" PRIx64 "\n", heading, of);
    kept->fd =
        open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK | (resume ? 0 : O_CREAT), 0666);
    LAC_TRY(kept->fd >= 0 ? LAC_OK : say(kept, resume, err));
    LAC_TRY(flock(kept->fd, LOCK_EX | LOCK_NB) == 0
                ? LAC_OK
                : lac_fail(err, LAC_EINPUT, "%s: another fit is at work there", path));
    LAC_TRY(look(kept, head, resume, err));
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
    LAC_TRY_RETURN(ftruncate(kept->fd, kept->at) == 0 &&
                           lseek(kept->fd, kept->at, SEEK_SET) == kept->at &&
                           lac_temp_file_write(kept->fd, bytes, size) &&
                           lac_temp_file_write(kept->fd, &sum, sizeof sum)
                       ? LAC_OK
                       : say(kept, false, err));
    kept->at += (off_t)(size + sizeof sum);
    return LAC_OK;
}
