// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded before a program (LD_PRELOAD), it has no memory for the FAIL_AT-th allocation that
// Lacuna's own code asks for; what its libraries ask for is given, as some of them end the program.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static long left;
static bool looking; // dladdr may allocate

static bool fails(void *caller)
{
    if (left == 0) {
        const char *at = getenv("FAIL_AT");
        left = at != NULL ? strtol(at, NULL, 10) : -1;
    }
    Dl_info info;
    if (left < 0 || looking) {
        return false;
    }
    looking = true;
    bool own = dladdr(caller, &info) != 0 && strstr(info.dli_fname, "lacuna") != NULL;
    looking = false;
    left -= own ? 1 : 0;
    if (!own || left > 0) {
        return false;
    }
    left = -1;
    errno = ENOMEM;
    return true;
}

#define VISIBLE __attribute__((visibility("default")))
#define UNLESS_IT_FAILS(block) fails(__builtin_return_address(0)) ? NULL : (block)

VISIBLE void *malloc(size_t size) { return UNLESS_IT_FAILS(__libc_malloc(size)); }

VISIBLE void *calloc(size_t count, size_t size)
{
    return UNLESS_IT_FAILS(__libc_calloc(count, size));
}

VISIBLE void *realloc(void *old, size_t size) { return UNLESS_IT_FAILS(__libc_realloc(old, size)); }

VISIBLE void *aligned_alloc(size_t alignment, size_t size)
{
    return UNLESS_IT_FAILS(__libc_memalign(alignment, size));
}
