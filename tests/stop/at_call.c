// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded before a program (LD_PRELOAD), it does something at the COUNT-th of the calls by which the
// program and its libraries change files:
//   AT_CALL=COUNT:ACTION[:CALLS[:ENDING]]
// COUNT   from 1, of the calls that match; 0: none
// ACTION  kill      the process is killed before the call
//         tear      half of what is written gets into the file, any other call is made; then as
//         kill fail=N    the call does nothing and returns the error N full=N    so do this call
//         and all later ones that could take room signal=N  the call is made; where it succeeds the
//         process gets the signal N
// CALLS   such as rename,fsync; nothing: all
// ENDING  of the path of the file; nothing: any
//   AT_CALL_UNDER=FOLDER  only files below it
//   AT_CALL_LOG=FILE      a line each: its number, name and path; and `synced time N` once netCDF
//   has
//                         brought N records into its file; so of steps, snapshots and events
// Processes that the program forks count on together.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

enum { NONE, KILL, TEAR, FAIL, FULL, SIGNAL };

static struct {
    long count;
    int action, number;
    char calls[200], ending[200], under[1000];
    int log;
    long *made; // shared with forked processes
} plan;

__attribute__((constructor)) static void read_plan(void)
{
    static const char *const words[] = {"", "kill", "tear", "fail", "full", "signal"};
    char word[32] = "";
    const char *text = getenv("AT_CALL");
    const char *under = getenv("AT_CALL_UNDER");
    const char *log = getenv("AT_CALL_LOG");
    plan.made =
        mmap(NULL, sizeof *plan.made, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    plan.log = log != NULL ? (int)syscall(SYS_openat, AT_FDCWD, log,
                                          O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)
                           : -1;
    if (text == NULL || plan.made == MAP_FAILED) {
        return;
    }
    const char *at = strchr(text, ':');
    plan.count = strtol(text, NULL, 10);
    (void)snprintf(plan.under, sizeof plan.under, "%s", under != NULL ? under : "");
    (void)sscanf(at != NULL ? at + 1 : "", "%31[a-z]=%d", word, &plan.number);
    for (int i = KILL; i <= SIGNAL; i++) {
        plan.action = strcmp(word, words[i]) == 0 ? i : plan.action;
    }
    const char *calls = at != NULL ? strchr(at + 1, ':') : NULL;
    if (calls != NULL) {
        const char *ending = strchr(calls + 1, ':');
        size_t length = ending != NULL ? (size_t)(ending - calls) - 1 : strlen(calls + 1);
        (void)snprintf(plan.calls, sizeof plan.calls, "%.*s", (int)length, calls + 1);
        (void)snprintf(plan.ending, sizeof plan.ending, "%s", ending != NULL ? ending + 1 : "");
    }
}

static int ends_in(const char *text, const char *ending)
{
    const size_t length = strlen(text), n = strlen(ending);
    return length >= n && strcmp(text + length - n, ending) == 0;
}

static int is_listed(const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = plan.calls; (at = strstr(at, name)) != NULL; at += length) {
        if ((at == plan.calls || at[-1] == ',') && (at[length] == ',' || at[length] == '\0')) {
            return 1;
        }
    }
    return plan.calls[0] == '\0';
}

static void say(const char *format, ...)
{
    char line[5000];
    va_list values;
    va_start(values, format);
    int length = vsnprintf(line, sizeof line, format, values);
    va_end(values);
    if (plan.log >= 0 && length > 0) {
        (void)syscall(SYS_write, plan.log, line, (size_t)length);
    }
}

static void end(void) { (void)syscall(SYS_kill, getpid(), SIGKILL); }

// What is to be done at a call of that name; NONE: make it.
static int look(const char *name, const char *path)
{
    if (plan.action == NONE || !is_listed(name) || !ends_in(path, plan.ending) ||
        strncmp(path, plan.under, strlen(plan.under)) != 0) {
        return NONE;
    }
    const long made =
        plan.action == SIGNAL ? 0 : __atomic_add_fetch(plan.made, 1, __ATOMIC_SEQ_CST);
    say("%ld %s %s\n", made, name, path);
    if (plan.action == FULL && plan.count > 0 && made >= plan.count) {
        return strcmp(name, "write") == 0 || strcmp(name, "open") == 0 ||
                       strcmp(name, "fallocate") == 0 || strcmp(name, "mkdir") == 0 ||
                       strcmp(name, "link") == 0
                   ? FAIL
                   : NONE;
    }
    return made == plan.count || plan.action == SIGNAL ? plan.action : NONE;
}

// The path of a descriptor of a regular file; "" of any other.
static const char *path_of(int fd, char *path, size_t size)
{
    char link[64];
    struct stat info;
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, path, size - 1);
    path[length > 0 ? length : 0] = '\0';
    if (ends_in(path, " (deleted)")) {
        path[length - 10] = '\0';
    }
    const int regular = fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
    return fd != plan.log && regular ? path : "";
}

static const char *full_path(const char *name, char *path, size_t size)
{
    char folder[2000] = "";
    if (name[0] != '/' && getcwd(folder, sizeof folder) != NULL) {
        (void)snprintf(path, size, "%s/%s", folder, name);
        return path;
    }
    return name;
}

static long fail(void)
{
    errno = plan.number;
    return -1;
}

// After a call: its result, or the end.
static long done(int what, long result)
{
    if (what == TEAR) {
        end();
    }
    if (what == SIGNAL && result >= 0 &&
        __atomic_add_fetch(plan.made, 1, __ATOMIC_SEQ_CST) == plan.count) {
        (void)raise(plan.number);
    }
    return result;
}

// A call that is made or not made.
#define CALL(name, path, ...)                                                   \
    do {                                                                        \
        const int what = look(name, path);                                      \
        if (what == KILL) {                                                     \
            end();                                                              \
        }                                                                       \
        return (int)(what == FAIL ? fail() : done(what, syscall(__VA_ARGS__))); \
    } while (0)

static long write_some(int fd, const void *bytes, size_t size, off_t offset)
{
    char path[4096];
    const int what = *path_of(fd, path, sizeof path) != '\0' ? look("write", path) : NONE;
    const size_t part = what == TEAR ? size / 2 : size;
    if (what == KILL) {
        end();
    }
    if (what == FAIL) {
        return fail();
    }
    return done(what, offset < 0 ? syscall(SYS_write, fd, bytes, part)
                                 : syscall(SYS_pwrite64, fd, bytes, part, offset));
}

EXPORT ssize_t write(int fd, const void *bytes, size_t size)
{
    return write_some(fd, bytes, size, -1);
}

EXPORT ssize_t pwrite64(int fd, const void *bytes, size_t size, off_t offset)
{
    return write_some(fd, bytes, size, offset);
}

EXPORT ssize_t pwrite(int fd, const void *bytes, size_t size, off_t offset)
{
    return write_some(fd, bytes, size, offset);
}

static long open_some(int folder, const char *name, int flags, unsigned mode)
{
    char path[4096];
    if ((flags & (O_CREAT | O_TRUNC)) == 0) {
        return syscall(SYS_openat, folder, name, flags, mode);
    }
    CALL("open", full_path(name, path, sizeof path), SYS_openat, folder, name, flags, mode);
}

static unsigned mode_of(int flags, va_list values)
{
    return (flags & O_CREAT) != 0 ? va_arg(values, unsigned) : 0;
}

#define OPEN(function)                                      \
    EXPORT int function(const char *name, int flags, ...)   \
    {                                                       \
        va_list values;                                     \
        va_start(values, flags);                            \
        const unsigned mode = mode_of(flags, values);       \
        va_end(values);                                     \
        return (int)open_some(AT_FDCWD, name, flags, mode); \
    }

OPEN(open)
OPEN(open64)

#define OF_FD(name, function, arguments, ...)          \
    EXPORT int function arguments                      \
    {                                                  \
        char path[4096];                               \
        if (*path_of(fd, path, sizeof path) == '\0') { \
            return (int)syscall(__VA_ARGS__);          \
        }                                              \
        CALL(name, path, __VA_ARGS__);                 \
    }

OF_FD("ftruncate", ftruncate, (int fd, off_t size), SYS_ftruncate, fd, size)
OF_FD("ftruncate", ftruncate64, (int fd, off_t size), SYS_ftruncate, fd, size)
OF_FD("fsync", fsync, (int fd), SYS_fsync, fd)
OF_FD("fsync", fdatasync, (int fd), SYS_fdatasync, fd)
OF_FD("fallocate", fallocate, (int fd, int mode, off_t at, off_t size), SYS_fallocate, fd, mode, at,
      size)
OF_FD("fallocate", fallocate64, (int fd, int mode, off_t at, off_t size), SYS_fallocate, fd, mode,
      at, size)

// One that fails closes all the same.
EXPORT int close(int fd)
{
    char path[4096];
    const int flags = (int)syscall(SYS_fcntl, fd, F_GETFL);
    const int writes = flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
    const int what = writes && *path_of(fd, path, sizeof path) != '\0' ? look("close", path) : NONE;
    if (what == KILL) {
        end();
    }
    const long result = done(what, syscall(SYS_close, fd));
    return (int)(what == FAIL ? fail() : result);
}

// A lock changes no file, so that it counts only where it is asked for by name.
EXPORT int flock(int fd, int operation)
{
    char path[4096];
    if (plan.calls[0] == '\0' || *path_of(fd, path, sizeof path) == '\0') {
        return (int)syscall(SYS_flock, fd, operation);
    }
    CALL("flock", path, SYS_flock, fd, operation);
}

EXPORT int rename(const char *from, const char *to)
{
    char path[4096];
    CALL("rename", full_path(to, path, sizeof path), SYS_rename, from, to);
}

EXPORT int link(const char *from, const char *to)
{
    char path[4096];
    CALL("link", full_path(to, path, sizeof path), SYS_link, from, to);
}

EXPORT int unlink(const char *name)
{
    char path[4096];
    CALL("unlink", full_path(name, path, sizeof path), SYS_unlink, name);
}

EXPORT int mkdir(const char *name, mode_t mode)
{
    char path[4096];
    CALL("mkdir", full_path(name, path, sizeof path), SYS_mkdir, name, mode);
}

// What a sync has promised: how much is in the file by then.
EXPORT int nc_sync(int id)
{
    static const char *const names[] = {"time", "step", "snapshot", "event"};
    int (*sync)(int) = (int (*)(int))dlsym(RTLD_NEXT, "nc_sync");
    int (*find)(int, const char *, int *) =
        (int (*)(int, const char *, int *))dlsym(RTLD_NEXT, "nc_inq_dimid");
    int (*count)(int, int, size_t *) =
        (int (*)(int, int, size_t *))dlsym(RTLD_NEXT, "nc_inq_dimlen");
    const int code = sync(id);
    for (size_t i = 0; code == 0 && i < sizeof names / sizeof *names; i++) {
        int dim;
        size_t length;
        if (find(id, names[i], &dim) == 0 && count(id, dim, &length) == 0) {
            say("synced %s %zu\n", names[i], length);
        }
    }
    return code;
}
