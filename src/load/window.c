// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress, pore pressure or normal stress between two times: a ramp, which then holds what it
// has come to; a step, for good or for a while, as a trigger; a swing, as tides, machines and
// seasons make it.
#include "load/kinds.h"

// What all begin with: from start to end; an end of NaN never comes.
typedef struct window {
    double start, end; // [s]
} window;

typedef struct ramp_params {
    window on;
    double rate;    // [Pa/s]
    double azimuth; // of shear only [rad]; NaN: along x
    int share;      // lac_share; of shear only
} ramp_params;

typedef struct step_params {
    window on;
    double value;   // [Pa]
    double azimuth; // of shear only [rad]; NaN: along x
    int share;      // lac_share; of shear only
} step_params;

typedef struct sine_params {
    window on;
    double amplitude; // [Pa]
    double period;    // [s]
    double phase;     // [rad]
    double azimuth;   // of shear only [rad]; NaN: along x
    int share;        // lac_share; of shear only
} sine_params;

static bool is_on(const window *on, double t) { return t >= on->start && !(t >= on->end); }

static double next_break(const lac_load *load, double t)
{
    const window *on = load->params;
    double next = t < on->start ? on->start : isnan(on->end) || t >= on->end ? INFINITY : on->end;
    return on->end <= on->start ? INFINITY : next;
}

static const char *fault(const void *p)
{
    const window *on = p;
    return on->end <= on->start ? "end must be later than start" : NULL;
}

// rate (min(t, end) - start), from start on
static lac_signal ramp_at(const lac_load *load, double t)
{
    const ramp_params *ramp = load->params;
    if (t < ramp->on.start || ramp->on.end <= ramp->on.start) {
        return (lac_signal){0.0, 0.0};
    }
    return (lac_signal){ramp->rate * (fmin(t, ramp->on.end) - ramp->on.start),
                        t >= ramp->on.end ? 0.0 : ramp->rate};
}

static const lac_param ramp_rows[] = {
    LAC_REAL(
        "rate", "Pa/s", offsetof(ramp_params, rate), NAN, -INFINITY, INFINITY, 0,
        "rate of the stress over the nominal area, or of the pore pressure; negative unloads or "
        "drains"),
    LAC_START_ROW(window),
    LAC_REAL("end", "s", offsetof(window, end), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,
             "when it ends, since the start of the run, what it has come to being held from then "
             "on; never if absent"),
    LAC_AZIMUTH_ROW(ramp_params),
    LAC_SHARE_ROW(ramp_params, share),
};

#define WINDOWED(row, name, text, source, rows, wrong, at)                \
    const lac_load_kind row = {                                           \
        .info = LAC_ABOUT(name, text, source, rows, .validate = (wrong)), \
        .linear = true,                                                   \
        .signal = (at),                                                   \
        .next_break = next_break,                                         \
    }

#define RAMP(row, what, source, rows)                                                        \
    WINDOWED(row, "ramp", what " that changes at a constant rate between two times", source, \
             rows(ramp_rows, ramp_params), fault, ramp_at)

RAMP(lac_shear_ramp, "shear stress",
     "Dieterich (1994) J. Geophys. Res. 99, 2601, doi 10.1029/93JB02581 (constant stressing rate)",
     LAC_ROWS);
RAMP(lac_pore_ramp, "pore pressure", "docs/theory/loads.md, \"Pore pressure\"", LAC_PORE_ROWS);
RAMP(lac_pressing_ramp, "normal stress", LAC_PRESSING_SOURCE, LAC_PORE_ROWS);

// value from `at` to `until`
static lac_signal step_at(const lac_load *load, double t)
{
    const step_params *step = load->params;
    return (lac_signal){is_on(&step->on, t) ? step->value : 0.0, 0.0};
}

static const char *step_fault(const void *p)
{
    return fault(p) != NULL ? "until must be later than at" : NULL;
}

static const lac_param step_rows[] = {
    LAC_REAL("value", "Pa", offsetof(step_params, value), NAN, -INFINITY, INFINITY, 0,
             "stress over the nominal area, or pore pressure, that is added; negative takes away"),
    LAC_REAL("at", "s", offsetof(window, start), NAN, -INFINITY, INFINITY, 0,
             "when it comes, since the start of the run"),
    LAC_REAL("until", "s", offsetof(window, end), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,
             "when it goes again, since the start of the run; stays if absent"),
    LAC_AZIMUTH_ROW(step_params),
    LAC_SHARE_ROW(step_params, share),
};

#define STEP(row, what, source, rows)                                                           \
    WINDOWED(row, "step", what " that comes at a stated time, for good or for a while", source, \
             rows(step_rows, step_params), step_fault, step_at)

STEP(lac_shear_step, "shear stress",
     "Dieterich (1994) J. Geophys. Res. 99, 2601, doi 10.1029/93JB02581 (stress step)", LAC_ROWS);
STEP(lac_pore_step, "pore pressure", "docs/theory/loads.md, \"Triggering\"", LAC_PORE_ROWS);
STEP(lac_pressing_step, "normal stress", LAC_PRESSING_SOURCE, LAC_PORE_ROWS);

// amplitude sin(2 pi (t - start)/period + phase) from start to end
static lac_signal sine_at(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    if (!is_on(&sine->on, t)) {
        return (lac_signal){0.0, 0.0};
    }
    double omega = 2.0 * LAC_PI / sine->period;
    double angle = omega * fmod(t - sine->on.start, sine->period) + sine->phase;
    return (lac_signal){sine->amplitude * sin(angle), sine->amplitude * omega * cos(angle)};
}

static double longest_step(const lac_load *load, double t)
{
    const sine_params *sine = load->params;
    return sine->amplitude > 0.0 && is_on(&sine->on, t) ? sine->period / 8 : INFINITY;
}

static const lac_param sine_rows[] = {
    LAC_REAL("amplitude", "Pa", offsetof(sine_params, amplitude), NAN, 0, INFINITY, 0,
             "half the range, of stress over the nominal area or of pore pressure"),
    LAC_REAL("period", "s", offsetof(sine_params, period), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "of one cycle"),
    LAC_REAL("phase", "rad", offsetof(sine_params, phase), 0, -1e6, 1e6, 0,
             "at the start; 90 degree begins at the crest"),
    LAC_START_ROW(window),
    LAC_REAL("end", "s", offsetof(window, end), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,
             "when it ends, since the start of the run; never if absent"),
    LAC_AZIMUTH_ROW(sine_params),
    LAC_SHARE_ROW(sine_params, share),
};

#define SINE(row, text, source, rows)                                                             \
    const lac_load_kind row = {                                                                   \
        .info = LAC_ABOUT("sine", text, source, rows(sine_rows, sine_params), .validate = fault), \
        .signal = sine_at,                                                                        \
        .next_break = next_break,                                                                 \
        .longest_step = longest_step,                                                             \
    }
#define PERFETTINI "Perfettini et al. (2001) J. Geophys. Res. 106, 13455, doi 10.1029/2000JB900366"

SINE(lac_shear_sine, "shear stress that swings, as tides and machines make it",
     "Beeler & Lockner (2003) J. Geophys. Res. 108, 2391, doi 10.1029/2001JB001518", LAC_ROWS);
SINE(lac_pore_sine, "pore pressure that swings, as the seasons make it", PERFETTINI, LAC_PORE_ROWS);
SINE(lac_pressing_sine, "normal stress that swings, as tides make it", PERFETTINI, LAC_PORE_ROWS);
