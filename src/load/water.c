// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure from readings of water. Of a lake's level: at once, with a lag, or by diffusion
// through rock. Of rain: each raises it, and it drains away with time. Both are exact where the
// readings make a drive of straight pieces.
#include "load/kinds.h"

enum { REFUSE }; // the first of what `outside` may say
enum { END };    // of `stamp`

// What both have; it stands first.
typedef struct water_params {
    char *file, *time, *column;
    double offset; // [s]
    int outside;
} water_params;

typedef struct reservoir_params {
    water_params water;
    double elevation;             // of the interface [m]
    double share;                 // of the head that reaches it [1]
    double unit_weight;           // of the water [Pa/m]
    double lag;                   // [s]; NaN: none
    double distance, diffusivity; // [m], [m2/s]; NaN: none
} reservoir_params;

typedef struct rain_params {
    water_params water;
    double rise;     // pressure that rain makes [Pa/m]
    double drain;    // time in which it goes [s]
    double interval; // over which a reading fell [s]; NaN: from one reading to the other
    int stamp;
} rain_params;

// What follows a drive p(t) of straight pieces, the last of which goes on for ever.
typedef struct water {
    size_t n;
    double *t;     // [n] where each piece begins [s], rising
    double *drive; // [n] p there [Pa]
    double *slope; // [n] of p on the piece [Pa/s]
    double *u;     // [n] response there [Pa]
    double *seen;  // [n] what is read there, a level [m] or rain [m/s]
    double *trend; // [n] its rate on the piece
    double lag;    // T: T du/dt = p - u; 0: u = p [s]
    double time;   // or by diffusion: distance^2/(4 diffusivity) [s]; NaN: not
} water;

static void release(void *p) { free(((water *)p)->t); }

// Appends a piece that begins at t, later than the one before. @param seen  what is read
static void add_piece(water *w, double t, lac_signal drive, lac_signal seen)
{
    size_t k = w->n++;
    w->t[k] = t;
    w->drive[k] = drive.value;
    w->slope[k] = drive.rate;
    w->seen[k] = seen.value;
    w->trend[k] = seen.rate;
}

// Response tau after the beginning of piece k: u -> p with exp(-tau/T), behind a rising p by T.
static lac_signal response(const water *w, size_t k, double tau)
{
    if (w->lag == 0.0) {
        return (lac_signal){w->drive[k] + w->slope[k] * tau, w->slope[k]};
    }
    double x = tau / w->lag;
    double gone = -expm1(-x);
    double lack = w->drive[k] - w->u[k];
    double value = w->u[k] + lack * gone + w->slope[k] * w->lag * (x - gone);
    return (lac_signal){value, lack / w->lag * exp(-x) + w->slope[k] * gone};
}

// Response at every piece's beginning; before the first it is at rest at `first`.
static void settle(water *w, double first)
{
    w->u[0] = first;
    for (size_t k = 1; k < w->n; k++) {
        w->u[k] = response(w, k - 1, w->t[k] - w->t[k - 1]).value;
    }
}

// The pressure in rock at a distance from the face of a half-space that feels the drive, which is
// continuous: a sum of the answers to its bends. A unit step answers with erfc(x), x =
// distance/sqrt(4 D t) (Carslaw & Jaeger 1959, 2.4), hence a unit ramp with
// t [(1 + 2x^2) erfc(x) - 2 x exp(-x^2)/sqrt(pi)].
static lac_signal diffused(const water *w, double t)
{
    const double two_over_root_pi = 2.0 / sqrt(LAC_PI);
    lac_signal sum = {w->drive[0], 0.0};
    for (size_t k = 0; k < w->n && w->t[k] < t; k++) {
        double bend = w->slope[k] - (k > 0 ? w->slope[k - 1] : 0.0);
        double tau = t - w->t[k];
        double x2 = w->time / tau;
        if (x2 > 700.0) {
            continue; // exp(-x^2) is nothing, and x^2 may be infinite
        }
        double x = sqrt(x2);
        double step = erfc(x);
        double ramp = tau * ((1.0 + 2.0 * x2) * step - two_over_root_pi * x * exp(-x2));
        sum.value += bend * ramp;
        sum.rate += bend * step;
    }
    return sum;
}

static lac_signal water_at(const lac_load *load, double t)
{
    const water *w = load->state;
    if (!isnan(w->time)) {
        return diffused(w, t);
    }
    size_t k = lac_readings_before(w->t, w->n, t);
    return k == SIZE_MAX ? (lac_signal){w->u[0], 0.0} : response(w, k, t - w->t[k]);
}

static double level_at(const lac_load *load, double t)
{
    const water *w = load->state;
    size_t k = lac_readings_before(w->t, w->n, t);
    return k == SIZE_MAX ? w->seen[0] : w->seen[k] + w->trend[k] * (t - w->t[k]);
}

// Before the first reading nothing is known to have fallen.
static double rain_at(const lac_load *load, double t)
{
    const water *w = load->state;
    return t < w->t[0] ? 0.0 : level_at(load, t);
}

static double next_break(const lac_load *load, double t)
{
    const water *w = load->state;
    return lac_readings_next(w->t, w->n, t);
}

// Reads what drives and makes room for twice its pieces; @param remedy  what `outside` may say
static lac_status begin(const water_params *s, const lac_load_clock *clock, const char *remedy,
                        double lag, lac_readings *readings, water *w, lac_error *err)
{
    const lac_readings_def def = {
        .path = s->file, .time = s->time, .column = s->column, .si = "m", .offset = s->offset};
    LAC_TRY_RETURN(
        lac_readings_read(&def, clock, s->outside == REFUSE ? remedy : NULL, readings, err));
    const size_t room = 2 * readings->n + 1;
    w->t = malloc(6 * room * sizeof *w->t);
    LAC_FAIL_MEMORY_IF(w->t == NULL, err);
    w->drive = w->t + room;
    w->slope = w->drive + room;
    w->u = w->slope + room;
    w->seen = w->u + room;
    w->trend = w->seen + room;
    w->lag = lag;
    w->time = NAN;
    return LAC_OK;
}

// Pressure of the water that stands above the interface.
static double pressure_of(const reservoir_params *s, double level)
{
    return s->share * s->unit_weight * fmax(level - s->elevation, 0.0);
}

// Straight pieces between readings; where the level crosses the interface there is one more.
static void add_levels(const reservoir_params *s, const lac_readings *r, water *out)
{
    for (size_t i = 0; i + 1 < r->n; i++) {
        double from = r->value[i] - s->elevation;
        double to = r->value[i + 1] - s->elevation;
        double h = r->t[i + 1] - r->t[i];
        double rate = s->share * s->unit_weight * (to - from) / h;
        double crossing = r->t[i] + h * (from / (from - to));
        bool crosses = crossing > r->t[i] && crossing < r->t[i + 1];
        const lac_signal dry = {0.0, 0.0}, level = {r->value[i], (to - from) / h};
        const lac_signal at_crossing = {s->elevation, level.rate};
        if (from < 0.0 && to > 0.0 && crosses) {
            add_piece(out, r->t[i], dry, level);
            add_piece(out, crossing, (lac_signal){0.0, rate}, at_crossing);
        } else if (from > 0.0 && to < 0.0 && crosses) {
            add_piece(out, r->t[i], (lac_signal){pressure_of(s, r->value[i]), rate}, level);
            add_piece(out, crossing, dry, at_crossing);
        } else {
            bool wet = from >= 0.0 && to >= 0.0;
            const lac_signal drive = {pressure_of(s, r->value[i]), wet ? rate : 0.0};
            add_piece(out, r->t[i], drive, level);
        }
    }
    const double last = r->value[r->n - 1];
    add_piece(out, r->t[r->n - 1], (lac_signal){pressure_of(s, last), 0.0},
              (lac_signal){last, 0.0});
    settle(out, pressure_of(s, r->value[0]));
}

static lac_status fill_reservoir(const void *p, const lac_load_clock *clock, void *state,
                                 lac_error *err)
{
    const reservoir_params *s = p;
    lac_readings readings = {0};
    water *w = state;
    lac_status status = begin(&s->water, clock, ", or say outside: hold",
                              isnan(s->lag) ? 0.0 : s->lag, &readings, w, err);
    if (status == LAC_OK) {
        add_levels(s, &readings, w);
        w->time = 0.25 * s->distance / s->diffusivity * s->distance;
    }
    lac_readings_clear(&readings);
    return status;
}

// When the rain of reading i fell. False where that is not known: before the first, after the last.
static bool span_of(const rain_params *s, const lac_readings *r, size_t i, double *from, double *to)
{
    bool given = !isnan(s->interval);
    if (s->stamp == END) {
        *to = r->t[i];
        *from = given ? *to - s->interval : (i > 0 ? r->t[i - 1] : NAN);
    } else {
        *from = r->t[i];
        *to = given ? *from + s->interval : (i + 1 < r->n ? r->t[i + 1] : NAN);
    }
    return !isnan(*from) && !isnan(*to);
}

// du/dt = rise * intensity - u/drain: a drive of rise * intensity * drain, followed with the lag.
static lac_status add_rains(const rain_params *s, const lac_readings *r, water *out, lac_error *err)
{
    const char *file = s->water.file;
    const lac_signal dry = {0.0, 0.0};
    double dry_from = -INFINITY; // end of the rain so far
    for (size_t i = 0; i < r->n; i++) {
        double from, to;
        LAC_FAIL_IF(!(r->value[i] >= 0.0), err, LAC_EINPUT, "%s: rain of %g m; must be >= 0", file,
                    r->value[i]);
        if (!span_of(s, r, i, &from, &to)) {
            continue;
        }
        double slack = 1e-6 * (to - from);
        LAC_FAIL_IF(from < dry_from - slack, err, LAC_EINPUT,
                    "%s: readings %g s apart; interval must not be longer, or be absent", file,
                    r->t[i] - r->t[i - 1]);
        if (from > dry_from + slack && out->n > 0) {
            add_piece(out, dry_from, dry, dry);
        }
        from = from > dry_from + slack ? from : dry_from;
        add_piece(out, from, (lac_signal){s->rise * r->value[i] / (to - from) * s->drain, 0.0},
                  (lac_signal){r->value[i] / (to - from), 0.0});
        dry_from = to;
    }
    LAC_FAIL_IF(out->n == 0, err, LAC_EINPUT, "%s: one reading without interval tells no rain",
                file);
    add_piece(out, dry_from, dry, dry);
    settle(out, 0.0);
    return LAC_OK;
}

static lac_status fill_rain(const void *p, const lac_load_clock *clock, void *state, lac_error *err)
{
    const rain_params *s = p;
    lac_readings readings = {0};
    lac_status status =
        begin(&s->water, clock, ", or say outside: dry", s->drain, &readings, state, err);
    if (status == LAC_OK) {
        status = add_rains(s, &readings, state, err);
    }
    lac_readings_clear(&readings);
    return status;
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

static const char *const holds[] = {"refuse", "hold", NULL};
static const char *const stamps[] = {"end", "start", NULL};
static const char *const dries[] = {"refuse", "dry", NULL};

#define WATER(name) offsetof(water_params, name)
#define LAKE(name) offsetof(reservoir_params, name)
#define RAIN(name) offsetof(rain_params, name)

static const lac_param reservoir_rows[] = {
    LAC_PATH("file", WATER(file), 0,
             "CSV with a header, or netCDF; let it begin long before the run, as water is slow"),
    LAC_TIME_COLUMN_ROW(water_params),
    LAC_TEXT("level", WATER(column), 0,
             "column of the water level and its unit, such as \"level:m\""),
    LAC_REAL("elevation", "m", LAKE(elevation), NAN, -1e6, 1e6, 0,
             "of the interface, on the scale of the levels; water below it does nothing"),
    LAC_REAL("share", "1", LAKE(share), 1, 0, 1, 0,
             "part of the head that comes to bear on the interface as a whole"),
    LAC_REAL("unit_weight", "Pa/m", LAKE(unit_weight), 1000.0 * LAC_GRAVITY, 0, 1e6, LAC_ABOVE_MIN,
             "pressure under a metre of the water"),
    LAC_REAL("lag", "s", LAKE(lag), NAN, 0, INFINITY, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "time in which the interface follows the level, by 63 % of a step"),
    LAC_REAL("distance", "m", LAKE(distance), NAN, 0, 1e6, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "through rock, from the lake to the interface, that the pressure diffuses"),
    LAC_REAL("diffusivity", "m2/s", LAKE(diffusivity), NAN, 0, 1e6, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "hydraulic diffusivity of that rock"),
    LAC_OFFSET_ROW(water_params, "the levels come this much later than their times say"),
    LAC_CHOICE("outside", WATER(outside), REFUSE, holds, 0,
               "before the first reading and after the last: refuse, or hold the level"),
};

static const lac_load_driver lake_level = {
    "lake_level", "m", "level of the lake whose water the load is",
    "as read: along lines between readings, on the scale of load.pore_pressure.reservoir.elevation",
    level_at};

static const lac_load_driver rain_fall = {"rain", "m s-1", "rain that the load is made from",
                                          "as read: what fell over the time in which it fell",
                                          rain_at};

const lac_load_kind lac_pore_reservoir = {
    .info = LAC_ABOUT("reservoir",
                      "water of a lake, at once, with a lag, or diffusing through the rock",
                      "Carslaw & Jaeger (1959) Conduction of Heat in Solids, 2.4 (diffusion)",
                      LAC_ROWS(reservoir_rows, reservoir_params), .validate = fault),
    .state_size = sizeof(water),
    .prepare = fill_reservoir,
    .release = release,
    .driver = &lake_level,
    .signal = water_at,
    .next_break = next_break,
};

static const lac_param rain_rows[] = {
    LAC_PATH("file", WATER(file), 0,
             "CSV with a header, or netCDF; let it begin some drain times before the run"),
    LAC_TIME_COLUMN_ROW(water_params),
    LAC_TEXT("rain", WATER(column), 0,
             "column of the rain that fell, and its unit, such as \"rain:mm\""),
    LAC_REAL("rise", "Pa/m", RAIN(rise), NAN, 0, 1e12, 0,
             "pore pressure that a metre of rain makes: 9807 Pa/m over the drainable porosity, "
             "times the part that infiltrates"),
    LAC_REAL("drain", "s", RAIN(drain), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "time in which it drains, to 37 %"),
    LAC_REAL("interval", "s", RAIN(interval), NAN, 0, INFINITY, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "time over which each reading fell, evenly, dry where none covers it; from one "
             "reading to the other if absent"),
    LAC_CHOICE("stamp", RAIN(stamp), END, stamps, 0,
               "whether a reading's time is the end or the start of its interval"),
    LAC_OFFSET_ROW(water_params, "the rain comes this much later than its times say"),
    LAC_CHOICE("outside", WATER(outside), REFUSE, dries, 0,
               "before the first reading and after the last: refuse, or dry"),
};

const lac_load_kind lac_pore_rain = {
    .info = LAC_ABOUT("rain", "water that rain brings and that drains in its own time",
                      "docs/theory/loads.md, \"Pore pressure\"", LAC_ROWS(rain_rows, rain_params)),
    .state_size = sizeof(water),
    .prepare = fill_rain,
    .release = release,
    .driver = &rain_fall,
    .signal = water_at,
    .next_break = next_break,
};
