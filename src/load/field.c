// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure, or normal stress, that a file gives over the joint: maps at several times, or one
// map whose factor changes in time. Between maps and readings straight lines, between the places of
// a map bilinear.
#include "series/field.h"
#include "base/units.h"
#include "load/kinds.h"

enum { REFUSE, HOLD };

typedef struct field_params {
    char *file, *variable;
    char *series, *time, *factor; // of a map without times; NULL: constant
    double scale;                 // [1]
    double offset;                // [s]
    int outside;
} field_params;

// A cell among the values of a map: between those at `corner` and the next ones.
typedef struct corner {
    size_t at;
    double right, up; // 0 to 1
} corner;

typedef struct field_state {
    lac_field field;
    lac_readings factor;  // value unused where the field has times; n = 0: constant
    corner *corner;       // [n]
    size_t across, along; // from a value to that above it, and to the right; 0: there is none
} field_state;

static void release(void *p)
{
    field_state *state = p;
    lac_field_clear(&state->field);
    lac_readings_clear(&state->factor);
    free(state->corner);
}

// The times of the maps on the clock of the run.
static lac_status take_times(const field_params *p, const lac_load_clock *clock, field_state *state,
                             const char *remedy, lac_error *err)
{
    lac_field *field = &state->field;
    LAC_FAIL_IF(p->series != NULL, err, LAC_EINPUT,
                "%s: %s has times of its own, so that series must be absent", p->file, p->variable);
    LAC_FAIL_IF(field->dated && !clock->dated, err, LAC_EINPUT,
                "%s: has dates, so time.start must be a date", p->file);
    const double shift = (field->dated ? clock->start : 0.0) - p->offset;
    for (size_t i = 0; i < field->nt; i++) {
        field->t[i] -= shift;
    }
    state->factor = (lac_readings){.n = field->nt, .t = field->t};
    field->t = NULL;
    return remedy != NULL ? lac_readings_cover(&state->factor, p->file, clock, remedy, err)
                          : LAC_OK;
}

static lac_status prepare(const void *params, const lac_load_clock *clock, void *at, lac_error *err)
{
    const field_params *p = params;
    field_state *state = at;
    const char *remedy = p->outside == REFUSE ? ", or say outside: hold" : NULL;
    lac_units *units = NULL;
    LAC_TRY_RETURN(lac_units_create(&units, err));
    lac_status status = lac_field_read(p->file, p->variable, "Pa", units, &state->field, err);
    lac_units_free(units);
    if (status == LAC_OK && state->field.nt > 0) {
        status = take_times(p, clock, state, remedy, err);
    } else if (status == LAC_OK && p->series != NULL) {
        const lac_readings_def def = {.path = p->series,
                                      .time = p->time,
                                      .column = p->factor,
                                      .si = "1",
                                      .offset = p->offset};
        status = lac_readings_read(&def, clock, remedy, &state->factor, err);
    }
    return status;
}

// Where a place lies among n coordinates: behind the k-th, by the part `by` of the way to the next.
// False where it lies beyond them; it is then held at the nearest. One coordinate stands for all.
static bool locate(const double *x, size_t n, double at, size_t *k, double *by)
{
    const double slack = n > 1 ? 1e-6 * (x[n - 1] - x[0]) : INFINITY; // coordinates may be floats
    *k = 0;
    *by = 0.0;
    if (n == 1 || at < x[0]) {
        return n == 1 || at >= x[0] - slack;
    }
    if (at >= x[n - 1]) {
        *k = n - 2;
        *by = 1.0;
        return at <= x[n - 1] + slack;
    }
    *k = lac_readings_before(x, n, at);
    *by = (at - x[*k]) / (x[*k + 1] - x[*k]);
    return true;
}

// The value of a map at a cell.
static double value_at(const field_state *state, const double *map, const corner *c)
{
    const double *low = map + c->at;
    const double *high = low + state->across;
    double below = low[0] + c->right * (low[state->along] - low[0]);
    double above = high[0] + c->right * (high[state->along] - high[0]);
    return below + c->up * (above - below);
}

// Every map must have a value at every cell.
static lac_status check_values(const field_params *p, const lac_load_places *places,
                               const field_state *state, lac_error *err)
{
    const lac_field *field = &state->field;
    for (size_t k = 0; k < (field->nt > 0 ? field->nt : 1); k++) {
        const double *map = field->value + k * field->nx * field->ny;
        for (size_t i = 0; i < places->n; i++) {
            LAC_FAIL_IF(!isfinite(value_at(state, map, &state->corner[i])), err, LAC_EINPUT,
                        "%s: %s has no value around x = %g m, y = %g m, where the faces touch",
                        p->file, p->variable, lac_grid_x(places->grid, places->index[i]),
                        lac_grid_y(places->grid, places->index[i]));
        }
    }
    return LAC_OK;
}

static lac_status place(const void *params, const lac_load_places *places, void *at, lac_error *err)
{
    const field_params *p = params;
    field_state *state = at;
    const lac_field *field = &state->field;
    free(state->corner);
    state->corner = malloc(places->n * sizeof *state->corner);
    LAC_FAIL_MEMORY_IF(state->corner == NULL, err);
    state->along = field->nx > 1 ? 1 : 0;
    state->across = field->ny > 1 ? field->nx : 0;
    for (size_t i = 0; i < places->n; i++) {
        double x = lac_grid_x(places->grid, places->index[i]);
        double y = lac_grid_y(places->grid, places->index[i]);
        corner *c = &state->corner[i];
        size_t column;
        size_t row;
        bool inside = locate(field->x, field->nx, x, &column, &c->right);
        inside = locate(field->y, field->ny, y, &row, &c->up) && inside;
        LAC_FAIL_IF(!inside && p->outside == REFUSE, err, LAC_EINPUT,
                    "%s: covers x = %g to %g m, y = %g to %g m, and not a cell at x = %g m, y = %g "
                    "m; must cover the joint, or say outside: hold",
                    p->file, field->x[0], field->x[field->nx - 1], field->y[0],
                    field->y[field->ny - 1], x, y);
        c->at = row * field->nx + column;
    }
    return check_values(p, places, state, err);
}

// Adds scale times a map, and rate times it to its rate.
static void add_map(const field_state *state, const double *map, size_t n, lac_signal by,
                    double *value, double *rate)
{
    for (size_t i = 0; i < n; i++) {
        double here = value_at(state, map, &state->corner[i]);
        value[i] += by.value * here;
        rate[i] += by.rate * here;
    }
}

static void add_field(const lac_load *load, const lac_load_places *places, double t, double *value,
                      double *rate)
{
    const field_params *p = load->params;
    const field_state *state = load->state;
    const lac_readings *r = &state->factor;
    const double *map = state->field.value;
    const size_t size = state->field.nx * state->field.ny;
    if (state->field.nt == 0) {
        const lac_signal factor = r->n == 0 ? (lac_signal){1.0, 0.0} : lac_readings_at(r, t);
        add_map(state, map, places->n,
                (lac_signal){p->scale * factor.value, p->scale * factor.rate}, value, rate);
        return;
    }
    if (t < r->t[0] || t >= r->t[r->n - 1]) {
        map += t < r->t[0] ? 0 : (r->n - 1) * size;
        add_map(state, map, places->n, (lac_signal){p->scale, 0.0}, value, rate);
        return;
    }
    size_t k = lac_readings_before(r->t, r->n, t);
    double h = r->t[k + 1] - r->t[k];
    double by = (t - r->t[k]) / h;
    map += k * size;
    for (size_t i = 0; i < places->n; i++) {
        double from = value_at(state, map, &state->corner[i]);
        double rise = value_at(state, map + size, &state->corner[i]) - from;
        value[i] += p->scale * (from + by * rise);
        rate[i] += p->scale * (rise / h);
    }
}

static double next_break(const lac_load *load, double t)
{
    const lac_readings *r = &((const field_state *)load->state)->factor;
    return lac_readings_next(r->t, r->n, t);
}

static const char *fault(const void *params)
{
    const field_params *p = params;
    bool any = p->series != NULL || p->time != NULL || p->factor != NULL;
    bool all = p->series != NULL && p->time != NULL && p->factor != NULL;
    return any != all ? "series, time and factor belong together" : NULL;
}

static const char *const outsides[] = {"refuse", "hold", NULL};

static const lac_param params[] = {
    LAC_PATH("file", offsetof(field_params, file), 0,
             "netCDF: a variable over (y, x) or (time, y, x), with coordinates and units"),
    LAC_TEXT("variable", offsetof(field_params, variable), 0,
             "its name; x along slip and y across, from the corner of the joint"),
    LAC_PATH("series", offsetof(field_params, series), LAC_OPTIONAL,
             "CSV with a header, or netCDF: what multiplies a map without times; constant if "
             "absent"),
    LAC_TEXT("time", offsetof(field_params, time), LAC_OPTIONAL,
             "name of its time column: dates, or seconds since the start of the run"),
    LAC_TEXT("factor", offsetof(field_params, factor), LAC_OPTIONAL,
             "column of the factor, a number, such as \"factor:1\""),
    LAC_REAL("scale", "1", offsetof(field_params, scale), 1, -1e12, 1e12, 0, "factor on it all"),
    LAC_OFFSET_ROW(field_params, "it all comes this much later than the times say"),
    LAC_CHOICE("outside", offsetof(field_params, outside), REFUSE, outsides, 0,
               "beyond the first and last place and time: refuse, or hold what is there"),
};

#define FIELD(row, text, source)                                                                 \
    const lac_load_kind row = {                                                                  \
        .info =                                                                                  \
            LAC_ABOUT("field", text, source, LAC_ROWS(params, field_params), .validate = fault), \
        .linear = true,                                                                          \
        .state_size = sizeof(field_state),                                                       \
        .prepare = prepare,                                                                      \
        .release = release,                                                                      \
        .cells = add_field,                                                                      \
        .place = place,                                                                          \
        .next_break = next_break,                                                                \
    }

FIELD(lac_pore_field, "pore pressure that differs over the joint, read from a file",
      "docs/theory/loads.md, \"Loads over the joint\"");
FIELD(lac_pressing_field, "normal stress that differs over the joint, read from a file",
      LAC_PRESSING_SOURCE);
