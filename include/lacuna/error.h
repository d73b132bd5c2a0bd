/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_ERROR_H
#define LACUNA_ERROR_H

#include "lacuna/linkage.h"

LAC_BEGIN_C

/// What every fallible function returns.
typedef enum lac_status {
    LAC_OK = 0,
    LAC_ENOMEM,     ///< memory could not be allocated
    LAC_EINPUT,     ///< what was asked for is wrong: a value, a case, a data file
    LAC_EIO,        ///< a file could not be read or written
    LAC_ENUMERIC,   ///< the computation broke: no convergence, not a number
    LAC_EINTERRUPT, ///< stopped on request; what was computed is whole
} lac_status;

/// The caller's place for a message; the library never prints.
typedef struct lac_error {
    char message[1024]; ///< one line, no trailing newline; "" while all is well
} lac_error;

/// Records a message and gives back `status`, so that an error is one statement.
/// @param err     where the message goes; NULL is allowed and drops it
/// @param format  as printf
/// @return status, unchanged
lac_status lac_fail(lac_error *err, lac_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Puts "text: " before the message in `err`, to say on the way up where it happened; LAC_OK has
/// none.
/// @return status, unchanged
lac_status lac_fail_within(lac_error *err, lac_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Shorthand for the commonest error.
/// @return LAC_ENOMEM with "out of memory" in `err`
lac_status lac_fail_memory(lac_error *err);

LAC_END_C

#endif
