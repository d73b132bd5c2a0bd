// SPDX-License-Identifier: GPL-3.0-or-later
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
    {.key = "stiffness",
     .unit = "Pa/m",
     .fallback = NAN,
     .min = 0,
     .max = INFINITY,
     .offset = offsetof(spring_params, stiffness),
     .flags = LAC_ABOVE_MIN,
     .doc = "shear stress over the nominal area for each metre of stretch"},
    {.key = "speed",
     .unit = "m/s",
     .fallback = NAN,
     .min = -INFINITY,
     .max = INFINITY,
     .offset = offsetof(spring_params, speed),
     .doc = "speed of the spring's far end; 0 holds it"},
};

const lac_load_kind lac_shear_spring = {
    .about = {.name = "spring",
              .summary = "a spring on the mean slip, its far end pulled at a constant speed",
              .reference = "Rice & Ruina (1983) J. Appl. Mech. 50, 343, doi 10.1115/1.3167042",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(spring_params)},
    .linear = true,
    .stiffness = stiffness,
    .add = add,
};
