// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress, pore pressure or normal stress from readings of a file, by straight lines or a
// smooth curve; and a spring whose far end moves as these say.
#include <gsl/gsl_interp.h>

#include "load/kinds.h"

enum { LINEAR, SMOOTH };
enum { REFUSE, HOLD, ZERO };

typedef struct series_params {
    char *file, *time, *value, *per;
    double scale;  // [1]
    double offset; // [s]
    int interpolation, outside;
    double azimuth;   // of shear only [rad]; NaN: along x
    int share;        // lac_share; of shear only
    double stiffness; // of a machine [Pa/m]
} series_params;

typedef struct series_state {
    lac_readings readings;
    gsl_interp *curve; // smooth, which overshoots nowhere; NULL: straight lines
    double from;       // of a machine, where the far end is as the run starts [m]
} series_state;

static void release(void *p)
{
    series_state *state = p;
    lac_readings_clear(&state->readings);
    gsl_interp_free(state->curve);
}

// Through two readings it is a straight line. An offset may bring two to one time.
static lac_status smooth(const char *path, series_state *state, lac_error *err)
{
    const lac_readings *r = &state->readings;
    for (size_t i = 1; i < r->n; i++) {
        LAC_FAIL_IF(!(r->t[i] > r->t[i - 1]), err, LAC_EINPUT,
                    "%s: two readings are at one time, %g s of the run: interpolation smooth needs "
                    "one at each",
                    path, r->t[i]);
    }
    if (r->n < gsl_interp_type_min_size(gsl_interp_steffen)) {
        return LAC_OK;
    }
    state->curve = gsl_interp_alloc(gsl_interp_steffen, r->n);
    LAC_FAIL_MEMORY_IF(state->curve == NULL, err);
    (void)gsl_interp_init(state->curve, r->t, r->value, r->n);
    return LAC_OK;
}

static lac_status prepare_as(const char *si, const series_params *s, const lac_load_clock *clock,
                             series_state *state, lac_error *err)
{
    const lac_readings_def def = {.path = s->file,
                                  .time = s->time,
                                  .column = s->value,
                                  .per = s->per,
                                  .si = si,
                                  .offset = s->offset};
    const char *remedy = s->outside == REFUSE ? ", or say outside: hold or zero" : NULL;
    LAC_TRY_RETURN(lac_readings_read(&def, clock, remedy, &state->readings, err));
    return s->interpolation == SMOOTH ? smooth(s->file, state, err) : LAC_OK;
}

static lac_status prepare(const void *p, const lac_load_clock *clock, void *state, lac_error *err)
{
    return prepare_as("Pa", p, clock, state, err);
}

static lac_signal look(const series_params *s, const series_state *state, double t)
{
    const lac_readings *r = &state->readings;
    const bool outside = t < r->t[0] || t >= r->t[r->n - 1];
    if (outside && s->outside == ZERO) {
        return (lac_signal){0.0, 0.0};
    }
    return outside || state->curve == NULL
               ? lac_readings_at(r, t)
               : (lac_signal){gsl_interp_eval(state->curve, r->t, r->value, t, NULL),
                              gsl_interp_eval_deriv(state->curve, r->t, r->value, t, NULL)};
}

static lac_signal series_at(const lac_load *load, double t)
{
    const double scale = ((const series_params *)load->params)->scale;
    const lac_signal signal = look(load->params, load->state, t);
    return (lac_signal){scale * signal.value, scale * signal.rate};
}

static lac_status prepare_machine(const void *p, const lac_load_clock *clock, void *at,
                                  lac_error *err)
{
    series_state *state = at;
    LAC_TRY_RETURN(prepare_as("m", p, clock, state, err));
    state->from = look(p, state, 0.0).value;
    return LAC_OK;
}

// tau = k (x(t) - x(0) - mean slip); the slip's part is the model's
static void add_machine(const lac_load *load, double t, lac_load_state *sum)
{
    const series_params *machine = load->params;
    const series_state *state = load->state;
    const lac_signal far = look(machine, state, t);
    sum->spring_stiffness += machine->stiffness;
    sum->spring_stress += machine->stiffness * (far.value - state->from);
    sum->spring_rate += machine->stiffness * far.rate;
}

static double stiffness_of(const void *p) { return ((const series_params *)p)->stiffness; }

// Straight lines bend at every reading, smooth curves turn there: a long step of a cell at rest
// would leap over what lies between two of them.
static double next_break(const lac_load *load, double t)
{
    const lac_readings *r = &((const series_state *)load->state)->readings;
    return lac_readings_next(r->t, r->n, t);
}

static double longest_step(const lac_load *load, double t)
{
    const series_params *s = load->params;
    const lac_readings *r = &((const series_state *)load->state)->readings;
    if (s->interpolation == LINEAR || t < r->t[0] || t >= r->t[r->n - 1]) {
        return INFINITY;
    }
    size_t i = lac_readings_before(r->t, r->n, t);
    return 0.125 * (r->t[i + 1] - r->t[i]);
}

static const char *const interpolations[] = {"linear", "smooth", NULL};
static const char *const outsides[] = {"refuse", "hold", "zero", NULL};
static const char *const machine_outsides[] = {"refuse", "hold", NULL};

static const lac_param params[] = {
    LAC_PATH("file", offsetof(series_params, file), 0, "CSV with a header, or netCDF"),
    LAC_TIME_COLUMN_ROW(series_params),
    LAC_TEXT("value", offsetof(series_params, value), 0,
             "column and its unit, such as \"pressure:kPa\" or, with per, \"acceleration:cm/s2\""),
    LAC_TEXT("per", offsetof(series_params, per), LAC_OPTIONAL,
             "stress that one unit of the column makes, such as \"9807 Pa/m\" or \"5e5 kg/m2\"; "
             "the column is a stress if absent"),
    LAC_REAL("scale", "1", offsetof(series_params, scale), 1, -1e12, 1e12, 0, "factor on it all"),
    LAC_OFFSET_ROW(series_params, "the data come this much later than their times say"),
    LAC_CHOICE("interpolation", offsetof(series_params, interpolation), LINEAR, interpolations, 0,
               "straight lines, or a smooth curve that overshoots nowhere; the integrator begins "
               "anew at every reading"),
    LAC_CHOICE("outside", offsetof(series_params, outside), REFUSE, outsides, 0,
               "before the first reading and after the last: refuse, hold them, or zero"),
    LAC_AZIMUTH_ROW(series_params),
    LAC_SHARE_ROW(series_params, share),
};

#define SERIES(row, text, rows)                                                                  \
    const lac_load_kind row = {                                                                  \
        .info = LAC_ABOUT("series", text, "Steffen (1990) Astron. Astrophys. 239, 443 (smooth)", \
                          rows(params, series_params)),                                          \
        .state_size = sizeof(series_state),                                                      \
        .prepare = prepare,                                                                      \
        .release = release,                                                                      \
        .signal = series_at,                                                                     \
        .next_break = next_break,                                                                \
        .longest_step = longest_step,                                                            \
    }

SERIES(lac_shear_series, "shear stress read from a file: recorded shaking, tremor", LAC_ROWS);
SERIES(lac_pore_series, "pore pressure read from a file: a piezometer", LAC_PORE_ROWS);
SERIES(lac_pressing_series, "normal stress read from a file: a fill, a dig, tides", LAC_PORE_ROWS);

static const lac_param machine_rows[] = {
    LAC_PATH("file", offsetof(series_params, file), 0, "CSV with a header, or netCDF"),
    LAC_TIME_COLUMN_ROW(series_params),
    LAC_TEXT("displacement", offsetof(series_params, value), 0,
             "column of the far end's displacement and its unit, such as \"load_point:um\""),
    LAC_REAL("stiffness", "Pa/m", offsetof(series_params, stiffness), NAN, 0, INFINITY,
             LAC_ABOVE_MIN, "shear stress over the nominal area for each metre of stretch"),
    LAC_OFFSET_ROW(series_params, "the data come this much later than their times say"),
    LAC_CHOICE("interpolation", offsetof(series_params, interpolation), LINEAR, interpolations, 0,
               "straight lines, or a smooth curve that overshoots nowhere; the integrator begins "
               "anew at every reading"),
    LAC_CHOICE("outside", offsetof(series_params, outside), REFUSE, machine_outsides, 0,
               "before the first reading and after the last: refuse, or hold the far end"),
    LAC_AZIMUTH_ROW(series_params),
};

const lac_load_kind lac_shear_machine = {
    .info = LAC_ABOUT("machine",
                      "a laboratory machine: a spring on the mean slip, its far end moved as a "
                      "file says: velocity steps",
                      "Dieterich (1979) J. Geophys. Res. 84, 2161, doi 10.1029/JB084iB05p02161",
                      LAC_ROWS(machine_rows, series_params)),
    .state_size = sizeof(series_state),
    .prepare = prepare_machine,
    .release = release,
    .stiffness = stiffness_of,
    .add = add_machine,
    .next_break = next_break,
    .longest_step = longest_step,
};
