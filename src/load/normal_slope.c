// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/kinds.h"

typedef struct slope_params {
    double thickness; // H, measured vertically [m]
    double angle;     // of the interface with the horizontal [rad]
} slope_params;

// p = rho g H cos^2(angle): weight of a column of area 1/cos, resolved on the interface
static double pressure(const void *p, double density)
{
    const slope_params *slope = p;
    double cosine = cos(slope->angle);
    return density * LAC_GRAVITY * slope->thickness * cosine * cosine;
}

static const lac_param params[] = {
    {.key = "thickness",
     .unit = "m",
     .fallback = NAN,
     .min = 0,
     .max = INFINITY,
     .offset = offsetof(slope_params, thickness),
     .flags = LAC_ABOVE_MIN,
     .doc = "thickness of the sliding mass, measured vertically"},
    {.key = "angle",
     .unit = "rad",
     .fallback = NAN,
     .min = 0,
     .max = LAC_STEEPEST,
     .offset = offsetof(slope_params, angle),
     .doc = "dip of the interface"},
};

const lac_normal_load lac_normal_slope = {
    .about = {.name = "slope",
              .summary = "weight of an infinite slope on its base: rho g H cos^2(angle)",
              .reference = "Skempton & DeLory (1957) Proc. 4th Int. Conf. Soil Mech. 2, 378",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(slope_params)},
    .needs_density = true,
    .pressure = pressure,
};
