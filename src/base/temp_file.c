// SPDX-License-Identifier: GPL-3.0-or-later
// The names under which files are built, and what a killed process left under one.
#define _GNU_SOURCE // F_OFD_SETLK
#include "base/temp_file.h"

#include <ctype.h>
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

enum { NAME_KEPT = 200, NUMBER = 24 }; // with the rest below the 255 bytes of a name
enum { HOLD_TRIES = 100 };

static const char middle[] = ".lacuna-";
static const char ending[] = ".part";

size_t lac_folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? (size_t)(slash - path) + 1 : 0;
}

const char *lac_path_last(const char *path) { return path + lac_folder_length(path); }

char *lac_folder_of(const char *path)
{
    const size_t length = lac_folder_length(path);
    return length > 0 ? strndup(path, length) : strdup("./");
}

char *lac_temp_file_name(const char *path)
{
    const int folder = (int)lac_folder_length(path);
    size_t size = strlen(path) + sizeof middle + sizeof ending + NUMBER;
    char *part = malloc(size);
    if (part != NULL) {
        (void)snprintf(part, size, "%.*s.%.*s%s%ld%s", folder, path, NAME_KEPT, path + folder,
                       middle, (long)getpid(), ending);
    }
    return part;
}

// The process that made a part of the file of that name; 0: it is none.
static pid_t maker_of(const char *part, const char *name)
{
    size_t kept = strnlen(name, NAME_KEPT);
    if (part[0] != '.' || strncmp(part + 1, name, kept) != 0) {
        return 0;
    }
    const char *rest = part + 1 + kept;
    if (strncmp(rest, middle, sizeof middle - 1) != 0) {
        return 0;
    }
    const char *number = rest + sizeof middle - 1;
    char *end;
    errno = 0;
    long pid = strtol(number, &end, 10);
    bool sound = isdigit((unsigned char)*number) && errno == 0 && pid > 0 && (pid_t)pid == pid;
    return sound && strcmp(end, ending) == 0 ? (pid_t)pid : 0;
}

static bool is_dead(pid_t pid) { return kill(pid, 0) != 0 && errno == ESRCH; }

char *lac_text_join(const char *first, const char *between, const char *second)
{
    const size_t size = strlen(first) + strlen(between) + strlen(second) + 1;
    char *text = malloc(size);
    if (text != NULL) {
        (void)snprintf(text, size, "%s%s%s", first, *first != '\0' ? between : "", second);
    }
    return text;
}

bool lac_temp_file_write(int fd, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    while (size > 0) {
        ssize_t done = write(fd, at, size);
        if (done < 0 && errno == EINTR) {
            continue;
        }
        if (done <= 0) {
            errno = done == 0 ? ENOSPC : errno;
            return false;
        }
        at += done;
        size -= (size_t)done;
    }
    return true;
}

void lac_temp_file_sync_folder(const char *path)
{
    char *name = lac_folder_of(path);
    int fd = name != NULL ? open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    free(name);
    if (fd >= 0) {
        (void)fsync(fd);
        (void)close(fd);
    }
}

bool lac_temp_file_hold(const char *path, int *held)
{
    const struct timespec pause = {.tv_nsec = 10000000};
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    bool free_now = false;
    *held = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    for (int k = 0; k < HOLD_TRIES && !free_now; k++) {
        // Where the file system has no locks, nobody waits.
        free_now = *held < 0 || fcntl(*held, F_OFD_SETLK, &lock) == 0 ||
                   (errno != EAGAIN && errno != EACCES);
        if (!free_now) {
            (void)nanosleep(&pause, NULL);
        }
    }
    if (!free_now) {
        lac_temp_file_close(*held);
        *held = -1;
    }
    return free_now;
}

void lac_temp_file_close(int fd)
{
    const int reason = errno;
    if (fd >= 0) {
        (void)close(fd);
    }
    errno = reason;
}

bool lac_temp_file_locked(int folder, const char *path)
{
    int fd = openat(folder, path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) {
        return false;
    }
    bool locked = flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    (void)close(fd);
    return locked;
}

void lac_temp_file_sweep(const char *path)
{
    char *name = lac_folder_of(path);
    const char *base = lac_path_last(path);
    DIR *folder = name != NULL ? opendir(name) : NULL;
    const struct dirent *entry = NULL;
    while (folder != NULL && (entry = readdir(folder)) != NULL) {
        pid_t pid = maker_of(entry->d_name, base);
        if (pid > 0 && is_dead(pid) && !lac_temp_file_locked(dirfd(folder), entry->d_name)) {
            (void)unlinkat(dirfd(folder), entry->d_name, 0);
        }
    }
    if (folder != NULL) {
        (void)closedir(folder);
    }
    free(name);
}

// link() refuses a name that is taken, which rename() does not; some file systems lack it.
static int name_exclusively(const char *part, const char *path)
{
    if (link(part, path) == 0) {
        return unlink(part);
    }
    if (errno == EEXIST) {
        return -1;
    }
    if (access(path, F_OK) == 0) {
        errno = EEXIST;
        return -1;
    }
    return rename(part, path);
}

int lac_temp_file_publish(const char *part, const char *path, bool force)
{
    return force ? rename(part, path) : name_exclusively(part, path);
}
