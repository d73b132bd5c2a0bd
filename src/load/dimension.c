// SPDX-License-Identifier: GPL-3.0-or-later
// Normal load of statics, given as a fractal dimension: as much as the contact needs to have it.
#include "load/kinds.h"

typedef struct dimension_params {
    double value; // [1]
} dimension_params;

// What it takes is known once the contact is solved.
static double pressure(const void *p, double density)
{
    (void)p;
    (void)density;
    return NAN;
}

static double dimension(const void *p) { return ((const dimension_params *)p)->value; }

static const lac_param params[] = {
    LAC_REAL("value", "1", offsetof(dimension_params, value), NAN, 0, 1.9999, LAC_ABOVE_MIN,
             "dimension that the blocks of all levels of the grid are to count, 1 to the whole; on "
             "a line below 1"),
};

const lac_normal_load lac_normal_dimension = {
    .about = {.name = "dimension",
              .summary = "as much as gives the contact domain this dimension, statics only: the "
                         "load follows",
              .reference = "docs/theory/fractal.md, \"Given dimension\"",
              LAC_ROWS(params, dimension_params)},
    .pressure = pressure,
    .dimension = dimension,
};
