// SPDX-License-Identifier: GPL-3.0-or-later
// Normal stress on a level joint, from the weight of the rock above it.
#include "load/kinds.h"

typedef struct depth_params {
    double value; // z [m]
} depth_params;

// p = rho g z
static double pressure(const void *p, double density)
{
    return density * LAC_GRAVITY * ((const depth_params *)p)->value;
}

static const lac_param params[] = {
    LAC_REAL("value", "m", offsetof(depth_params, value), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "depth of a level interface under its overburden"),
};

const lac_normal_load lac_normal_depth = {
    .about = {.name = "depth",
              .summary = "weight of the rock above a level interface: rho g z",
              .reference = "docs/theory/loads.md, \"Normal loads\"",
              LAC_ROWS(params, depth_params)},
    .needs_density = true,
    .pressure = pressure,
};
