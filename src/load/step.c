// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress or pore pressure that comes all at once, for good or for a while: a trigger.
#include "load/kinds.h"

typedef struct step_params {
    double value; // [Pa]
    double at;    // [s]
    double until; // [s]; NaN: for good
    int share;    // lac_share; of shear only
} step_params;

// value from `at` to `until`
static lac_signal step_at(const lac_load *load, double t)
{
    const step_params *step = load->params;
    bool on = t >= step->at && !(t >= step->until);
    return (lac_signal){on ? step->value : 0.0, 0.0};
}

static double next_break(const lac_load *load, double t)
{
    const step_params *step = load->params;
    return lac_window_break(step->at, step->until, t);
}

static const char *fault(const void *p)
{
    const step_params *step = p;
    return step->until <= step->at ? "until must be later than at" : NULL;
}

static const lac_param params[] = {
    LAC_REAL(
        "value", "Pa", offsetof(step_params, value), NAN, -INFINITY, INFINITY, 0,
        "stress that is added, shear over the nominal area or pore pressure; negative takes away"),
    LAC_REAL("at", "s", offsetof(step_params, at), NAN, -INFINITY, INFINITY, 0,
             "when it comes, since the start of the run"),
    LAC_REAL("until", "s", offsetof(step_params, until), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,
             "when it goes again, since the start of the run; stays if absent"),
    LAC_SHARE_ROW(step_params, share),
};

const lac_load_kind lac_shear_step = {
    .info =
        LAC_ABOUT("step", "shear stress that comes at a stated time, for good or for a while",
                  "Dieterich (1994) J. Geophys. Res. 99, 2601, doi 10.1029/93JB02581 (stress step)",
                  LAC_ROWS(params, step_params), .validate = fault),
    .linear = true,
    .signal = step_at,
    .next_break = next_break,
};

const lac_load_kind lac_pore_step = {
    .info = LAC_ABOUT("step", "pore pressure that comes at a stated time, for good or for a while",
                      "docs/theory/loads.md, \"Triggering\"", LAC_PORE_ROWS(params, step_params),
                      .validate = fault),
    .linear = true,
    .signal = step_at,
    .next_break = next_break,
};
