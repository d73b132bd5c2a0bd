// SPDX-License-Identifier: GPL-3.0-or-later
// Normal stress as a plain number, for joints whose load no depth or slope gives.
#include "load/kinds.h"

typedef struct pressure_params {
    double value; // [Pa]
} pressure_params;

static double pressure(const void *p, double density)
{
    (void)density;
    return ((const pressure_params *)p)->value;
}

static const lac_param params[] = {
    LAC_REAL("value", "Pa", offsetof(pressure_params, value), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "total mean normal stress over the nominal area"),
};

const lac_normal_load lac_normal_pressure = {
    .about = {.name = "pressure",
              .summary = "normal stress given outright",
              .reference = "docs/theory/loads.md, \"Normal loads\"",
              LAC_ROWS(params, pressure_params)},
    .pressure = pressure,
};
