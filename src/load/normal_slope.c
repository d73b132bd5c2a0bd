// SPDX-License-Identifier: GPL-3.0-or-later
// Normal stress at the base of an infinite slope, from the weight of the mass that slides.
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
    LAC_REAL("thickness", "m", offsetof(slope_params, thickness), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "thickness of the sliding mass, measured vertically"),
    LAC_REAL("angle", "rad", offsetof(slope_params, angle), NAN, 0, LAC_STEEPEST, 0,
             "dip of the interface"),
};

const lac_normal_load lac_normal_slope = {
    .about = {.name = "slope",
              .summary = "weight of an infinite slope on its base: rho g H cos^2(angle)",
              .reference = "Skempton & DeLory (1957) Proc. 4th Int. Conf. Soil Mech. 2, 378",
              LAC_ROWS(params, slope_params)},
    .needs_density = true,
    .pressure = pressure,
};
