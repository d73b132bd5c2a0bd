// SPDX-License-Identifier: GPL-3.0-or-later
// Units that most cases use, with the factors of UDUNITS-2: its database takes long to read.
#include "base/units.h"

#include <string.h>

static const lac_usual_unit usual[] = {
    {"m", "m", 1},
    {"km", "m", 1e3},
    {"cm", "m", 0.01},
    {"mm", "m", 1e-3},
    {"um", "m", 1e-6},
    {"nm", "m", 1e-9},
    {"s", "s", 1},
    {"ms", "s", 1e-3},
    {"min", "s", 60},
    {"minutes", "s", 60},
    {"h", "s", 3600},
    {"hour", "s", 3600},
    {"hours", "s", 3600},
    {"day", "s", 86400},
    {"days", "s", 86400},
    {"week", "s", 604800},
    {"weeks", "s", 604800},
    {"year", "s", 31556925.9747},
    {"years", "s", 31556925.9747},
    {"Pa", "Pa", 1},
    {"kPa", "Pa", 1e3},
    {"MPa", "Pa", 1e6},
    {"GPa", "Pa", 1e9},
    {"m/s", "m/s", 1},
    {"km/s", "m/s", 1e3},
    {"cm/s", "m/s", 0.01},
    {"mm/s", "m/s", 1e-3},
    {"um/s", "m/s", 1e-6},
    {"nm/s", "m/s", 1e-9},
    {"m/day", "m/s", 1.1574074074074073e-05},
    {"cm/day", "m/s", 1.1574074074074074e-07},
    {"mm/day", "m/s", 1.1574074074074074e-08},
    {"cm/week", "m/s", 1.6534391534391535e-08},
    {"mm/week", "m/s", 1.6534391534391535e-09},
    {"m/year", "m/s", 3.168876464081849e-08},
    {"cm/year", "m/s", 3.168876464081849e-10},
    {"mm/year", "m/s", 3.1688764640818494e-11},
    {"kg/m2", "kg/m2", 1},
    {"kg/m3", "kg/m3", 1},
    {"Pa/m", "Pa/m", 1},
    {"kPa/m", "Pa/m", 1e3},
    {"MPa/m", "Pa/m", 1e6},
    {"GPa/m", "Pa/m", 1e9},
    {"Pa/s", "Pa/s", 1},
    {"kPa/s", "Pa/s", 1e3},
    {"Pa/day", "Pa/s", 1.1574074074074073e-05},
    {"kPa/day", "Pa/s", 0.011574074074074073},
    {"MPa/day", "Pa/s", 11.574074074074073},
    {"kPa/year", "Pa/s", 3.168876464081849e-05},
    {"N", "N", 1},
    {"kN", "N", 1e3},
    {"MN", "N", 1e6},
    {"GN", "N", 1e9},
    {"m/s2", "m/s2", 1},
    {"1/s", "1/s", 1},
    {"1/day", "1/s", 1.1574074074074073e-05},
    {"rad", "rad", 1},
    {"degree", "rad", 0.017453292519943295},
    {"degrees", "rad", 0.017453292519943295},
    {"%", "1", 0.01},
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
