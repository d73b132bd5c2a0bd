// SPDX-License-Identifier: GPL-3.0-or-later
// Shear load of gravity on an infinite slope: its ratio to the normal load follows from the dip.
#include "load/kinds.h"
#include "load/signal.h"

typedef struct slope_params {
    double angle; // of the interface with the horizontal [rad]
    int share;    // lac_share
} slope_params;

// Q/P = tan(angle), whatever the thickness
static void add(const lac_load *load, double t, lac_load_state *sum)
{
    (void)t;
    lac_add_ratio(load, sum, tan(((const slope_params *)load->params)->angle));
}

static const lac_param params[] = {
    LAC_REAL("angle", "rad", offsetof(slope_params, angle), NAN, 0, LAC_STEEPEST, 0,
             "dip of the interface"),
    LAC_SHARE_ROW(slope_params, share),
};

const lac_load_kind lac_shear_slope = {
    .about = {.name = "slope",
              .summary = "pull of gravity along an infinite slope: Q/P = tan(angle)",
              .reference = "Skempton & DeLory (1957) Proc. 4th Int. Conf. Soil Mech. 2, 378",
              LAC_ROWS(params, slope_params)},
    .fixes_shear = true,
    .linear = true,
    .constant = true,
    .add = add,
};
