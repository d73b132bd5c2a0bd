// SPDX-License-Identifier: GPL-3.0-or-later
// A text file that is never half there: it is written under another name, then takes its place.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temp_file.h"

// The file that a symbolic link leads to. A name that is taken over must be a file's: a device or
// a pipe would be gone.
static lac_status find_place(const char *path, char **place, lac_error *err)
{
    struct stat info;
    const bool exists = stat(path, &info) == 0;
    LAC_FAIL_IF(exists && !S_ISREG(info.st_mode), err, LAC_EIO, "%s: is %s", path,
                S_ISDIR(info.st_mode) ? "a folder" : "not a regular file");
    *place = exists ? realpath(path, NULL) : strdup(path);
    return *place != NULL ? LAC_OK : lac_fail_memory(err);
}

// A lock tells that the part is being written, also to who sees no process of that number.
bool lac_temp_file_fill(const char *part, const void *bytes, size_t size, const void *more,
                        size_t more_size)
{
    const int fd = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0) {
        return false;
    }
    (void)flock(fd, LOCK_EX | LOCK_NB);
    const bool good = lac_temp_file_write(fd, bytes, size) &&
                      lac_temp_file_write(fd, more, more_size) && fsync(fd) == 0;
    const int why = errno;
    const bool closed = close(fd) == 0;
    errno = good ? errno : why;
    return good && closed;
}

lac_status lac_write_bytes(const char *path, const void *bytes, size_t size, bool force,
                           lac_error *err)
{
    char *place = NULL, *part = NULL;
    lac_status status;
    LAC_TRY(find_place(path, &place, err));
    part = lac_temp_file_name(place);
    LAC_TRY(part != NULL ? LAC_OK : lac_fail_memory(err));
    lac_temp_file_sweep(place);
    (void)unlink(part); // of a process of this number that is no more
    if (!lac_temp_file_fill(part, bytes, size, NULL, 0) ||
        lac_temp_file_publish(part, place, force) != 0) {
        const int why = errno;
        (void)unlink(part);
        status = why == EEXIST
                     ? lac_fail(err, LAC_EINPUT, "%s: exists already; --force replaces it", path)
                     : lac_fail(err, LAC_EIO, "%s: cannot be written: %s", path, strerror(why));
    }
out:
    free(part);
    free(place);
    return status;
}

lac_status lac_write_text(const char *path, const char *text, bool force, lac_error *err)
{
    return lac_write_bytes(path, text, strlen(text), force, err);
}

char *lac_text_made(FILE *out, char **text)
{
    const bool failed = ferror(out) != 0;
    if (fclose(out) != 0 || failed) {
        free(*text);
        *text = NULL;
    }
    return *text;
}
