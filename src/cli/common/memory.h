/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"
#include <sys/types.h>

/// Memory that can still be had without swapping [bytes]: the machine's, and what the control
/// groups (version 1 or 2) of this process leave of it. What the system does not say is no limit.
/// @param root  put before /proc and /sys; "" but in tests
int64_t cli_memory_free(const char *root);

/// Memory that a process has resident [bytes]; 0 where the system does not say.
int64_t cli_memory_resident(const char *root, pid_t pid);

/// Whether one more process may be started: it, and what the others have yet to take of their peak,
/// take at most half of what is free.
/// @param peak      of the largest so far [bytes]
/// @param resident  [running] what they have taken so far [bytes]
bool cli_memory_allows(int64_t free, int64_t peak, const int64_t *resident, size_t running);
