// SPDX-License-Identifier: GPL-3.0-or-later
// Shear stress, pore pressure or normal stress from readings of a file, by straight lines or a
// smooth curve.
#include <math.h>
#include <stdlib.h>

#include "load/kinds.h"

enum { LINEAR, SMOOTH };
enum { REFUSE, HOLD, ZERO };

typedef struct series_params {
    char *file, *time, *value, *per;
    double scale;  // [1]
    double offset; // [s]
    int interpolation, outside;
    double azimuth; // of shear only [rad]; NaN: along x
    int share;      // lac_share; of shear only
} series_params;

typedef struct series_state {
    lac_readings readings;
    double *slope; // [n] of the smooth curve at each reading [Pa/s]; NULL: straight lines
} series_state;

static void release(void *p)
{
    series_state *state = p;
    lac_readings_clear(&state->readings);
    free(state->slope);
    free(state);
}

static double secant(const lac_readings *r, size_t i)
{
    return (r->value[i + 1] - r->value[i]) / (r->t[i + 1] - r->t[i]);
}

// Steffen's slope at a reading between two others: that of their parabola, but no more than twice
// either secant, and none at an extreme, so that the curve overshoots nowhere (1990, eq. 11).
static double steffen_slope(const lac_readings *r, size_t i)
{
    double left = secant(r, i - 1);
    double right = secant(r, i);
    double h_left = r->t[i] - r->t[i - 1];
    double h_right = r->t[i + 1] - r->t[i];
    double parabola = (left * h_right + right * h_left) / (h_left + h_right);
    double least = fmin(fmin(fabs(left), fabs(right)), 0.5 * fabs(parabola));
    return (copysign(1.0, left) + copysign(1.0, right)) * least;
}

// Slopes of the smooth curve: at its ends the secants.
static lac_status smooth(series_state *state, lac_error *err)
{
    const lac_readings *r = &state->readings;
    state->slope = malloc(r->n * sizeof *state->slope);
    LAC_FAIL_MEMORY_IF(state->slope == NULL, err);
    for (size_t i = 1; i + 1 < r->n; i++) {
        state->slope[i] = steffen_slope(r, i);
    }
    state->slope[0] = r->n > 1 ? secant(r, 0) : 0.0;
    state->slope[r->n - 1] = r->n > 1 ? secant(r, r->n - 2) : 0.0;
    return LAC_OK;
}

static lac_status prepare(const void *p, const lac_load_clock *clock, void **out, lac_error *err)
{
    const series_params *s = p;
    const lac_readings_def def = {.path = s->file,
                                  .time = s->time,
                                  .column = s->value,
                                  .per = s->per,
                                  .si = "Pa",
                                  .offset = s->offset};
    lac_status status = LAC_OK;
    series_state *state = calloc(1, sizeof *state);
    LAC_FAIL_MEMORY_IF(state == NULL, err);
    LAC_TRY(lac_readings_read(&def, clock,
                              s->outside == REFUSE ? ", or say outside: hold or zero" : NULL,
                              &state->readings, err));
    if (s->interpolation == SMOOTH) {
        LAC_TRY(smooth(state, err));
    }
    *out = state;
    state = NULL;
out:
    if (state != NULL) {
        release(state);
    }
    return status;
}

// Value and rate between readings i and i + 1.
static lac_signal between(const series_state *state, size_t i, double t)
{
    const lac_readings *r = &state->readings;
    double h = r->t[i + 1] - r->t[i];
    double x = (t - r->t[i]) / h;
    double rise = r->value[i + 1] - r->value[i];
    if (state->slope == NULL) {
        return (lac_signal){r->value[i] + x * rise, rise / h};
    }
    // Cubic Hermite: what the ends' slopes have beyond the secant
    double first = h * state->slope[i] - rise;
    double last = h * state->slope[i + 1] - rise;
    double bend = x * (1.0 - x) * ((1.0 - x) * first - x * last);
    double turn = (1.0 - x) * (1.0 - 3.0 * x) * first + x * (3.0 * x - 2.0) * last;
    return (lac_signal){r->value[i] + x * rise + bend, (rise + turn) / h};
}

static lac_signal series_at(const lac_load *load, double t)
{
    const series_params *s = load->params;
    const series_state *state = load->state;
    const lac_readings *r = &state->readings;
    bool before = t < r->t[0];
    bool after = t >= r->t[r->n - 1];
    if (before || after) {
        double held = s->outside == ZERO ? 0.0 : r->value[before ? 0 : r->n - 1];
        return (lac_signal){s->scale * held, 0.0};
    }
    lac_signal signal = between(state, lac_readings_before(r->t, r->n, t), t);
    return (lac_signal){s->scale * signal.value, s->scale * signal.rate};
}

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

const lac_load_kind lac_shear_series = {
    .info = LAC_ABOUT("series", "shear stress read from a file: recorded shaking, tremor",
                      "Steffen (1990) Astron. Astrophys. 239, 443 (smooth)",
                      LAC_ROWS(params, series_params)),
    .prepare = prepare,
    .release = release,
    .signal = series_at,
    .next_break = next_break,
    .longest_step = longest_step,
};

const lac_load_kind lac_pore_series = {
    .info = LAC_ABOUT("series", "pore pressure read from a file: a piezometer",
                      "Steffen (1990) Astron. Astrophys. 239, 443 (smooth)",
                      LAC_PORE_ROWS(params, series_params)),
    .prepare = prepare,
    .release = release,
    .signal = series_at,
    .next_break = next_break,
    .longest_step = longest_step,
};

const lac_load_kind lac_pressing_series = {
    .info = LAC_ABOUT("series", "normal stress read from a file: a fill, a dig, tides",
                      "Steffen (1990) Astron. Astrophys. 239, 443 (smooth)",
                      LAC_PORE_ROWS(params, series_params)),
    .prepare = prepare,
    .release = release,
    .signal = series_at,
    .next_break = next_break,
    .longest_step = longest_step,
};
