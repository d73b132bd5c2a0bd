// SPDX-License-Identifier: GPL-3.0-or-later
// The message of an error on its way up to the caller: the library itself never prints.
#include "base/base.h"

#include <stdarg.h>

lac_status lac_fail(lac_error *err, lac_status status, const char *format, ...)
{
    if (err != NULL) {
        va_list args;
        va_start(args, format);
        (void)vsnprintf(err->message, sizeof err->message, format, args);
        va_end(args);
    }
    return status;
}

lac_status lac_fail_within(lac_error *err, lac_status status, const char *format, ...)
{
    if (err == NULL || status == LAC_OK) {
        return status;
    }
    char where[sizeof err->message];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(where, sizeof where, format, args);
    va_end(args);

    // Of another rank, that may be there already.
    const char *there = strstr(err->message, where);
    const bool begins = there == err->message || (there != NULL && there[-1] == ' ');
    if (begins && strncmp(there + strlen(where), ": ", 2) == 0) {
        return status;
    }
    // Whatever does not fit falls off the end of the older text, never the newer.
    size_t used = strlen(where);
    if (used + 2 < sizeof where) {
        (void)snprintf(where + used, sizeof where - used, ": %s", err->message);
    }
    memcpy(err->message, where, sizeof where);
    return status;
}

lac_status lac_fail_memory(lac_error *err) { return lac_fail(err, LAC_ENOMEM, "out of memory"); }
