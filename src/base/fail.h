/* SPDX-License-Identifier: GPL-3.0-or-later */
// How a function fails: the only macros that change the flow of control.
#pragma once

#include "lacuna/error.h"

/// Calls, and leaves through `out:`, which frees in reverse, where the call fails.
#define LAC_TRY(call)           \
    do {                        \
        status = (call);        \
        if (status != LAC_OK) { \
            goto out;           \
        }                       \
    } while (0)

/// Calls, and returns its status where the call fails: for functions that have nothing to free.
#define LAC_TRY_RETURN(call)                \
    do {                                    \
        const lac_status returned = (call); \
        if (returned != LAC_OK) {           \
            return returned;                \
        }                                   \
    } while (0)

/// Returns with a message where a condition holds; what follows the condition is as lac_fail has
/// it.
#define LAC_FAIL_IF(condition, err, status, ...)           \
    do {                                                   \
        if (condition) {                                   \
            return lac_fail((err), (status), __VA_ARGS__); \
        }                                                  \
    } while (0)

/// Returns LAC_ENOMEM where a condition holds: a pointer that malloc left NULL.
#define LAC_FAIL_MEMORY_IF(condition, err) \
    do {                                   \
        if (condition) {                   \
            (void)lac_fail_memory(err);    \
            return LAC_ENOMEM;             \
        }                                  \
    } while (0)

/// Ends what makes an object: where that failed, what was made is freed and nobody gets it.
/// @param made  address of the pointer to it
#define LAC_MADE(status, made, free_it) \
    do {                                \
        if ((status) != LAC_OK) {       \
            free_it(*(made));           \
            *(made) = NULL;             \
        }                               \
        return (status);                \
    } while (0)

/// Leaves through `out:` with a message where a condition holds; arguments as of LAC_FAIL_IF.
#define LAC_LEAVE_IF(condition, err, code, ...)            \
    do {                                                   \
        if (condition) {                                   \
            status = lac_fail((err), (code), __VA_ARGS__); \
            goto out;                                      \
        }                                                  \
    } while (0)
