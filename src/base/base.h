/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// What every file has without asking: C's everyday library, and how a function fails.

#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"

/// Room in an array for `need` things of a size; what it holds stays.
/// @param array  address of a pointer to them, of any type
/// @param room   of how many there is; at least twice as many where it grows
lac_status lac_grow(void *array, size_t *room, size_t need, size_t size, lac_error *err);

/// Puts behind a text, of `size` bytes at most, what fits of another.
void lac_append(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
