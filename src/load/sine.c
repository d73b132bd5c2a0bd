// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/kinds.h"
#include "load/signal.h"

typedef struct sine_params {
    double amplitude; // [Pa]
    double period;    // [s]
    double phase;     // [rad]
    double start;     // [s]
    double end;       // [s]; NaN: never
    int share;        // lac_share; of shear only
} sine_params;

// amplitude sin(2 pi (t - start)/period + phase) from start to end
static lac_signal sine_at(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    if (t < sine->start || t >= lac_end_of(sine->end)) {
        return (lac_signal){0.0, 0.0};
    }
    double omega = 2.0 * LAC_PI / sine->period;
    double angle = omega * fmod(t - sine->start, sine->period) + sine->phase;
    return (lac_signal){sine->amplitude * sin(angle), sine->amplitude * omega * cos(angle)};
}

static void add_shear(const lac_load *load, double t, lac_load_state *sum)
{
    lac_add_stress(load, sum, sine_at(load, t));
}

static void add_pore(const lac_load *load, double t, lac_load_state *sum)
{
    lac_add_pore(sum, sine_at(load, t));
}

static double next_break(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    return lac_window_break(sine->start, lac_end_of(sine->end), t);
}

static double longest_step(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    bool swings = sine->amplitude > 0.0 && t >= sine->start && t < lac_end_of(sine->end);
    return swings ? sine->period / 8 : INFINITY;
}

static const char *fault(const void *p)
{
    const sine_params *sine = p;
    return sine->end <= sine->start ? "end must be later than start" : NULL;
}

static const lac_param params[] = {
    {.key = "amplitude",
     .unit = "Pa",
     .fallback = NAN,
     .min = 0,
     .max = INFINITY,
     .offset = offsetof(sine_params, amplitude),
     .doc = "half the range, of shear stress over the nominal area or of pore pressure"},
    {.key = "period",
     .unit = "s",
     .fallback = NAN,
     .min = 0,
     .max = INFINITY,
     .offset = offsetof(sine_params, period),
     .flags = LAC_ABOVE_MIN,
     .doc = "of one cycle"},
    {.key = "phase",
     .unit = "rad",
     .fallback = 0,
     .min = -1e6,
     .max = 1e6,
     .offset = offsetof(sine_params, phase),
     .doc = "at the start; 90 degree begins at the crest"},
    {.key = "start",
     .unit = "s",
     .fallback = 0,
     .min = -INFINITY,
     .max = INFINITY,
     .offset = offsetof(sine_params, start),
     .doc = "when it begins, since the start of the run"},
    {.key = "end",
     .unit = "s",
     .fallback = NAN,
     .min = -INFINITY,
     .max = INFINITY,
     .offset = offsetof(sine_params, end),
     .flags = LAC_OPTIONAL,
     .doc = "when it ends, since the start of the run; never if absent"},
    LAC_SHARE_ROW(sine_params, share),
};

const lac_load_kind lac_shear_sine = {
    .about = {.name = "sine",
              .summary = "shear stress that swings, as tides and machines make it",
              .reference = "Beeler & Lockner (2003) J. Geophys. Res. 108, 2391, doi "
                           "10.1029/2001JB001518",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(sine_params),
              .fault = fault},
    .add = add_shear,
    .next_break = next_break,
    .longest_step = longest_step,
};

const lac_load_kind lac_pore_sine = {
    .about = {.name = "sine",
              .summary = "pore pressure that swings, as the seasons make it",
              .reference = "Perfettini et al. (2001) J. Geophys. Res. 106, 13455, doi "
                           "10.1029/2000JB900366",
              .params = params,
              .param_count =
                  sizeof params / sizeof params[0] - 1, // no share: all cells feel it alike
              .params_size = sizeof(sine_params),
              .fault = fault},
    .add = add_pore,
    .next_break = next_break,
    .longest_step = longest_step,
};
