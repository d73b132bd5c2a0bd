// SPDX-License-Identifier: GPL-3.0-or-later
// Normal loads: outright, by the weight of rock, or in statics by what the contact is to be.
#include "load/kinds.h"

typedef struct slope_params {
    double thickness; // H, measured vertically [m]
    double angle;     // of the interface with the horizontal [rad]
} slope_params;

static double value_of(const void *p) { return ((const lac_load_value *)p)->value; }

static double given(const void *p, double density)
{
    (void)density;
    return value_of(p);
}

// What an approach or a dimension takes is known once the contact is solved.
static double unknown(const void *p, double density)
{
    (void)p;
    (void)density;
    return NAN;
}

// p = rho g z
static double overburden(const void *p, double density)
{
    return density * LAC_GRAVITY * value_of(p);
}

// p = rho g H cos^2(angle): weight of a column of area 1/cos, resolved on the interface
static double slope_weight(const void *p, double density)
{
    const slope_params *slope = p;
    double cosine = cos(slope->angle);
    return density * LAC_GRAVITY * slope->thickness * cosine * cosine;
}

static const lac_param pressure_rows[] = {
    LAC_VALUE_ROW("Pa", 0, INFINITY, LAC_ABOVE_MIN,
                  "total mean normal stress over the nominal area"),
};

const lac_normal_load lac_normal_pressure = {
    .info = LAC_ABOUT("pressure", "normal stress given outright",
                      "docs/theory/loads.md, \"Normal loads\"",
                      LAC_ROWS(pressure_rows, lac_load_value)),
    .pressure = given,
};

static const lac_param depth_rows[] = {
    LAC_VALUE_ROW("m", 0, INFINITY, LAC_ABOVE_MIN,
                  "depth of a level interface under its overburden"),
};

const lac_normal_load lac_normal_depth = {
    .info =
        LAC_ABOUT("depth", "weight of the rock above a level interface: rho g z",
                  "docs/theory/loads.md, \"Normal loads\"", LAC_ROWS(depth_rows, lac_load_value)),
    .needs_density = true,
    .pressure = overburden,
};

static const lac_param slope_rows[] = {
    LAC_REAL("thickness", "m", offsetof(slope_params, thickness), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "thickness of the sliding mass, measured vertically"),
    LAC_ANGLE_ROW(slope_params),
};

const lac_normal_load lac_normal_slope = {
    .info = LAC_ABOUT("slope", "weight of an infinite slope on its base: rho g H cos^2(angle)",
                      "Skempton & DeLory (1957) Proc. 4th Int. Conf. Soil Mech. 2, 378",
                      LAC_ROWS(slope_rows, slope_params)),
    .needs_density = true,
    .slope = true,
    .pressure = slope_weight,
};

static const lac_param approach_rows[] = {
    LAC_VALUE_ROW("m", -1e6, 1e6, 0,
                  "height of the far (mean) plane of one face over the mean of the heights; > 0 "
                  "between periodic faces"),
};

const lac_normal_load lac_normal_approach = {
    .info = LAC_ABOUT("approach", "faces brought so near, statics only: the load follows",
                      "docs/theory/contact.md, \"Given approach\"",
                      LAC_ROWS(approach_rows, lac_load_value)),
    .pressure = unknown,
    .approach = value_of,
};

static const lac_param dimension_rows[] = {
    LAC_VALUE_ROW("1", 0, 1.9999, LAC_ABOVE_MIN,
                  "dimension that the blocks of all levels of the grid are to count, 1 to the "
                  "whole; on a line below 1"),
};

const lac_normal_load lac_normal_dimension = {
    .info = LAC_ABOUT(
        "dimension",
        "as much as gives the contact domain this dimension, statics only: the load follows",
        "docs/theory/fractal.md, \"Given dimension\"", LAC_ROWS(dimension_rows, lac_load_value)),
    .pressure = unknown,
    .dimension = value_of,
};
