// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress or pore pressure that swings, as tides, machines and seasons make it.
#include "load/kinds.h"

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
    if (t < sine->start || t >= sine->end) {
        return (lac_signal){0.0, 0.0};
    }
    double omega = 2.0 * LAC_PI / sine->period;
    double angle = omega * fmod(t - sine->start, sine->period) + sine->phase;
    return (lac_signal){sine->amplitude * sin(angle), sine->amplitude * omega * cos(angle)};
}

static double next_break(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    return lac_window_break(sine->start, sine->end, t);
}

static double longest_step(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    bool swings = sine->amplitude > 0.0 && t >= sine->start && !(t >= sine->end);
    return swings ? sine->period / 8 : INFINITY;
}

static const char *fault(const void *p)
{
    const sine_params *sine = p;
    return sine->end <= sine->start ? "end must be later than start" : NULL;
}

static const lac_param params[] = {
    LAC_REAL("amplitude", "Pa", offsetof(sine_params, amplitude), NAN, 0, INFINITY, 0,
             "half the range, of shear stress over the nominal area or of pore pressure"),
    LAC_REAL("period", "s", offsetof(sine_params, period), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "of one cycle"),
    LAC_REAL("phase", "rad", offsetof(sine_params, phase), 0, -1e6, 1e6, 0,
             "at the start; 90 degree begins at the crest"),
    LAC_START_ROW(sine_params),
    LAC_REAL("end", "s", offsetof(sine_params, end), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,
             "when it ends, since the start of the run; never if absent"),
    LAC_SHARE_ROW(sine_params, share),
};

const lac_load_kind lac_shear_sine = {
    .info =
        LAC_ABOUT("sine", "shear stress that swings, as tides and machines make it",
                  "Beeler & Lockner (2003) J. Geophys. Res. 108, 2391, doi 10.1029/2001JB001518",
                  LAC_ROWS(params, sine_params), .validate = fault),
    .signal = sine_at,
    .next_break = next_break,
    .longest_step = longest_step,
};

const lac_load_kind lac_pore_sine = {
    .info =
        LAC_ABOUT("sine", "pore pressure that swings, as the seasons make it",
                  "Perfettini et al. (2001) J. Geophys. Res. 106, 13455, doi 10.1029/2000JB900366",
                  LAC_PORE_ROWS(params, sine_params), .validate = fault),
    .signal = sine_at,
    .next_break = next_break,
    .longest_step = longest_step,
};
