// SPDX-License-Identifier: GPL-3.0-or-later
// A spring that is pulled at a constant speed, as a testing machine: its stress falls with slip.
#include "load/kinds.h"

typedef struct spring_params {
    double stiffness; // k [Pa/m]
    double speed;     // V of the far end [m/s]
} spring_params;

// tau = k (V t - mean slip); the slip's part is the model's
static void add(const lac_load *load, double t, lac_load_state *sum)
{
    const spring_params *spring = load->params;
    double rate = spring->stiffness * spring->speed;
    sum->spring_stiffness += spring->stiffness;
    sum->spring_stress += rate * t;
    sum->spring_rate += rate;
}

static double stiffness(const void *given) { return ((const spring_params *)given)->stiffness; }

static const lac_param params[] = {
    LAC_REAL("stiffness", "Pa/m", offsetof(spring_params, stiffness), NAN, 0, INFINITY,
             LAC_ABOVE_MIN, "shear stress over the nominal area for each metre of stretch"),
    LAC_REAL("speed", "m/s", offsetof(spring_params, speed), NAN, -INFINITY, INFINITY, 0,
             "speed of the spring's far end; 0 holds it"),
};

const lac_load_kind lac_shear_spring = {
    .info = LAC_ABOUT("spring", "a spring on the mean slip, its far end pulled at a constant speed",
                      "Rice & Ruina (1983) J. Appl. Mech. 50, 343, doi 10.1115/1.3167042",
                      LAC_ROWS(params, spring_params)),
    .linear = true,
    .stiffness = stiffness,
    .add = add,
};
