// SPDX-License-Identifier: GPL-3.0-or-later
// Loads that never change: shear as a part of the normal load, Q/P, and pore pressure.
#include "load/kinds.h"

typedef struct ratio_params {
    double value;   // Q/P [1]
    double azimuth; // of shear only [rad]; NaN: along x
    int share;      // lac_share
} ratio_params;

typedef struct slope_params {
    double angle;   // of the interface with the horizontal [rad]
    double azimuth; // of shear only [rad]; NaN: along x
    int share;      // lac_share
} slope_params;

static void add_ratio(const lac_load *load, lac_load_state *sum, double ratio)
{
    bool equal = load->share == LAC_SHARE_EQUAL, elastic = load->share == LAC_SHARE_ELASTIC;
    *(equal ? &sum->equal_ratio : elastic ? &sum->elastic_ratio : &sum->ratio) += ratio;
}

static void ratio(const lac_load *load, double t, lac_load_state *sum)
{
    (void)t;
    add_ratio(load, sum, ((const ratio_params *)load->params)->value);
}

// Q/P = tan(angle), whatever the thickness
static void slope(const lac_load *load, double t, lac_load_state *sum)
{
    (void)t;
    add_ratio(load, sum, tan(((const slope_params *)load->params)->angle));
}

static lac_signal pore(const lac_load *load, double t)
{
    (void)t;
    return (lac_signal){((const lac_load_value *)load->params)->value, 0.0};
}

static const lac_param ratio_rows[] = {
    LAC_VALUE_ROW("1", 0, 1e6, 0, "shear force over total normal force, Q/P"),
    LAC_AZIMUTH_ROW(ratio_params),
    LAC_SHARE_ROW(ratio_params, share),
};

const lac_load_kind lac_shear_ratio = {
    .info = LAC_ABOUT("ratio", "constant shear force, as a fraction of the total normal force",
                      "Borri-Brunetto, Carpinteri & Chiaia (2004) Rock Mech. Rock Eng. 37, 117; "
                      "docs/theory/loads.md, \"Shear loads\"",
                      LAC_ROWS(ratio_rows, ratio_params)),
    .fixes_shear = true,
    .linear = true,
    .constant = true,
    .add = ratio,
};

static const lac_param slope_rows[] = {
    LAC_ANGLE_ROW(slope_params),
    LAC_AZIMUTH_ROW(slope_params),
    LAC_SHARE_ROW(slope_params, share),
};

const lac_load_kind lac_shear_slope = {
    .info = LAC_ABOUT("slope", "pull of gravity along an infinite slope: Q/P = tan(angle)",
                      "Skempton & DeLory (1957) Proc. 4th Int. Conf. Soil Mech. 2, 378",
                      LAC_ROWS(slope_rows, slope_params)),
    .fixes_shear = true,
    .linear = true,
    .constant = true,
    .slope = true,
    .add = slope,
};

static const lac_param pore_rows[] = {
    LAC_VALUE_ROW("Pa", 0, INFINITY, 0, "pore pressure in the interface"),
};

const lac_load_kind lac_pore_constant = {
    .info = LAC_ABOUT("constant", "pore pressure that does not change",
                      "Hubbert & Rubey (1959) Geol. Soc. Am. Bull. 70, 115, doi "
                      "10.1130/0016-7606(1959)70[115:ROFPIM]2.0.CO;2 (effective stress)",
                      LAC_ROWS(pore_rows, lac_load_value)),
    .linear = true,
    .constant = true,
    .signal = pore,
};
