// SPDX-License-Identifier: GPL-3.0-or-later
// The usual units, by which quantities are read without UDUNITS' database and written as people
// write them ("3 mm/day"), or with all digits; the locale changes nothing.
#include "base/units.h"

#include <locale.h>

// Of each SI unit the largest first.
static const lac_usual_unit usual[] = {
    {"km", "m", 1e3, LAC_SHOWN},
    {"m", "m", 1, LAC_SHOWN},
    {"cm", "m", 0.01, LAC_IF_ROUND},
    {"mm", "m", 1e-3, LAC_SHOWN},
    {"um", "m", 1e-6, LAC_SHOWN},
    {"nm", "m", 1e-9, LAC_SHOWN},
    {"year", "s", 31556925.9747, LAC_SHOWN},
    {"week", "s", 604800, LAC_IF_ROUND},
    {"day", "s", 86400, LAC_SHOWN},
    {"hour", "s", 3600, LAC_SHOWN},
    {"min", "s", 60, LAC_SHOWN},
    {"s", "s", 1, LAC_SHOWN},
    {"ms", "s", 1e-3, LAC_SHOWN},
    {"minutes", "s", 60, LAC_READ},
    {"h", "s", 3600, LAC_READ},
    {"hours", "s", 3600, LAC_READ},
    {"days", "s", 86400, LAC_READ},
    {"weeks", "s", 604800, LAC_READ},
    {"years", "s", 31556925.9747, LAC_READ},
    {"GPa", "Pa", 1e9, LAC_SHOWN},
    {"MPa", "Pa", 1e6, LAC_SHOWN},
    {"kPa", "Pa", 1e3, LAC_SHOWN},
    {"Pa", "Pa", 1, LAC_SHOWN},
    {"km/s", "m/s", 1e3, LAC_SHOWN},
    {"m/s", "m/s", 1, LAC_SHOWN},
    {"mm/s", "m/s", 1e-3, LAC_SHOWN},
    {"um/s", "m/s", 1e-6, LAC_IF_ROUND},
    {"m/day", "m/s", 1.1574074074074073e-05, LAC_SHOWN},
    {"cm/day", "m/s", 1.1574074074074074e-07, LAC_IF_ROUND},
    {"cm/week", "m/s", 1.6534391534391535e-08, LAC_IF_ROUND},
    {"mm/day", "m/s", 1.1574074074074074e-08, LAC_SHOWN},
    {"cm/year", "m/s", 3.168876464081849e-10, LAC_IF_ROUND},
    {"mm/year", "m/s", 3.1688764640818494e-11, LAC_SHOWN},
    {"cm/s", "m/s", 0.01, LAC_READ},
    {"nm/s", "m/s", 1e-9, LAC_READ},
    {"mm/week", "m/s", 1.6534391534391535e-09, LAC_READ},
    {"m/year", "m/s", 3.168876464081849e-08, LAC_READ},
    {"kg/m2", "kg/m2", 1, LAC_READ},
    {"kg/m3", "kg/m3", 1, LAC_READ},
    {"GPa/m", "Pa/m", 1e9, LAC_SHOWN},
    {"MPa/m", "Pa/m", 1e6, LAC_SHOWN},
    {"kPa/m", "Pa/m", 1e3, LAC_SHOWN},
    {"Pa/m", "Pa/m", 1, LAC_SHOWN},
    {"MPa/s", "Pa/s", 1e6, LAC_SHOWN},
    {"kPa/s", "Pa/s", 1e3, LAC_SHOWN},
    {"Pa/s", "Pa/s", 1, LAC_SHOWN},
    {"kPa/day", "Pa/s", 0.011574074074074073, LAC_SHOWN},
    {"Pa/day", "Pa/s", 1.1574074074074073e-05, LAC_SHOWN},
    {"MPa/day", "Pa/s", 11.574074074074073, LAC_READ},
    {"kPa/year", "Pa/s", 3.168876464081849e-05, LAC_READ},
    {"GN", "N", 1e9, LAC_SHOWN},
    {"MN", "N", 1e6, LAC_SHOWN},
    {"kN", "N", 1e3, LAC_SHOWN},
    {"N", "N", 1, LAC_SHOWN},
    {"m/s2", "m/s2", 1, LAC_READ},
    {"1/s", "1/s", 1, LAC_READ},
    {"1/day", "1/s", 1.1574074074074073e-05, LAC_READ},
    {"degree", "rad", 0.017453292519943295, LAC_SHOWN},
    {"rad", "rad", 1, LAC_READ},
    {"degrees", "rad", 0.017453292519943295, LAC_READ},
    {"%", "1", 0.01, LAC_READ},
};

const lac_usual_unit *lac_units_usual(size_t *count)
{
    *count = sizeof usual / sizeof usual[0];
    return usual;
}

const lac_usual_unit *lac_units_usual_find(const char *from, const char *to)
{
    for (size_t i = 0; i < sizeof usual / sizeof usual[0]; i++) {
        if (strcmp(usual[i].from, from) == 0 && strcmp(usual[i].to, to) == 0) {
            return &usual[i];
        }
    }
    return NULL;
}

static bool is_round(double x)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%.6g", x);
    return strlen(text) <= 2;
}

static const lac_usual_unit *choose(double value, const char *si)
{
    double x = fabs(value);
    const lac_usual_unit *smallest = NULL, *chosen = NULL;
    for (size_t i = 0; i < sizeof usual / sizeof usual[0]; i++) {
        const lac_usual_unit *unit = &usual[i];
        if (unit->show == LAC_READ || strcmp(unit->to, si) != 0) {
            continue;
        }
        smallest = unit;
        bool large_enough = x >= unit->scale * (1.0 - 1e-9);
        bool wanted = unit->show == LAC_IF_ROUND || chosen == NULL;
        if (large_enough && wanted && is_round(x / unit->scale)) {
            return unit;
        }
        if (large_enough && wanted && unit->show == LAC_SHOWN) {
            chosen = unit;
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
    char number[32];
    const lac_usual_unit *way = isfinite(value) && value != 0.0 ? choose(value, unit) : NULL;
    (void)snprintf(number, sizeof number, "%.6g", way != NULL ? value / way->scale : value);
    point_decimals(number);
    return join(number, way != NULL ? way->from : unit, text, size);
}
