// SPDX-License-Identifier: GPL-3.0-or-later
// Texts that grow in the room that they have.
#include "base/base.h"

#include <stdarg.h>

void lac_append(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text + used, size - used, format, args);
    va_end(args);
}
