// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/failing_malloc.h"

#include <execinfo.h>
#include <limits.h>
#include <stddef.h>
#include <stdint.h>

enum { MOST_WATCHED = 1 << 16, MOST_CALLS = 24 };

static long left = LONG_MAX;
static bool all_after, failed;

static uint64_t place[MOST_WATCHED]; // of each allocation, by the calls that led to it
static long watched;
static bool watching;

static void watch(void)
{
    void *call[MOST_CALLS];
    const int calls = backtrace(call, MOST_CALLS);
    uint64_t sum = 14695981039346656037U; // FNV-1a, over words
    for (int i = 0; i < calls; i++) {
        sum = (sum ^ (uint64_t)(uintptr_t)call[i]) * 1099511628211U;
    }
    if (watched < MOST_WATCHED) {
        place[watched] = sum;
    }
    watched++;
}

void watch_allocations(void)
{
    watched = 0;
    watching = true;
}

long allocations_watched(void)
{
    watching = false;
    return watched;
}

bool allocation_counts(long k, bool last_too)
{
    if (k >= watched || k >= MOST_WATCHED) {
        return true;
    }
    bool first = true;
    bool last = last_too;
    for (long i = 0; i < watched && i < MOST_WATCHED; i++) {
        const bool same = i != k && place[i] == place[k];
        first = first && (i > k || !same);
        last = last && (i < k || !same);
    }
    return first || last;
}

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
    if (watching) {
        watch();
    }
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
