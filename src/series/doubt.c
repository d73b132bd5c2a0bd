// SPDX-License-Identifier: GPL-3.0-or-later
// A column that is not what it seems is asked about.
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "series/text.h"

enum { LONGEST_NAME = 64 };

void lac_series_doubt(lac_series *series, const char *format, ...)
{
    va_list args;
    if (series->doubts == LAC_SERIES_DOUBTS) {
        return;
    }
    va_start(args, format);
    (void)vsnprintf(series->doubt[series->doubts++], LAC_SERIES_DOUBT_TEXT, format, args);
    va_end(args);
}

// The end of a name as UDUNITS writes a unit: without brackets, blanks for underscores.
static void plain(const char *end, char *unit, size_t size)
{
    size_t n = 0;
    for (; *end != '\0' && n + 1 < size; end++) {
        if (strchr("()[]", *end) == NULL) {
            unit[n++] = (char)(*end == '_' ? ' ' : *end);
        }
    }
    unit[n] = '\0';
}

static bool is_month(const char *unit)
{
    return strcmp(unit, "month") == 0 || strcmp(unit, "months") == 0;
}

// The longest end of a name that is a unit of the dimension of `si`, or "month"; "" where none is.
static void find_unit(const struct lac_units *units, const char *name, const char *si, char *unit,
                      bool *same)
{
    double scale, offset;
    for (const char *at = name; strlen(name) < LONGEST_NAME && *at != '\0'; at++) {
        if (at > name && strchr("_ ([", at[-1]) == NULL) {
            continue;
        }
        plain(at, unit, LONGEST_NAME);
        if (strcmp(si, "s") == 0 && is_month(unit)) {
            *same = false;
            return;
        }
        if (lac_units_convert(units, unit, si, &scale, &offset, NULL) == LAC_OK) {
            *same = scale == 1.0 && offset == 0.0;
            return;
        }
    }
    *same = false;
    unit[0] = '\0';
}

lac_status lac_series_ask(const struct lac_units *units, const char *where, const char *name,
                          const char *si, bool *known, lac_error *err)
{
    char unit[LONGEST_NAME] = "";
    find_unit(units, name, si, unit, known);
    if (unit[0] == '\0' || *known) {
        return LAC_OK;
    }
    LAC_FAIL_IF(strcmp(si, "s") != 0, err, LAC_EINPUT,
                "%s: %s: has no unit, and its name says %s: which is it, \"%s:%s\" or \"%s:%s\"?",
                where, name, unit, name, unit, name, si);
    return lac_fail(
        err, LAC_EINPUT,
        "%s: %s: has bare numbers, and its name says %s: which time format is it, %s or s?", where,
        name, unit, is_month(unit) ? "dates (a month has no fixed length)" : unit);
}
