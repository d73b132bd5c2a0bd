// SPDX-License-Identifier: GPL-3.0-or-later
// What forecasts and indicators came to, as tables: the variables of their file.
#include <math.h>
#include <stdio.h>

#include "base/date.h"
#include "data/describe.h"
#include "precursor/precursor.h"

enum { NAME = 80, LONG_NAME = 160, MOST_VALUES = 64 };

// Forecast of an issue time by a method.
static const lac_forecast *forecast(const lac_forecast_outcome *o, size_t issue, size_t method)
{
    return o->rolling != NULL ? &o->rolling->forecast[issue * o->rolling->methods + method]
                              : &o->outlook->forecast[method];
}

#define MOTION const lac_motion *m = ((const lac_forecast_outcome *)of)->outlook->motion
#define OUTCOME const lac_forecast_outcome *o = of
#define ISSUE const lac_forecast *f = forecast(of, at[0], 0)
#define FORECAST const lac_forecast *f = forecast(of, at[0], at[1])

LAC_GETTER(double, reading_time, MOTION, m->time[at[0]])
LAC_GETTER(double, displacement, MOTION, m->displacement[at[0]])
LAC_GETTER(double, velocity_time, MOTION, m->velocity_time[at[0]])
LAC_GETTER(double, velocity, MOTION, m->velocity[at[0]])
LAC_GETTER(double, issue_time, ISSUE, f->issue_time)
LAC_GETTER(double, window_start, ISSUE, f->window_start)
LAC_GETTER(double, failure_time, FORECAST, f->time)
LAC_GETTER(double, low50, FORECAST, f->low50)
LAC_GETTER(double, high50, FORECAST, f->high50)
LAC_GETTER(double, low90, FORECAST, f->low90)
LAC_GETTER(double, high90, FORECAST, f->high90)
LAC_GETTER(double, rms, FORECAST, f->fit.rms)
LAC_GETTER(double, misfit, FORECAST, f->fit.misfit)
LAC_GETTER(double, relative_error, FORECAST, f->fit.error)
LAC_GETTER(double, issued, FORECAST, f->issued ? 1.0 : 0.0)
LAC_TEXT_GETTER(reason, FORECAST, f->fit.reason)
LAC_TEXT_GETTER(method, OUTCOME, forecast(o, 0, at[0])->kind->about.name)

LAC_GETTER(double, failed_at, OUTCOME, o->failed_at)
LAC_GETTER(double, noise, MOTION, m->noise)
LAC_GETTER(double, outliers, MOTION, (double)m->outliers)
LAC_GETTER(double, resets, MOTION, (double)m->resets)
LAC_GETTER(double, disbelieved, MOTION, (double)m->disbelieved)
LAC_GETTER(double, falling, MOTION, m->falling ? 1.0 : 0.0)
LAC_GETTER(double, gaps, MOTION, (double)m->gaps)
LAC_TEXT_GETTER(source, OUTCOME, o->source)
LAC_TEXT_GETTER(attribution, OUTCOME, o->attribution)
LAC_TEXT_GETTER(status, OUTCOME, o->interrupted ? "interrupted" : "complete")
LAC_TEXT_GETTER(failed_on, OUTCOME,
                o->dated &&isfinite(o->failed_at)
                    ? lac_date_format(o->failed_at, room, LAC_TEXT_ROOM)
                    : NULL)

#define G(getter) .value = (getter)
#define T(getter) .text = (getter)
#define TIME(name, dims, getter, long_name, ...) \
    LAC_ROW(name, dims, NULL, long_name, G(getter), __VA_ARGS__)
// Of each issue time and method.
#define EACH(name, long_name, ...) \
    LAC_ROW(name, "issue method", NULL, long_name, .coordinates = "issue_time method", __VA_ARGS__)

static const lac_variable rows[] = {
    LAC_ROW("method", "method", NULL, "method of forecasting", T(method), .flags = LAC_MEANINGS),
    TIME("reading_time", "reading", reading_time, "time of the reading", .flags = LAC_TIME),
    LAC_ROW("displacement", "reading", "m", "displacement", G(displacement),
            .comment = "without outliers, resets of the sensor taken out; its negative where it "
                       "falls (attribute falling); the integral of the velocity where only that "
                       "was given"),
    TIME("velocity_time", "velocity_reading", velocity_time, "time of the velocity",
         .flags = LAC_TIME | LAC_EMPTY),
    LAC_ROW("velocity", "velocity_reading", "m s-1", "velocity", G(velocity),
            .comment = "looks back only", .flags = LAC_EMPTY),
    TIME("issue_time", "issue", issue_time, "time at which the forecasts are issued",
         .comment = "nothing later was known to them", .flags = LAC_TIME),
    TIME("window_start", "issue", window_start, "start of what was fitted",
         .comment = "missing where nothing was", .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time", "forecast time of failure", G(failure_time),
         .comment = "also where it is not issued, as far as the fit went",
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_low50", "lower end of the 50 % interval", G(low50),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_high50", "upper end of the 50 % interval", G(high50),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_low90", "lower end of the 90 % interval", G(low90),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_high90", "upper end of the 90 % interval", G(high90),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("issued", "1 where the forecast is issued", G(issued)),
    EACH("rms", "rms of the residuals", G(rms), .flags = LAC_MISSING,
         .comment = "in m, of inv8, inv and slo in s/m: the residuals of inverse velocity; of a "
                    "case fitted to velocities in their logarithm"),
    EACH("misfit", "rms of the residuals over the range of what was fitted", G(misfit),
         .flags = LAC_MISSING),
    EACH("relative_error", "standard error of the logarithm of the remaining time, by the fit",
         G(relative_error), .flags = LAC_MISSING),
    EACH("reason", "why the forecast is not issued", T(reason), .comment = "empty where it is",
         .flags = LAC_CHARS),
};

static const lac_variable attributes[] = {
    {.name = "source_file", T(source)},
    {.name = "source_attribution", T(attribution)},
    {.name = "failed_at_s", G(failed_at)},
    {.name = "failed_at_date", T(failed_on)},
    {.name = "noise_m", G(noise)},
    {.name = "outliers", G(outliers), .flags = LAC_WHOLE},
    {.name = "resets", G(resets), .flags = LAC_WHOLE},
    {.name = "resets_disbelieved", G(disbelieved), .flags = LAC_WHOLE},
    {.name = "falling", G(falling), .flags = LAC_WHOLE},
    {.name = "gaps", G(gaps), .flags = LAC_WHOLE},
    {.name = "status", T(status)},
};

// Number `which` of all indicators, MOST_VALUES of each; the last of each: what went into it.
static double found(const void *of, const size_t *at)
{
    const lac_forecast_outcome *o = of;
    const size_t k = at[1] / MOST_VALUES, v = at[1] % MOST_VALUES;
    const lac_precursor *p = &o->indicator[at[0] * o->indicators + k];
    return v == MOST_VALUES - 1 ? (double)p->found.points
                                : lac_precursor_find(p, p->kind->value[v].key);
}

// Whether any issue time has it.
static bool any(const lac_forecast_outcome *o, size_t which, size_t issues)
{
    for (size_t i = 0; i < issues; i++) {
        const double value = found(o, (const size_t[]){i, which});
        if (isfinite(value) && (which % MOST_VALUES != MOST_VALUES - 1 || value > 0.0)) {
            return true;
        }
    }
    return false;
}

static lac_status add_indicator(lac_dataset *d, const lac_forecast_outcome *o, size_t k,
                                size_t issues, lac_error *err)
{
    static const lac_variable value = {
        .dims = "issue", G(found), .coordinates = "issue_time", .flags = LAC_MISSING};
    static const lac_variable points = {.dims = "issue", G(found), .coordinates = "issue_time"};
    static const lac_precursor_value of_points = {.key = "points", .text = "what went into it"};
    const lac_precursor_kind *kind = o->indicator[k].kind;
    lac_status status = LAC_OK;
    for (size_t v = 0; v <= kind->value_count && status == LAC_OK; v++) {
        const bool last = v == kind->value_count;
        const lac_precursor_value *of = last ? &of_points : &kind->value[v];
        char name[NAME], long_name[LONG_NAME];
        (void)snprintf(name, sizeof name, "%s_%s", kind->about.name, of->key);
        (void)snprintf(long_name, sizeof long_name, "%s: %s", kind->about.name, of->text);
        const lac_named named = {.name = name,
                                 .long_name = long_name,
                                 .unit = of->unit,
                                 .comment = last ? NULL : kind->estimator,
                                 .which = k * MOST_VALUES + (last ? MOST_VALUES - 1 : v)};
        if (any(o, named.which, issues)) {
            status = lac_dataset_add_named(d, last ? &points : &value, &named, o, err);
        }
    }
    return status;
}

lac_status lac_forecast_describe(const lac_forecast_outcome *o, lac_dataset **out, lac_error *err)
{
    const lac_motion *m = o->outlook->motion;
    const size_t issues = o->rolling != NULL ? o->rolling->issues : 1;
    const lac_extent dims[] = {{"reading", m->n},
                               {"velocity_reading", m->velocities},
                               {"issue", issues},
                               {"method", o->outlook->count}};
    const lac_laid laid[] = {{LAC_VARIABLES(rows, "", 0), o},
                             {LAC_VARIABLES(attributes, "", 0), o}};
    lac_dataset *d = NULL;
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_dataset_create("Forecasts of the time of failure of a slope, by several methods, "
                               "and indicators of it, from what was known at each issue time.",
                               &d, err));
    lac_dataset_set_clock(d, o->dated ? LAC_CLOCK_1970 : LAC_CLOCK_NONE, 0.0);
    LAC_TRY(lac_dataset_dims(d, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(d, laid, 1, err));
    for (size_t k = 0; k < o->indicators; k++) {
        LAC_TRY(add_indicator(d, o, k, issues, err));
    }
    LAC_TRY(lac_dataset_add(d, laid + 1, 1, err));
    *out = d;
    d = NULL;
out:
    lac_dataset_free(d);
    return status;
}
