/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_FAILING_MALLOC_H
#define LACUNA_TESTS_FAILING_MALLOC_H

#include <stdbool.h>
#include <stddef.h>

// For programs linked with --wrap of malloc, calloc and realloc: the library's allocations fail
// from the k-th on (one, or all that follow), those of other libraries do not.

// Counts from now; the k-th allocation (from 0) fails, and with `for_good` all after it.
void fail_allocation(long k, bool for_good);
// Lets all succeed again. Whether one failed since.
bool stop_failing(void);

// Notes from now on which calls led to each allocation; none fails.
void watch_allocations(void);
// Ends that; how many there were.
long allocations_watched(void);
// Whether the k-th is the first or, where `last_too`, the last that the same calls led to: those
// between, of a loop, meet what these do. True of those that were not watched.
bool allocation_counts(long k, bool last_too);

#endif
