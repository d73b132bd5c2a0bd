// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/failing_malloc.h"

#include <limits.h>
#include <stddef.h>

static long left = LONG_MAX;
static bool all_after, failed;

void fail_allocation(long k, bool for_good)
{
    left = k;
    all_after = for_good;
    failed = false;
}

bool stop_failing(void)
{
    left = LONG_MAX;
    return failed;
}

static bool fails(void)
{
    if (left == LONG_MAX || left-- > 0) {
        return false;
    }
    left = all_after ? 0 : LONG_MAX;
    failed = true;
    return true;
}

// The linker sends the library's calls here; __real_ are those of the C library.
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);

void *__wrap_malloc(size_t size) { return fails() ? NULL : __real_malloc(size); }

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *old, size_t size) { return fails() ? NULL : __real_realloc(old, size); }
