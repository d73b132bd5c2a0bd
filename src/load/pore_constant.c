// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure that never changes: it takes its part off the normal stress from the start on.
#include "load/kinds.h"

typedef struct constant_params {
    double value; // [Pa]
} constant_params;

static void add(const lac_load *load, double t, lac_load_state *sum)
{
    (void)t;
    sum->pore += ((const constant_params *)load->params)->value;
}

static const lac_param params[] = {
    LAC_REAL("value", "Pa", offsetof(constant_params, value), NAN, 0, INFINITY, 0,
             "pore pressure in the interface"),
};

const lac_load_kind lac_pore_constant = {
    .about = {.name = "constant",
              .summary = "pore pressure that does not change",
              .reference = "Hubbert & Rubey (1959) Geol. Soc. Am. Bull. 70, 115, doi "
                           "10.1130/0016-7606(1959)70[115:ROFPIM]2.0.CO;2 (effective stress)",
              LAC_ROWS(params, constant_params)},
    .linear = true,
    .constant = true,
    .add = add,
};
