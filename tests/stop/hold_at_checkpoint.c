// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded before a run (LD_PRELOAD), it holds the run's thread once a checkpoint has got its name,
// until somebody opens FIFO.COUNT for writing and closes it; other threads go on:
//   HOLD_AT_CHECKPOINT=COUNT,COUNT...:FIFO
// So a test looks at a run that is known to stand still.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static int is_asked(const char *counts, int made)
{
    while (*counts != '\0' && *counts != ':') {
        char *end;
        const long count = strtol(counts, &end, 10);
        if (count == made) {
            return 1;
        }
        counts = *end == ',' ? end + 1 : end;
    }
    return 0;
}

static void hold(const char *fifo, int made)
{
    char byte, path[4096];
    (void)snprintf(path, sizeof path, "%s.%d", fifo, made);
    const int fd = open(path, O_RDONLY | O_CLOEXEC); // until there is a writer
    while (fd >= 0 && read(fd, &byte, 1) > 0) {
    }
    if (fd >= 0) {
        (void)close(fd);
    }
}

// Before the C library's: what the program calls.
__attribute__((visibility("default"))) int rename(const char *from, const char *to)
{
    static const char ending[] = ".checkpoint";
    static int made;
    const long failed = syscall(SYS_rename, from, to);
    const char *asked = getenv("HOLD_AT_CHECKPOINT");
    const size_t length = strlen(to);
    if (failed == 0 && asked != NULL && strchr(asked, ':') != NULL && length >= sizeof ending &&
        strcmp(to + length - (sizeof ending - 1), ending) == 0 && is_asked(asked, ++made)) {
        hold(strchr(asked, ':') + 1, made);
    }
    return (int)failed;
}
