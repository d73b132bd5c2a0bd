// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress or pore pressure that changes at a constant rate, then holds what it has come to.
#include "load/kinds.h"

typedef struct ramp_params {
    double rate;  // [Pa/s]
    double start; // [s]
    double end;   // [s]; NaN: it never ends
    int share;    // lac_share; of shear only
} ramp_params;

// rate (min(t, end) - start), from start on
static lac_signal ramp_at(const lac_load *load, double t)
{
    const ramp_params *ramp = load->params;
    if (t < ramp->start || ramp->end <= ramp->start) {
        return (lac_signal){0.0, 0.0};
    }
    return (lac_signal){ramp->rate * (fmin(t, ramp->end) - ramp->start),
                        t >= ramp->end ? 0.0 : ramp->rate};
}

static double next_break(const lac_load *load, double t)
{
    const ramp_params *ramp = load->params;
    return lac_window_break(ramp->start, ramp->end, t);
}

static const char *fault(const void *p)
{
    const ramp_params *ramp = p;
    return ramp->end <= ramp->start ? "end must be later than start" : NULL;
}

static const lac_param params[] = {
    LAC_REAL("rate", "Pa/s", offsetof(ramp_params, rate), NAN, -INFINITY, INFINITY, 0,
             "rate of the shear stress over the nominal area, or of the pore pressure; negative "
             "unloads or drains"),
    LAC_START_ROW(ramp_params),
    LAC_REAL("end", "s", offsetof(ramp_params, end), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,
             "when it ends, since the start of the run, what it has come to being held from then "
             "on; never if absent"),
    LAC_SHARE_ROW(ramp_params, share),
};

const lac_load_kind lac_shear_ramp = {
    .info = LAC_ABOUT("ramp", "shear stress that changes at a constant rate between two times",
                      "Dieterich (1994) J. Geophys. Res. 99, 2601, doi 10.1029/93JB02581 (constant "
                      "stressing rate)",
                      LAC_ROWS(params, ramp_params), .validate = fault),
    .linear = true,
    .signal = ramp_at,
    .next_break = next_break,
};

const lac_load_kind lac_pore_ramp = {
    .info = LAC_ABOUT("ramp", "pore pressure that changes at a constant rate between two times",
                      "docs/theory/loads.md, \"Pore pressure\"", LAC_PORE_ROWS(params, ramp_params),
                      .validate = fault),
    .linear = true,
    .signal = ramp_at,
    .next_break = next_break,
};
