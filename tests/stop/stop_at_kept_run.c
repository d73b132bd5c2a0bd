// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded before a trade (LD_PRELOAD), it sends the trade a signal once a run has been kept:
//   STOP_AT_KEPT_RUN=COUNT:SIGNAL
// A test that watched the file would come too late where the machine is busy.
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static int ends_in(const char *text, long length, const char *ending)
{
    const long n = (long)strlen(ending);
    return length >= n && strncmp(text + length - n, ending, (size_t)n) == 0;
}

// Before the C library's: what the program calls once a line is written.
__attribute__((visibility("default"))) int fsync(int fd)
{
    static int kept;
    char link[64], path[4096];
    long failed = syscall(SYS_fsync, fd);
    int count = 0, number = 0;
    const char *asked = getenv("STOP_AT_KEPT_RUN");
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    long length = (long)readlink(link, path, sizeof path);
    if (failed == 0 && asked != NULL && length > 0 && ends_in(path, length, ".runs/done") &&
        sscanf(asked, "%d:%d", &count, &number) == 2 && kept++ == count) {
        (void)raise(number); // the first line is the heading
    }
    return (int)failed;
}
