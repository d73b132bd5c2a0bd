// SPDX-License-Identifier: GPL-3.0-or-later
// Plate motion as a load: the rock around slips steadily, and slip that falls behind is loaded.
#include "load/kinds.h"

typedef struct back_slip_params {
    double rate; // V_pl of the rock that stays behind [m/s]
} back_slip_params;

// tau = -K (slip - V t): the transfer's part is the model's
static void add(const lac_load *load, double t, lac_load_state *sum)
{
    const back_slip_params *plate = load->params;
    sum->back_slip += plate->rate * t;
    sum->back_rate += plate->rate;
}

static const lac_param params[] = {
    LAC_REAL("rate", "m/s", offsetof(back_slip_params, rate), NAN, -INFINITY, INFINITY, 0,
             "slip rate of what surrounds the interface, the plate rate; 0 holds it"),
};

const lac_load_kind lac_shear_back_slip = {
    .info = LAC_ABOUT("back-slip",
                      "the rock around the interface slips at a constant rate: the transfer acts "
                      "on the slip that lags behind",
                      "Savage (1983) J. Geophys. Res. 88, 4984, doi 10.1029/JB088iB06p04984",
                      LAC_ROWS(params, back_slip_params)),
    .needs_anchor = true,
    .add = add,
};
