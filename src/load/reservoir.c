// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure from readings of a lake's level: at once, with a lag, or by diffusion through rock.
#include <stdlib.h>

#include "load/diffused.h"
#include "load/kinds.h"
#include "load/lagged.h"
#include "load/table.h"

enum { REFUSE, HOLD };

typedef struct reservoir_params {
    char *file, *time, *level;
    double elevation;             // of the interface [m]
    double share;                 // of the head that reaches it [1]
    double unit_weight;           // of the water [Pa/m]
    double lag;                   // [s]; NaN: none
    double distance, diffusivity; // [m], [m2/s]; NaN: none
    double offset;                // [s]
    int outside;
} reservoir_params;

typedef struct reservoir_state {
    lac_lagged lagged;     // the pressure at the lake's side, followed with the lag
    lac_diffused diffused; // or what has come through the rock; n = 0: not used
} reservoir_state;

static void release(void *p)
{
    reservoir_state *state = p;
    lac_lagged_clear(&state->lagged);
    lac_diffused_clear(&state->diffused);
    free(state);
}

// Pressure of the water that stands above the interface.
static double pressure_of(const reservoir_params *s, double level)
{
    return s->share * s->unit_weight * fmax(level - s->elevation, 0.0);
}

// Straight pieces between readings; where the level crosses the interface there is one more.
static void add_pieces(const reservoir_params *s, const lac_readings *r, lac_lagged *out)
{
    double first = pressure_of(s, r->value[0]);
    for (size_t i = 0; i + 1 < r->n; i++) {
        double from = r->value[i] - s->elevation;
        double to = r->value[i + 1] - s->elevation;
        double h = r->t[i + 1] - r->t[i];
        double rate = s->share * s->unit_weight * (to - from) / h;
        double crossing = r->t[i] + h * (from / (from - to));
        if (from < 0.0 && to > 0.0 && crossing > r->t[i] && crossing < r->t[i + 1]) {
            lac_lagged_add(out, r->t[i], 0.0, 0.0);
            lac_lagged_add(out, crossing, 0.0, rate);
        } else if (from > 0.0 && to < 0.0 && crossing > r->t[i] && crossing < r->t[i + 1]) {
            lac_lagged_add(out, r->t[i], pressure_of(s, r->value[i]), rate);
            lac_lagged_add(out, crossing, 0.0, 0.0);
        } else {
            bool wet = from >= 0.0 && to >= 0.0;
            lac_lagged_add(out, r->t[i], pressure_of(s, r->value[i]), wet ? rate : 0.0);
        }
    }
    lac_lagged_add(out, r->t[r->n - 1], pressure_of(s, r->value[r->n - 1]), 0.0);
    lac_lagged_settle(out, first);
}

static lac_status prepare(const void *p, const lac_load_clock *clock, void **out, lac_error *err)
{
    const reservoir_params *s = p;
    const lac_readings_def def = {
        .path = s->file, .time = s->time, .column = s->level, .si = "m", .offset = s->offset};
    lac_readings readings = {0};
    lac_status status = LAC_OK;
    reservoir_state *state = calloc(1, sizeof *state);
    if (state == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(lac_readings_read(&def, clock, &readings, err));
    if (s->outside == REFUSE) {
        LAC_TRY(lac_readings_cover(&readings, s->file, clock, ", or say outside: hold", err));
    }
    LAC_TRY(lac_lagged_create(2 * readings.n, isnan(s->lag) ? 0.0 : s->lag, &state->lagged, err));
    add_pieces(s, &readings, &state->lagged);
    if (!isnan(s->distance)) {
        LAC_TRY(lac_diffused_create(&state->lagged, s->distance, s->diffusivity, &state->diffused,
                                    err));
    }
    *out = state;
    state = NULL;
out:
    lac_readings_clear(&readings);
    if (state != NULL) {
        release(state);
    }
    return status;
}

static void add(const lac_load *load, double t, lac_load_state *sum)
{
    const reservoir_state *state = load->state;
    lac_add_pore(sum, state->diffused.n > 0 ? lac_diffused_at(&state->diffused, t)
                                            : lac_lagged_at(&state->lagged, t));
}

static double next_break(const lac_load *load, double t)
{
    const lac_lagged *lagged = &((const reservoir_state *)load->state)->lagged;
    return lac_readings_next(lagged->t, lagged->n, t);
}

static const char *fault(const void *p)
{
    const reservoir_params *s = p;
    if (isnan(s->distance) != isnan(s->diffusivity)) {
        return "distance and diffusivity belong together";
    }
    return !isnan(s->lag) && !isnan(s->distance)
               ? "the pressure either lags or diffuses: drop lag, or distance and diffusivity"
               : NULL;
}

static const char *const outsides[] = {"refuse", "hold", NULL};

static const lac_param params[] = {
    LAC_PATH("file", offsetof(reservoir_params, file), 0,
             "CSV with a header, or netCDF; let it begin long before the run, as water is slow"),
    LAC_TIME_COLUMN_ROW(reservoir_params),
    LAC_TEXT("level", offsetof(reservoir_params, level), 0,
             "column of the water level and its unit, such as \"level:m\""),
    LAC_REAL("elevation", "m", offsetof(reservoir_params, elevation), NAN, -1e6, 1e6, 0,
             "of the interface, on the scale of the levels; water below it does nothing"),
    LAC_REAL("share", "1", offsetof(reservoir_params, share), 1, 0, 1, 0,
             "part of the head that comes to bear on the interface as a whole"),
    LAC_REAL("unit_weight", "Pa/m", offsetof(reservoir_params, unit_weight), 1000.0 * LAC_GRAVITY,
             0, 1e6, LAC_ABOVE_MIN, "pressure under a metre of the water"),
    LAC_REAL("lag", "s", offsetof(reservoir_params, lag), NAN, 0, INFINITY,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "time in which the interface follows the level, by 63 % of a step"),
    LAC_REAL("distance", "m", offsetof(reservoir_params, distance), NAN, 0, 1e6,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "through rock, from the lake to the interface, that the pressure diffuses"),
    LAC_REAL("diffusivity", "m2/s", offsetof(reservoir_params, diffusivity), NAN, 0, 1e6,
             LAC_OPTIONAL | LAC_ABOVE_MIN, "hydraulic diffusivity of that rock"),
    LAC_REAL("offset", "s", offsetof(reservoir_params, offset), 0, -INFINITY, INFINITY, 0,
             "the levels come this much later than their times say"),
    LAC_CHOICE("outside", offsetof(reservoir_params, outside), REFUSE, outsides, 0,
               "before the first reading and after the last: refuse, or hold the level"),
};

const lac_load_kind lac_pore_reservoir = {
    .about = {.name = "reservoir",
              .summary = "water of a lake, at once, with a lag, or diffusing through the rock",
              .reference = "Carslaw & Jaeger (1959) Conduction of Heat in Solids, 2.4 (diffusion)",
              LAC_ROWS(params, reservoir_params),
              .fault = fault},
    .prepare = prepare,
    .release = release,
    .add = add,
    .next_break = next_break,
};
