// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/kinds.h"

typedef struct ramp_params {
    double rate;  // [Pa/s]
    double start; // [s]
    double end;   // [s]; NaN: it never ends
} ramp_params;

static double end_of(const ramp_params *ramp) { return isnan(ramp->end) ? INFINITY : ramp->end; }

// stress = rate (min(t, end) - start), from start on
static void add(const void *p, double t, lac_load_state *sum)
{
    const ramp_params *ramp = p;
    double end = end_of(ramp);
    if (t < ramp->start || end <= ramp->start) {
        return;
    }
    sum->stress += ramp->rate * (fmin(t, end) - ramp->start);
    sum->stress_rate += t < end ? ramp->rate : 0;
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
