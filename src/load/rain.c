// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure from readings of rain: each rain raises it, and it drains away with time.
#include <stdlib.h>

#include "load/kinds.h"
#include "load/lagged.h"
#include "load/table.h"

enum { END, START };
enum { REFUSE, DRY };

typedef struct rain_params {
    char *file, *time, *rain;
    double rise;     // pressure that rain makes [Pa/m]
    double drain;    // time in which it goes [s]
    double interval; // over which a reading fell [s]; NaN: from one reading to the other
    double offset;   // [s]
    int stamp, outside;
} rain_params;

static void release(void *p)
{
    lac_lagged_clear(p);
    free(p);
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
static lac_status add_pieces(const rain_params *s, const lac_readings *r, lac_lagged *out,
                             lac_error *err)
{
    double dry_from = -INFINITY; // end of the rain so far
    for (size_t i = 0; i < r->n; i++) {
        double from;
        double to;
        if (!(r->value[i] >= 0.0)) {
            return lac_fail(err, LAC_EINPUT, "%s: rain of %g m; must be >= 0", s->file,
                            r->value[i]);
        }
        if (!span_of(s, r, i, &from, &to)) {
            continue;
        }
        double slack = 1e-6 * (to - from);
        if (from < dry_from - slack) {
            return lac_fail(err, LAC_EINPUT,
                            "%s: readings %g s apart; interval must not be longer, or be absent",
                            s->file, r->t[i] - r->t[i - 1]);
        }
        if (from > dry_from + slack && out->n > 0) {
            lac_lagged_add(out, dry_from, 0.0, 0.0);
        }
        from = from > dry_from + slack ? from : dry_from;
        lac_lagged_add(out, from, s->rise * r->value[i] / (to - from) * s->drain, 0.0);
        dry_from = to;
    }
    if (out->n == 0) {
        return lac_fail(err, LAC_EINPUT, "%s: one reading without interval tells no rain", s->file);
    }
    lac_lagged_add(out, dry_from, 0.0, 0.0);
    lac_lagged_settle(out, 0.0);
    return LAC_OK;
}

static lac_status prepare(const void *p, const lac_load_clock *clock, void **out, lac_error *err)
{
    const rain_params *s = p;
    const lac_readings_def def = {
        .path = s->file, .time = s->time, .column = s->rain, .si = "m", .offset = s->offset};
    lac_readings readings = {0};
    lac_status status = LAC_OK;
    lac_lagged *lagged = calloc(1, sizeof *lagged);
    if (lagged == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(lac_readings_read(&def, clock, &readings, err));
    if (s->outside == REFUSE) {
        LAC_TRY(lac_readings_cover(&readings, s->file, clock, ", or say outside: dry", err));
    }
    LAC_TRY(lac_lagged_create(2 * readings.n + 1, s->drain, lagged, err));
    LAC_TRY(add_pieces(s, &readings, lagged, err));
    *out = lagged;
    lagged = NULL;
out:
    lac_readings_clear(&readings);
    if (lagged != NULL) {
        release(lagged);
    }
    return status;
}

static void add(const lac_load *load, double t, lac_load_state *sum)
{
    lac_add_pore(sum, lac_lagged_at(load->state, t));
}

static double next_break(const lac_load *load, double t)
{
    const lac_lagged *lagged = load->state;
    return lac_readings_next(lagged->t, lagged->n, t);
}

static const char *const stamps[] = {"end", "start", NULL};
static const char *const outsides[] = {"refuse", "dry", NULL};

static const lac_param params[] = {
    LAC_PATH("file", offsetof(rain_params, file), 0,
             "CSV with a header, or netCDF; let it begin some drain times before the run"),
    LAC_TIME_COLUMN_ROW(rain_params),
    LAC_TEXT("rain", offsetof(rain_params, rain), 0,
             "column of the rain that fell, and its unit, such as \"rain:mm\""),
    LAC_REAL("rise", "Pa/m", offsetof(rain_params, rise), NAN, 0, 1e12, 0,
             "pore pressure that a metre of rain makes: 9807 Pa/m over the drainable porosity, "
             "times the part that infiltrates"),
    LAC_REAL("drain", "s", offsetof(rain_params, drain), NAN, 0, INFINITY, LAC_ABOVE_MIN,
             "time in which it drains, to 37 %"),
    LAC_REAL("interval", "s", offsetof(rain_params, interval), NAN, 0, INFINITY,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "time over which each reading fell, evenly, dry where none covers it; from one "
             "reading to the other if absent"),
    LAC_CHOICE("stamp", offsetof(rain_params, stamp), END, stamps, 0,
               "whether a reading's time is the end or the start of its interval"),
    LAC_REAL("offset", "s", offsetof(rain_params, offset), 0, -INFINITY, INFINITY, 0,
             "the rain comes this much later than its times say"),
    LAC_CHOICE("outside", offsetof(rain_params, outside), REFUSE, outsides, 0,
               "before the first reading and after the last: refuse, or dry"),
};

const lac_load_kind lac_pore_rain = {
    .about = {.name = "rain",
              .summary = "water that rain brings and that drains in its own time",
              .reference = "docs/theory/loads.md, \"Pore pressure\"",
              LAC_ROWS(params, rain_params),
              .fault = NULL},
    .prepare = prepare,
    .release = release,
    .add = add,
    .next_break = next_break,
};
