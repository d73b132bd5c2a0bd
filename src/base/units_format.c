// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities as people write them ("3 mm/day"), or with all digits; the locale changes nothing.
#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

#define DAY 86400.0
#define YEAR 31556925.9747 // UDUNITS' year

// Ways of writing an SI unit, largest first.
typedef struct readable {
    const char *unit, *name;
    double size;
    bool if_round; ///< only where it makes a short number
} readable;

static const readable ways[] = {
    {"m", "km", 1e3, false},
    {"m", "m", 1.0, false},
    {"m", "cm", 1e-2, true},
    {"m", "mm", 1e-3, false},
    {"m", "um", 1e-6, false},
    {"m", "nm", 1e-9, false},
    {"s", "year", YEAR, false},
    {"s", "week", 7 * DAY, true},
    {"s", "day", DAY, false},
    {"s", "hour", 3600.0, false},
    {"s", "min", 60.0, false},
    {"s", "s", 1.0, false},
    {"s", "ms", 1e-3, false},
    {"Pa", "GPa", 1e9, false},
    {"Pa", "MPa", 1e6, false},
    {"Pa", "kPa", 1e3, false},
    {"Pa", "Pa", 1.0, false},
    {"m/s", "km/s", 1e3, false},
    {"m/s", "m/s", 1.0, false},
    {"m/s", "mm/s", 1e-3, false},
    {"m/s", "um/s", 1e-6, true},
    {"m/s", "m/day", 1.0 / DAY, false},
    {"m/s", "cm/day", 1e-2 / DAY, true},
    {"m/s", "cm/week", 1e-2 / (7 * DAY), true},
    {"m/s", "mm/day", 1e-3 / DAY, false},
    {"m/s", "cm/year", 1e-2 / YEAR, true},
    {"m/s", "mm/year", 1e-3 / YEAR, false},
    {"Pa/m", "GPa/m", 1e9, false},
    {"Pa/m", "MPa/m", 1e6, false},
    {"Pa/m", "kPa/m", 1e3, false},
    {"Pa/m", "Pa/m", 1.0, false},
    {"Pa/s", "MPa/s", 1e6, false},
    {"Pa/s", "kPa/s", 1e3, false},
    {"Pa/s", "Pa/s", 1.0, false},
    {"Pa/s", "kPa/day", 1e3 / DAY, false},
    {"Pa/s", "Pa/day", 1.0 / DAY, false},
    {"N", "GN", 1e9, false},
    {"N", "MN", 1e6, false},
    {"N", "kN", 1e3, false},
    {"N", "N", 1.0, false},
    {"rad", "degree", 0.0174532925199433, false},
};

static bool is_round(double x)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%.6g", x);
    return strlen(text) <= 2;
}

static const readable *choose(double value, const char *unit)
{
    double x = fabs(value);
    const readable *smallest = NULL;
    const readable *chosen = NULL;
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        if (strcmp(ways[i].unit, unit) != 0) {
            continue;
        }
        smallest = &ways[i];
        bool large_enough = x >= ways[i].size * (1.0 - 1e-9);
        if (ways[i].if_round && large_enough && is_round(x / ways[i].size)) {
            return &ways[i];
        }
        if (chosen == NULL && !ways[i].if_round && large_enough) {
            chosen = &ways[i];
            if (is_round(x / ways[i].size)) {
                return chosen;
            }
        }
    }
    return chosen != NULL ? chosen : smallest;
}

// The decimal point of the caller's locale gives way to a point.
static void point_decimals(char *text)
{
    const char *decimal = localeconv()->decimal_point;
    char *at = decimal[0] == '.' || decimal[0] == '\0' ? NULL : strstr(text, decimal);
    if (at != NULL) {
        size_t n = strlen(decimal);
        *at = '.';
        memmove(at + 1, at + n, strlen(at + n) + 1);
    }
}

static const char *join(const char *number, const char *unit, char *text, size_t size)
{
    bool plain = strcmp(unit, "1") == 0;
    (void)snprintf(text, size, "%s%s%s", number, plain ? "" : " ", plain ? "" : unit);
    return text;
}

const char *lac_number_exact(double value, int fewest, char *text, size_t size)
{
    for (int digits = fewest; digits <= 17; digits++) {
        (void)snprintf(text, size, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            break;
        }
    }
    point_decimals(text);
    return text;
}

const char *lac_units_exact(double value, const char *unit, char *text, size_t size)
{
    char number[32];
    return join(lac_number_exact(value, 6, number, sizeof number), unit, text, size);
}

const char *lac_units_format(double value, const char *unit, char *text, size_t size)
{
    const readable *way = NULL;
    if (isfinite(value) && value != 0.0) {
        way = choose(value, unit);
    }
    const char *name = way != NULL ? way->name : unit;
    char number[32];
    (void)snprintf(number, sizeof number, "%.6g", way != NULL ? value / way->size : value);
    point_decimals(number);
    return join(number, name, text, size);
}
