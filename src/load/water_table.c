// SPDX-License-Identifier: GPL-3.0-or-later
// Water that stands to a level over an inclined joint: each cell feels what is above it, and cells
// above the level feel none. So it is with a water table, and with the toe of a slope in a lake; or
// a lake that carries a part of the weight itself.
#include "load/kinds.h"

enum { REFUSE, HOLD };

typedef struct table_params {
    double level; // constant [m]; NaN: of the file
    char *file, *time, *column;
    double offset; // [s]
    int outside;
    double elevation;   // of the joint at x = 0 [m]
    double angle;       // dip along x [rad]
    double unit_weight; // of the water [Pa/m]
    double fringe;      // w [m]; 0: a sharp edge
} table_params;

typedef struct table_state {
    lac_readings level; // n = 0: constant
    size_t n;
    double *column; // [n] elevation of each column of the grid, falling [m]
} table_state;

static void release(void *p)
{
    table_state *state = p;
    lac_readings_clear(&state->level);
    free(state->column);
}

static lac_status prepare(const void *params, const lac_load_clock *clock, void *state,
                          lac_error *err)
{
    const table_params *p = params;
    const lac_readings_def def = {
        .path = p->file, .time = p->time, .column = p->column, .si = "m", .offset = p->offset};
    const char *remedy = p->outside == REFUSE ? ", or say outside: hold" : NULL;
    return p->file == NULL
               ? LAC_OK
               : lac_readings_read(&def, clock, remedy, &((table_state *)state)->level, err);
}

// Elevations of the columns: slip is along x, downwards.
static lac_status place(const void *params, const lac_load_places *places, void *at, lac_error *err)
{
    const table_params *p = params;
    table_state *state = at;
    const size_t n = places->grid->nx;
    free(state->column);
    state->column = malloc(n * sizeof *state->column);
    LAC_FAIL_MEMORY_IF(state->column == NULL, err);
    state->n = n;
    for (size_t i = 0; i < n; i++) {
        state->column[i] = p->elevation - lac_grid_x(places->grid, i) * sin(p->angle);
    }
    return LAC_OK;
}

static lac_signal level_at(const table_params *p, const table_state *state, double t)
{
    const lac_readings *r = &state->level;
    if (r->n == 0) {
        return (lac_signal){p->level, 0.0};
    }
    if (t < r->t[0] || t >= r->t[r->n - 1]) {
        return (lac_signal){r->value[t < r->t[0] ? 0 : r->n - 1], 0.0};
    }
    size_t i = lac_readings_before(r->t, r->n, t);
    double slope = (r->value[i + 1] - r->value[i]) / (r->t[i + 1] - r->t[i]);
    return (lac_signal){r->value[i] + (t - r->t[i]) * slope, slope};
}

static double told_level(const lac_load *load, double t)
{
    return level_at(load->params, load->state, t).value;
}

// Head over a cell whose share below the level is rounded over the fringe w, and what of the
// level's rate it feels: w ln(1 + exp(head/w)), which is max(head, 0) at w = 0.
static lac_signal wetted(double head, double w)
{
    const double x = head / w;
    if (fabs(x) > 40.0) { // exp(-40) is lost beside 1
        return x > 0.0 ? (lac_signal){head, 1.0} : (lac_signal){0.0, 0.0};
    }
    const double e = exp(-fabs(x));
    return (lac_signal){w * (fmax(x, 0.0) + log1p(e)), (x > 0.0 ? 1.0 : e) / (1.0 + e)};
}

static void add_fringe(const table_params *p, const table_state *state,
                       const lac_load_places *places, lac_signal level, double *value, double *rate)
{
    for (size_t i = 0; i < places->n; i++) {
        double z = state->column[places->index[i] % state->n];
        const lac_signal wet = wetted(level.value - z, p->fringe);
        value[i] += p->unit_weight * wet.value;
        rate[i] += p->unit_weight * level.rate * wet.rate;
    }
}

static void add_table(const lac_load *load, const lac_load_places *places, double t, double *value,
                      double *rate)
{
    const table_params *p = load->params;
    const table_state *state = load->state;
    const lac_signal level = level_at(p, state, t);
    if (p->fringe > 0.0) {
        add_fringe(p, state, places, level, value, rate);
        return;
    }
    for (size_t i = 0; i < places->n; i++) {
        double z = state->column[places->index[i] % state->n];
        double head = level.value - z;
        // At the moment of passing, what follows holds, whichever way the moment was rounded.
        double slack = 1e-13 * (fabs(level.value) + fabs(z) + fabs(level.rate * t));
        bool passing = level.rate != 0.0 && fabs(head) <= slack;
        bool wet = passing ? level.rate > 0.0 : head > 0.0;
        value[i] += wet ? p->unit_weight * head : 0.0;
        rate[i] += wet ? p->unit_weight * level.rate : 0.0;
    }
}

// When the level passes a column after t, on the straight line between readings i and i + 1.
static double passes(const table_state *state, size_t i, double t)
{
    const lac_readings *r = &state->level;
    double from = r->value[i];
    double h = r->t[i + 1] - r->t[i];
    double rise = r->value[i + 1] - from;
    double first = INFINITY;
    for (size_t k = 0; k < state->n && rise != 0.0; k++) {
        double at = r->t[i] + h * ((state->column[k] - from) / rise);
        first = at > t && at < r->t[i + 1] ? fmin(first, at) : first;
    }
    return first;
}

static double next_break(const lac_load *load, double t)
{
    const table_params *p = load->params;
    const table_state *state = load->state;
    const lac_readings *r = &state->level;
    double next = lac_readings_next(r->t, r->n, t);
    if (p->fringe > 0.0 || r->n == 0 || t < r->t[0] || t >= r->t[r->n - 1]) {
        return next;
    }
    return fmin(next, passes(state, lac_readings_before(r->t, r->n, t), t));
}

static const char *fault(const void *params)
{
    const table_params *p = params;
    bool any = p->file != NULL || p->time != NULL || p->column != NULL;
    bool all = p->file != NULL && p->time != NULL && p->column != NULL;
    if (any != all) {
        return "file, time and column belong together";
    }
    return any == !isnan(p->level) ? "needs level, or file, time and column, and not both" : NULL;
}

// In a fringe pressure does not follow a straight line as the level does.
static bool has_fringe(const void *params) { return ((const table_params *)params)->fringe > 0.0; }

static const char *const outsides[] = {"refuse", "hold", NULL};

#define TABLE(name) offsetof(table_params, name)

#define LEVEL_ROWS                                                                         \
    LAC_REAL("level", "m", TABLE(level), NAN, -1e6, 1e6, LAC_OPTIONAL,                     \
             "of the water, where it stays; else a file has it"),                          \
        LAC_PATH("file", TABLE(file), LAC_OPTIONAL,                                        \
                 "CSV with a header, or netCDF: the level in time"),                       \
        LAC_TEXT("time", TABLE(time), LAC_OPTIONAL,                                        \
                 "name of the time column: dates, or seconds since the start of the run"), \
        LAC_TEXT("column", TABLE(column), LAC_OPTIONAL,                                    \
                 "column of the level and its unit, such as \"level:m\"")

#define WATER_ROWS                                                                    \
    LAC_REAL("unit_weight", "Pa/m", TABLE(unit_weight), 1000.0 * LAC_GRAVITY, 0, 1e6, \
             LAC_ABOVE_MIN, "pressure under a metre of the water")
#define TIME_ROWS                                                                         \
    LAC_OFFSET_ROW(table_params, "the levels come this much later than their times say"), \
        LAC_CHOICE("outside", TABLE(outside), REFUSE, outsides, 0,                        \
                   "before the first reading and after the last: refuse, or hold the level")

static const lac_param params[] = {
    LEVEL_ROWS,
    LAC_REAL("elevation", "m", TABLE(elevation), NAN, -1e6, 1e6, 0,
             "of the joint where x = 0, its upper end, on the scale of the levels"),
    LAC_REAL("angle", "rad", TABLE(angle), NAN, -LAC_STEEPEST, LAC_STEEPEST, 0,
             "by which the joint falls along x; negative where it rises"),
    WATER_ROWS,
    LAC_REAL(
        "fringe", "m", TABLE(fringe), 0, 0, 1e3, 0,
        "over which the edge of the water is rounded, as capillary rise does; 0: sharp, so that "
        "the integrator begins anew at each column of cells that the level passes"),
    TIME_ROWS,
};

static const lac_load_driver water_level = {
    "water_level", "m", "level of the water over the joint",
    "on the scale of load.pore_pressure.water_table.elevation", told_level};

const lac_load_kind lac_pore_water_table = {
    .info = LAC_ABOUT("water_table",
                      "water that stands to a level over an inclined joint, whose lower part alone "
                      "feels it: a water table, a toe in a lake",
                      "docs/theory/loads.md, \"Loads over the joint\"",
                      LAC_ROWS(params, table_params), .validate = fault),
    .linear = true,
    .bends = has_fringe,
    .driver = &water_level,
    .state_size = sizeof(table_state),
    .prepare = prepare,
    .release = release,
    .cells = add_table,
    .place = place,
    .next_break = next_break,
};

static void add_toe(const lac_load *load, double t, lac_load_state *sum)
{
    const table_params *p = load->params;
    sum->lake =
        (lac_lake){level_at(p, load->state, t).value, p->elevation, p->unit_weight, p->angle};
}

static double next_reading(const lac_load *load, double t)
{
    const lac_readings *r = &((const table_state *)load->state)->level;
    return lac_readings_next(r->t, r->n, t);
}

static const lac_param toe_rows[] = {
    LEVEL_ROWS,
    LAC_REAL("elevation", "m", TABLE(elevation), NAN, -1e6, 1e6, 0,
             "of the base's lower end at the start, on the scale of the levels"),
    LAC_REAL("angle", "rad", TABLE(angle), NAN, -LAC_STEEPEST, LAC_STEEPEST, LAC_OPTIONAL,
             "dip of the base under what stands in the lake; that of interface.geometry if absent"),
    WATER_ROWS,
    TIME_ROWS,
};

static const lac_load_driver lake_level = {"lake_level", "m", "level of the lake at the toe",
                                           "on the scale of load.pore_pressure.toe.elevation",
                                           told_level};

const lac_load_kind lac_pore_toe = {
    .info = LAC_ABOUT("toe",
                      "a lake at the toe of the mass on interface.geometry: buoyancy takes off its "
                      "weight, of what presses and of what pulls",
                      "Lambe & Whitman (1969) Soil Mechanics, Wiley, ch. 24 (submerged slope)",
                      LAC_ROWS(toe_rows, table_params), .validate = fault),
    .on_base = true,
    .driver = &lake_level,
    .state_size = sizeof(table_state),
    .prepare = prepare,
    .release = release,
    .add = add_toe,
    .next_break = next_reading,
};
