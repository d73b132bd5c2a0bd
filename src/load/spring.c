// SPDX-License-Identifier: GPL-3.0-or-later
// What acts on slip itself: a spring that is pulled at a constant speed, as a testing machine,
// whose stress falls with slip; and plate motion, where the rock around slips steadily, and slip
// that falls behind is loaded.
#include "load/kinds.h"

typedef struct spring_params {
    double stiffness; // k [Pa/m]
    double speed;     // V of the far end [m/s]
    double azimuth;   // of that speed [rad]; NaN: along x
} spring_params;

// tau = k (V t - mean slip); the slip's part is the model's
static void add_spring(const lac_load *load, double t, lac_load_state *sum)
{
    const spring_params *spring = load->params;
    double rate = spring->stiffness * spring->speed;
    sum->spring_stiffness += spring->stiffness;
    sum->spring_stress += rate * t;
    sum->spring_rate += rate;
}

static double stiffness(const void *given) { return ((const spring_params *)given)->stiffness; }

static const lac_param spring_rows[] = {
    LAC_REAL("stiffness", "Pa/m", offsetof(spring_params, stiffness), NAN, 0, INFINITY,
             LAC_ABOVE_MIN, "shear stress over the nominal area for each metre of stretch"),
    LAC_REAL("speed", "m/s", offsetof(spring_params, speed), NAN, -INFINITY, INFINITY, 0,
             "speed of the spring's far end; 0 holds it"),
    LAC_AZIMUTH_ROW(spring_params),
};

const lac_load_kind lac_shear_spring = {
    .info = LAC_ABOUT("spring", "a spring on the mean slip, its far end pulled at a constant speed",
                      "Rice & Ruina (1983) J. Appl. Mech. 50, 343, doi 10.1115/1.3167042",
                      LAC_ROWS(spring_rows, spring_params)),
    .linear = true,
    .stiffness = stiffness,
    .add = add_spring,
};

typedef struct back_slip_params {
    double rate;    // V_pl of the rock that stays behind [m/s]
    double azimuth; // [rad]; NaN: along x
} back_slip_params;

// tau = -K (slip - V t): the transfer's part is the model's
static void add_plate(const lac_load *load, double t, lac_load_state *sum)
{
    const back_slip_params *plate = load->params;
    sum->back_slip += plate->rate * t;
    sum->back_rate += plate->rate;
}

static const lac_param plate_rows[] = {
    LAC_REAL("rate", "m/s", offsetof(back_slip_params, rate), NAN, -INFINITY, INFINITY, 0,
             "slip rate of what surrounds the interface, the plate rate; 0 holds it"),
    LAC_AZIMUTH_ROW(back_slip_params),
};

const lac_load_kind lac_shear_back_slip = {
    .info = LAC_ABOUT("back-slip",
                      "the rock around the interface slips at a constant rate: the transfer acts "
                      "on the slip that lags behind",
                      "Savage (1983) J. Geophys. Res. 88, 4984, doi 10.1029/JB088iB06p04984",
                      LAC_ROWS(plate_rows, back_slip_params)),
    .needs_anchor = true,
    .add = add_plate,
};
