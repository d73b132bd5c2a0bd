// SPDX-License-Identifier: GPL-3.0-or-later
// Normal load of statics, given as how near the faces are: the pressure is a result.
#include "load/kinds.h"

typedef struct approach_params {
    double value; // [m]
} approach_params;

// What it takes is known once the contact is solved.
static double pressure(const void *p, double density)
{
    (void)p;
    (void)density;
    return NAN;
}

static double approach(const void *p) { return ((const approach_params *)p)->value; }

static const lac_param params[] = {
    LAC_REAL("value", "m", offsetof(approach_params, value), NAN, -1e6, 1e6, 0,
             "height of the far (mean) plane of one face over the mean of the heights; > 0 between "
             "periodic faces"),
};

const lac_normal_load lac_normal_approach = {
    .about = {.name = "approach",
              .summary = "faces brought so near, statics only: the load follows",
              .reference = "docs/theory/contact.md, \"Given approach\"",
              LAC_ROWS(params, approach_params)},
    .pressure = pressure,
    .approach = approach,
};
