// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/kinds.h"

typedef struct ramp_params {
    double rate;  // [Pa/s]
    double start; // [s]
    double end;   // [s]; NaN: it never ends
    int share;    // ramp_share
} ramp_params;

// How the stress is shared by the cells.
typedef enum ramp_share { BY_PRESSURE = 0, EQUAL } ramp_share;

static const char *const shares[] = {"pressure", "equal", NULL};

static double end_of(const ramp_params *ramp) { return isnan(ramp->end) ? INFINITY : ramp->end; }

// stress = rate (min(t, end) - start), from start on
static void add(const void *p, double t, lac_load_state *sum)
{
    const ramp_params *ramp = p;
    double end = end_of(ramp);
    if (t < ramp->start || end <= ramp->start) {
        return;
    }
    double stress = ramp->rate * (fmin(t, end) - ramp->start);
    double rate = t < end ? ramp->rate : 0;
    // A spring's stress is the same on all cells; here it has no stiffness.
    *(ramp->share == EQUAL ? &sum->spring_stress : &sum->stress) += stress;
    *(ramp->share == EQUAL ? &sum->spring_rate : &sum->stress_rate) += rate;
}

static double next_break(const void *p, double t)
{
    const ramp_params *ramp = p;
    double end = end_of(ramp);
    if (end <= ramp->start) {
        return INFINITY;
    }
    if (t < ramp->start) {
        return ramp->start;
    }
    return t < end ? end : INFINITY;
}

static const char *fault(const void *p)
{
    const ramp_params *ramp = p;
    return ramp->end <= ramp->start ? "end must be later than start" : NULL;
}

static const lac_param params[] = {
    {.key = "rate",
     .unit = "Pa/s",
     .fallback = NAN,
     .min = -INFINITY,
     .max = INFINITY,
     .offset = offsetof(ramp_params, rate),
     .doc = "rate of the shear stress over the nominal area; negative unloads"},
    {.key = "start",
     .unit = "s",
     .fallback = 0,
     .min = -INFINITY,
     .max = INFINITY,
     .offset = offsetof(ramp_params, start),
     .doc = "when it begins, since the start of the run"},
    {.key = "end",
     .unit = "s",
     .fallback = NAN,
     .min = -INFINITY,
     .max = INFINITY,
     .offset = offsetof(ramp_params, end),
     .flags = LAC_OPTIONAL,
     .doc = "when it ends, since the start of the run, the stress being held from then on; never "
            "if absent"},
    {.key = "share",
     .unit = "1",
     .fallback = BY_PRESSURE,
     .type = LAC_CHOICE,
     .choices = shares,
     .offset = offsetof(ramp_params, share),
     .doc = "of each cell: in proportion to its pressure, or the same stress on all (equal)"},
};

const lac_load_kind lac_shear_ramp = {
    .about = {.name = "ramp",
              .summary = "shear stress that changes at a constant rate between two times",
              .reference = "",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(ramp_params),
              .fault = fault},
    .add = add,
    .next_break = next_break,
};
