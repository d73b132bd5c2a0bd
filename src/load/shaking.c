// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress from ground that shakes as a sine: the mass above the joint pushes by its inertia.
#include "load/kinds.h"

typedef struct shaking_params {
    double acceleration; // of the ground, its peak [m/s2]
    double frequency;    // [1/s]
    double mass;         // of the rock above, for each unit of nominal area [kg/m2]
    double start;        // [s]
    double duration;     // [s]
    double taper;        // of its rise and of its fall [s]
    double azimuth;      // of shear only [rad]; NaN: along x
    int share;           // lac_share
} shaking_params;

// How much of the swing is there at tau after the start: a cosine up and down, 1 between.
static lac_signal envelope(const shaking_params *s, double tau)
{
    double left = fmin(tau, s->duration - tau);
    if (left >= s->taper) {
        return (lac_signal){1.0, 0.0};
    }
    double pace = LAC_PI / s->taper;
    double sense = tau < 0.5 * s->duration ? 1.0 : -1.0;
    return (lac_signal){0.5 * (1.0 - cos(pace * left)), sense * 0.5 * pace * sin(pace * left)};
}

// The rock's own frame: a mass m under the acceleration a pushes with m a.
static lac_signal shaking_at(const lac_load *load, double t)
{
    const shaking_params *s = load->params;
    double tau = t - s->start;
    if (tau < 0.0 || t >= s->start + s->duration) {
        return (lac_signal){0.0, 0.0};
    }
    double omega = 2.0 * LAC_PI * s->frequency;
    double stress = s->mass * s->acceleration;
    lac_signal share = envelope(s, tau);
    double swing = sin(omega * tau);
    return (lac_signal){stress * share.value * swing,
                        stress * (share.rate * swing + share.value * omega * cos(omega * tau))};
}

static double next_break(const lac_load *load, double t)
{
    const shaking_params *s = load->params;
    double end = s->start + s->duration;
    const double breaks[] = {s->start, s->start + s->taper, end - s->taper, end};
    for (size_t i = 0; i < sizeof breaks / sizeof breaks[0]; i++) {
        if (t < breaks[i]) {
            return breaks[i];
        }
    }
    return INFINITY;
}

static double longest_step(const lac_load *load, double t)
{
    const shaking_params *s = load->params;
    bool swings = s->acceleration > 0.0 && t >= s->start && t < s->start + s->duration;
    return swings ? 0.125 / s->frequency : INFINITY;
}

static const char *fault(const void *p)
{
    const shaking_params *s = p;
    return 2.0 * s->taper > s->duration ? "taper must be at most half the duration" : NULL;
}

static const lac_param params[] = {
    LAC_REAL("acceleration", "m/s2", offsetof(shaking_params, acceleration), NAN, 0, 1e6, 0,
             "peak acceleration along the slip"),
    LAC_REAL("frequency", "1/s", offsetof(shaking_params, frequency), NAN, 0, 1e9, LAC_ABOVE_MIN,
             "of the swing"),
    LAC_REAL("mass", "kg/m2", offsetof(shaking_params, mass), NAN, 0, 1e15, LAC_ABOVE_MIN,
             "of the rock that rides on the interface, for each unit of nominal area: density "
             "times thickness"),
    LAC_START_ROW(shaking_params),
    LAC_REAL("duration", "s", offsetof(shaking_params, duration), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "how long it lasts"),
    LAC_REAL("taper", "s", offsetof(shaking_params, taper), 0, 0, INFINITY, 0,
             "time in which it grows at first and fades at last, as half a cosine"),
    LAC_AZIMUTH_ROW(shaking_params),
    LAC_SHARE_ROW(shaking_params, share),
};

const lac_load_kind lac_shear_shaking = {
    .info = LAC_ABOUT("shaking", "ground that shakes as a sine under a rigid mass; records: series",
                      "Newmark (1965) Geotechnique 15, 139, doi 10.1680/geot.1965.15.2.139",
                      LAC_ROWS(params, shaking_params), .validate = fault),
    .signal = shaking_at,
    .next_break = next_break,
    .longest_step = longest_step,
};
