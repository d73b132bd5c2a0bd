// SPDX-License-Identifier: GPL-3.0-or-later
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
    {.key = "value",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 1.9999,
     .flags = LAC_ABOVE_MIN,
     .offset = offsetof(dimension_params, value),
     .doc =
         "dimension that the blocks of all levels of the grid are to count, 1 to the whole; on a "
         "line below 1"},
};

const lac_normal_load lac_normal_dimension = {
    .about = {.name = "dimension",
              .summary = "as much as gives the contact domain this dimension, statics only: the "
                         "load follows",
              .reference = "docs/theory/fractal.md, \"Given dimension\"",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(dimension_params)},
    .pressure = pressure,
    .dimension = dimension,
};
