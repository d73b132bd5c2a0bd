// SPDX-License-Identifier: GPL-3.0-or-later
// Constant shear load as a part of the normal load, Q/P, instead of a stress.
#include "load/kinds.h"
#include "load/signal.h"

typedef struct ratio_params {
    double value; // Q/P [1]
    int share;    // lac_share
} ratio_params;

static void add(const lac_load *load, double t, lac_load_state *sum)
{
    (void)t;
    lac_add_ratio(load, sum, ((const ratio_params *)load->params)->value);
}

static const lac_param params[] = {
    LAC_REAL("value", "1", offsetof(ratio_params, value), NAN, 0, 1e6, 0,
             "shear force over total normal force, Q/P"),
    LAC_SHARE_ROW(ratio_params, share),
};

const lac_load_kind lac_shear_ratio = {
    .about = {.name = "ratio",
              .summary = "constant shear force, as a fraction of the total normal force",
              .reference = "Borri-Brunetto, Carpinteri & Chiaia (2004) Rock Mech. Rock Eng. "
                           "37, 117; docs/theory/loads.md, \"Shear loads\"",
              LAC_ROWS(params, ratio_params)},
    .fixes_shear = true,
    .linear = true,
    .constant = true,
    .add = add,
};
