// SPDX-License-Identifier: GPL-3.0-or-later
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
    {.key = "value",
     .unit = "Pa",
     .fallback = NAN,
     .min = 0,
     .max = INFINITY,
     .offset = offsetof(pressure_params, value),
     .flags = LAC_ABOVE_MIN,
     .doc = "total mean normal stress over the nominal area"},
};

const lac_normal_load lac_normal_pressure = {
    .about = {.name = "pressure",
              .summary = "normal stress given outright",
              .reference = "docs/theory/loads.md, \"Normal loads\"",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(pressure_params)},
    .pressure = pressure,
};
