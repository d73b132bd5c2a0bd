// SPDX-License-Identifier: GPL-3.0-or-later
// What forecasts and indicators came to, as tables: the variables of their file, and their JSON.
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
                              : &o->forecasts->forecast[method];
}

static const char *date(const lac_forecast_outcome *o, double t, char room[LAC_TEXT_ROOM])
{
    const char *text = o->dated && isfinite(t) ? lac_date_format(t, room, LAC_TEXT_ROOM) : "";
    return text[0] != '\0' ? text : NULL;
}

#define OUTCOME const lac_forecast_outcome *o = of
#define MOTION const lac_motion *m = ((const lac_forecast_outcome *)of)->forecasts->motion
#define ISSUE \
    OUTCOME;  \
    const lac_forecast *f = forecast(of, at[0], 0)
#define LAST                                                      \
    OUTCOME;                                                      \
    const lac_readings *in = o->readings;                         \
    const double first = in->time[0], last = in->time[in->n - 1]; \
    (void)first, (void)last
// A forecast with one of its numbers: at the last reading, at an issue time.
#define NOW                                                 \
    OUTCOME;                                                \
    const lac_forecast *f = &o->forecasts->forecast[at[0]]; \
    const size_t i = at[1];                                 \
    (void)o, (void)i, (void)f
#define THEN                                           \
    OUTCOME;                                           \
    const lac_forecast *f = forecast(o, at[0], at[1]); \
    const size_t i = at[2];                            \
    (void)o, (void)i, (void)f
#define BOTH(returned, name, expression)              \
    LAC_GETTER(returned, name##_now, NOW, expression) \
    LAC_GETTER(returned, name##_then, THEN, expression)
#define BOTH_TEXT(name, expression)              \
    LAC_TEXT_GETTER(name##_now, NOW, expression) \
    LAC_TEXT_GETTER(name##_then, THEN, expression)

LAC_GETTER(double, reading_time, MOTION, m->time[at[0]])
LAC_GETTER(double, displacement, MOTION, m->displacement[at[0]])
LAC_GETTER(double, velocity_time, MOTION, m->velocity_time[at[0]])
LAC_GETTER(double, velocity, MOTION, m->velocity[at[0]])
LAC_GETTER(double, issue_time, ISSUE; (void)o, f->issue_time)
LAC_TEXT_GETTER(issue_date, ISSUE, date(o, f->issue_time, room))
LAC_GETTER(double, window_start, ISSUE; (void)o, f->window_start)
LAC_TEXT_GETTER(window_date, ISSUE, date(o, f->window_start, room))
BOTH_TEXT(method, f->kind->info.name)
LAC_TEXT_GETTER(method_first, OUTCOME, forecast(o, 0, at[0])->kind->info.name)
BOTH(double, tc, f->time)
BOTH_TEXT(tc_date, date(o, f->time, room))
BOTH(double, low50, f->low50)
BOTH(double, high50, f->high50)
BOTH(bool, has50, !isnan(f->low50) && !isnan(f->high50))
BOTH(double, low90, f->low90)
BOTH(double, high90, f->high90)
BOTH(bool, has90, !isnan(f->low90) && !isnan(f->high90))
BOTH(bool, has_posterior, f->fit.posterior)
BOTH(double, posterior0, f->issue_time + exp(f->fit.quantile[0]))
BOTH(double, posterior1, f->issue_time + exp(f->fit.quantile[1]))
BOTH(double, posterior2, f->issue_time + exp(f->fit.quantile[2]))
BOTH(double, posterior3, f->issue_time + exp(f->fit.quantile[3]))
BOTH(double, posterior4, f->issue_time + exp(f->fit.quantile[4]))
BOTH(double, issued, f->issued ? 1.0 : 0.0)
BOTH_TEXT(why, f->issued ? NULL : f->fit.reason)
BOTH(double, rms, f->fit.rms)
BOTH_TEXT(rms_unit, f->fit.rms_unit)
BOTH(double, misfit, f->fit.misfit)
BOTH(double, relative_error, f->fit.error)
BOTH(double, points, (double)f->fit.points)
BOTH(bool, has_value, i < f->fit.count)
BOTH_TEXT(key, f->fit.value[i].key)
BOTH(double, value, f->fit.value[i].value)
BOTH(bool, has_end, i < f->fit.ends)
BOTH_TEXT(end, f->fit.end[i])
LAC_TEXT_GETTER(reason, OUTCOME, forecast(o, at[0], at[1])->fit.reason)

// Indicators, the same.
#undef NOW
#undef THEN
#define NOW                                        \
    OUTCOME;                                       \
    const lac_precursor *p = &o->indicator[at[0]]; \
    const size_t i = at[1];                        \
    (void)i
#define THEN                                                                     \
    OUTCOME;                                                                     \
    const lac_precursor *p =                                                     \
        &o->indicator_series->found[at[0] * o->indicator_series->kinds + at[1]]; \
    const size_t i = at[2];                                                      \
    (void)i
BOTH_TEXT(indicator, p->kind->info.name)
BOTH_TEXT(needs, lac_needs_name(p->kind->needs))
BOTH(double, found_points, (double)p->found.points)
BOTH_TEXT(none, p->found.reason[0] != '\0' ? p->found.reason : NULL)
BOTH(bool, has_found, i < p->found.count)
BOTH_TEXT(found_key, p->found.value[i].key)
BOTH(double, found_value, p->found.value[i].value)

LAC_TEXT_GETTER(kind, OUTCOME, o->series == NULL ? "run" : "series")
LAC_GETTER(double, readings, LAST, (double)in->n)
LAC_GETTER(double, first_time, LAST, first)
LAC_TEXT_GETTER(first_date, LAST, date(o, first, room))
LAC_GETTER(double, last_time, LAST, last)
LAC_TEXT_GETTER(last_date, LAST, date(o, last, room))
#define COUNTED(name, field) \
    LAC_GETTER(double, name, OUTCOME, o->series != NULL ? (double)o->series->field : 0.0)
COUNTED(missing, missing)
COUNTED(duplicates, duplicates)
COUNTED(conflicts, conflicts)
COUNTED(disordered, disordered)
LAC_TEXT_GETTER(doubt, OUTCOME, o->series->doubt[at[0]])
LAC_TEXT_GETTER(attribution, OUTCOME, o->series != NULL ? o->series->attribution : NULL)
LAC_GETTER(double, resolution, MOTION, m->integrated ? (double)NAN : m->resolution)
LAC_GETTER(double, velocities, MOTION, (double)m->velocities)
LAC_GETTER(double, integrated, MOTION, m->integrated ? 1.0 : 0.0)
LAC_GETTER(double, accelerating, OUTCOME, o->forecasts->accelerating ? 1.0 : 0.0)
LAC_GETTER(double, last_issue, OUTCOME, o->forecasts->issue_time)
LAC_TEXT_GETTER(last_issue_date, OUTCOME, date(o, o->forecasts->issue_time, room))
LAC_GETTER(double, last_start, OUTCOME,
           o->forecasts->asked ? o->forecasts->window_start : (double)NAN)
LAC_TEXT_GETTER(last_start_date, OUTCOME,
                o->forecasts->asked ? date(o, o->forecasts->window_start, room) : NULL)
LAC_TEXT_GETTER(failed_on, OUTCOME, date(o, o->failed_at, room))
LAC_TEXT_GETTER(status, OUTCOME, o->interrupted ? "interrupted" : "complete")
LAC_GETTER(double, nothing, (void)of, NAN)
#define SKILL const lac_skill *s = (const lac_skill *)of + at[0]
LAC_TEXT_GETTER(skill_method, SKILL, s->kind->info.name)
LAC_GETTER(double, lead_count, SKILL, (double)s->lead_count[at[1]])
LAC_GETTER(double, lead_error, SKILL, s->lead_error[at[1]])
LAC_GETTER(double, lead_bias, SKILL, s->lead_bias[at[1]])

#define G(getter) .value = (getter)
#define T(getter) .text = (getter)
#define TIME(name, dims, getter, long_name, ...) \
    LAC_ROW(name, dims, NULL, long_name, G(getter), __VA_ARGS__)
// Of each issue time and method.
#define EACH(name, long_name, ...) \
    LAC_ROW(name, "issue method", NULL, long_name, .coordinates = "issue_time method", __VA_ARGS__)

static const lac_variable rows[] = {
    LAC_ROW("method", "method", NULL, "method of forecasting", T(method_first),
            .flags = LAC_MEANINGS),
    TIME("reading_time", "reading", reading_time, "time of the reading", .flags = LAC_TIME),
    LAC_ROW("displacement", "reading", "m", "displacement", G(displacement),
            .comment =
                "without outliers, resets of the sensor taken out; its negative where it falls "
                "(attribute falling); the integral of the velocity where only that was given"),
    TIME("velocity_time", "velocity_reading", velocity_time, "time of the velocity",
         .flags = LAC_TIME | LAC_EMPTY),
    LAC_ROW("velocity", "velocity_reading", "m s-1", "velocity", G(velocity),
            .comment = "looks back only", .flags = LAC_EMPTY),
    TIME("issue_time", "issue", issue_time, "time at which the forecasts are issued",
         .comment = "nothing later was known to them", .flags = LAC_TIME),
    TIME("window_start", "issue", window_start, "start of what was fitted",
         .comment = "missing where nothing was", .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time", "forecast time of failure", G(tc_then),
         .comment = "also where it is not issued, as far as the fit went",
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_low50", "lower end of the 50 % interval", G(low50_then),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_high50", "upper end of the 50 % interval", G(high50_then),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_low90", "lower end of the 90 % interval", G(low90_then),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("failure_time_high90", "upper end of the 90 % interval", G(high90_then),
         .flags = LAC_TIME | LAC_MISSING),
    EACH("issued", "1 where the forecast is issued", G(issued_then)),
    EACH("rms", "rms of the residuals", G(rms_then), .flags = LAC_MISSING,
         .comment = "in m, of inv8, inv and slo in s/m: the residuals of inverse velocity; of a "
                    "case fitted to velocities in their logarithm"),
    EACH("misfit", "rms of the residuals over the range of what was fitted", G(misfit_then),
         .flags = LAC_MISSING),
    EACH("relative_error", "standard error of the logarithm of the remaining time, by the fit",
         G(relative_error_then), .flags = LAC_MISSING),
    EACH("reason", "why the forecast is not issued", T(reason), .comment = "empty where it is",
         .flags = LAC_CHARS),
};

#define O(kind_, field) LAC_HELD(kind_, lac_forecast_outcome, field)
#define M(kind_, field) LAC_HELD(kind_, lac_motion, field)

static const lac_variable of_source[] = {
    {.name = "source_file", .json = "series/path", O(TEXT, source)},
    {.json = "series/kind", T(kind)},
    {.json = "series/readings", G(readings)},
    {.json = "series/first_s", G(first_time)},
    {.json = "series/first_date", T(first_date)},
    {.json = "series/last_s", G(last_time)},
    {.json = "series/last_date", T(last_date)},
    {.json = "series/missing", G(missing)},
    {.json = "series/duplicates", G(duplicates)},
    {.json = "series/conflicts", G(conflicts)},
    {.json = "series/disordered", G(disordered)},
    {.name = "source_attribution", T(attribution)},
    {.name = "failed_at_s", .unit = "s", O(REAL, failed_at)},
    {.name = "failed_at_date", T(failed_on)},
};
static const lac_variable of_motion[] = {
    {.json = "series/gaps", M(COUNT, gaps)},
    {.json = "series/median_interval_s", M(REAL, interval)},
    {.json = "series/longest_interval_s", M(REAL, longest_gap)},
    {.name = "noise_m", .unit = "m", M(REAL, noise)},
    {.name = "outliers", .json = "series/outliers", M(COUNT, outliers), .flags = LAC_WHOLE},
    {.name = "resets", .json = "series/resets", M(COUNT, resets), .flags = LAC_WHOLE},
    {.name = "resets_disbelieved",
     .json = "series/resets_disbelieved",
     M(COUNT, disbelieved),
     .flags = LAC_WHOLE},
    {.name = "falling", .json = "series/falling", M(BOOL, falling), .flags = LAC_WHOLE},
    {.name = "gaps", M(COUNT, gaps), .flags = LAC_WHOLE},
    {.json = "series/noise_m", M(REAL, noise)},
};
static const lac_variable of_outlook[] = {
    {.json = "series/resolution_m", G(resolution)},
    {.json = "series/velocities", G(velocities)},
    {.json = "series/integrated", G(integrated), .flags = LAC_TRUTH},
    {.json = "series/attribution", T(attribution)},
    {.json = "series/warnings[]", .dims = "doubt", T(doubt)},
    {.name = "status", T(status)},
    {.json = "issue_time_s", G(last_issue)},
    {.json = "issue_date", T(last_issue_date)},
    {.json = "window_start_s", G(last_start)},
    {.json = "window_start_date", T(last_start_date)},
    {.json = "accelerating", G(accelerating), .flags = LAC_TRUTH},
};

// What is told of a forecast and of an indicator. @param of  _now or _then
#define OF_FORECAST(in, over, of)                                                             \
    {.json = in "method", T(method##of)}, {.json = in "tc_s", G(tc##of)},                     \
        {.json = in "tc_date", T(tc_date##of)},                                               \
        {.json = in "interval50_s", G(low50##of), .has = has50##of},                          \
        {.json = in "interval50_s", G(high50##of)},                                           \
        {.json = in "interval90_s", G(low90##of), .has = has90##of},                          \
        {.json = in "interval90_s", G(high90##of)},                                           \
        {.json = in "posterior_s", G(posterior0##of), .has = has_posterior##of},              \
        {.json = in "posterior_s", G(posterior1##of)},                                        \
        {.json = in "posterior_s", G(posterior2##of)},                                        \
        {.json = in "posterior_s", G(posterior3##of)},                                        \
        {.json = in "posterior_s", G(posterior4##of)},                                        \
        {.json = in "issued", G(issued##of), .flags = LAC_TRUTH},                             \
        {.json = in "reason", T(why##of)}, {.json = in "rms", G(rms##of)},                    \
        {.json = in "rms_unit", T(rms_unit##of)}, {.json = in "misfit", G(misfit##of)},       \
        {.json = in "relative_error", G(relative_error##of)},                                 \
        {.json = in "points", G(points##of)},                                                 \
        {.json = in "parameters{}",                                                           \
         .dims = over " value",                                                               \
         G(value##of),                                                                        \
         .label = key##of,                                                                    \
         .has = has_value##of},                                                               \
    {                                                                                         \
        .json = in "at_end_of_range[]", .dims = over " value", T(end##of), .has = has_end##of \
    }
#define OF_INDICATOR(in, over, of)                                                                \
    {.json = in "indicator", T(indicator##of)}, {.json = in "needs", T(needs##of)},               \
        {.json = in "points", G(found_points##of)}, {.json = in "reason", T(none##of)},           \
    {                                                                                             \
        .json = in "values{}", .dims = over " value", G(found_value##of), .label = found_key##of, \
        .has = has_found##of                                                                      \
    }
static const lac_variable of_forecasts[] = {OF_FORECAST("forecasts[]/", "method", _now)};
static const lac_variable of_indicators[] = {OF_INDICATOR("indicators[]/", "indicator", _now)};
static const lac_variable of_rolling[] = {
    {.json = "rolling/horizon_s", O(REAL, horizon)},
    {.json = "rolling/failed_at_s", O(REAL, failed_at)},
    {.json = "rolling/failed_at_date", T(failed_on)},
    {.json = "rolling/issues[]/issue_time_s", .dims = "issue", G(issue_time)},
    {.json = "rolling/issues[]/issue_date", .dims = "issue", T(issue_date)},
    {.json = "rolling/issues[]/window_start_s", .dims = "issue", G(window_start)},
    {.json = "rolling/issues[]/window_start_date", .dims = "issue", T(window_date)},
};
static const lac_variable of_issues[] = {
    OF_FORECAST("rolling/issues[]/forecasts[]/", "issue method", _then)};
static const lac_variable of_course[] = {
    OF_INDICATOR("rolling/issues[]/indicators[]/", "issue kind", _then)};
static const lac_variable no_skill[] = {{.json = "rolling/skill", G(nothing)}};

#define K(name_, kind_, field)                                              \
    {                                                                       \
        .json = "rolling/skill[]/" name_, LAC_HELD(kind_, lac_skill, field) \
    }
static const lac_variable of_skill[] = {
    {.json = "rolling/skill[]/method", T(skill_method)},
    K("asked", COUNT, asked),
    K("issued", COUNT, issued),
    K("median_error_s", REAL, error),
    K("inside50", COUNT, inside50),
    K("inside90", COUNT, inside90),
    K("crps_s", REAL, crps),
    K("persistence_crps_s", REAL, persistence_crps),
    K("alarms", COUNT, alarms),
    K("hits", COUNT, hits),
    K("false_alarms", COUNT, false_alarms),
    K("misses", COUNT, misses),
    {.json = "rolling/skill[]/lead[]/issued", .dims = "method lead", G(lead_count)},
    {.json = "rolling/skill[]/lead[]/median_error_s", .dims = "method lead", G(lead_error)},
    {.json = "rolling/skill[]/lead[]/median_remaining_over_true",
     .dims = "method lead",
     G(lead_bias)},
};

// Number `which` of all indicators, MOST_VALUES of each; the last of each: what went into it.
static double found(const void *of, const size_t *at)
{
    const lac_forecast_outcome *o = of;
    const size_t k = at[1] / MOST_VALUES, v = at[1] % MOST_VALUES;
    const lac_precursor *p =
        o->indicator_series != NULL
            ? &o->indicator_series->found[at[0] * o->indicator_series->kinds + k]
            : &o->indicator[k];
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
        (void)snprintf(name, sizeof name, "%s_%s", kind->info.name, of->key);
        (void)snprintf(long_name, sizeof long_name, "%s: %s", kind->info.name, of->text);
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

// For JSON: what was found at the last reading, and at the issue times.
static lac_status add_json(lac_dataset *d, const lac_forecast_outcome *o, lac_error *err)
{
    const lac_laid laid[] = {{LAC_VARIABLES(of_forecasts, "method", 0), o},
                             {LAC_VARIABLES(of_indicators, "indicator", 0), o},
                             {LAC_VARIABLES(of_rolling, "", 0), o},
                             {LAC_VARIABLES(of_issues, "issue method", 0), o},
                             {LAC_VARIABLES(of_course, "issue kind", 0), o}};
    const lac_laid skill =
        o->skill != NULL ? (lac_laid){LAC_VARIABLES(of_skill, "method", sizeof *o->skill), o->skill}
                         : (lac_laid){LAC_VARIABLES(no_skill, "", 0), o};
    const lac_status status = lac_dataset_add(d, laid, o->rolling != NULL ? 5 : 2, err);
    return status == LAC_OK && o->rolling != NULL ? lac_dataset_add(d, &skill, 1, err) : status;
}

lac_status lac_forecast_describe(const lac_forecast_outcome *o, lac_dataset **out, lac_error *err)
{
    const lac_motion *m = o->forecasts->motion;
    const size_t issues = o->rolling != NULL ? o->rolling->issues : 1;
    const lac_extent dims[] = {
        {"reading", m->n},
        {"velocity_reading", m->velocities},
        {"issue", issues},
        {"method", o->forecasts->count},
        {"indicator", o->indicators},
        {"kind", o->indicator_series != NULL ? o->indicator_series->kinds : 0},
        {"value", LAC_FORECAST_VALUES},
        {"doubt", o->series != NULL ? o->series->doubts : 0},
        {"lead", LAC_LEADS}};
    const lac_laid laid[] = {{LAC_VARIABLES(rows, "", 0), o},
                             {LAC_VARIABLES(of_source, "", 0), o},
                             {LAC_VARIABLES(of_motion, "", 0), m},
                             {LAC_VARIABLES(of_outlook, "", 0), o}};
    lac_status status;
    LAC_TRY(lac_dataset_create("Forecasts of the time of failure of a slope, by several methods, "
                               "and indicators of it, from what was known at each issue time.",
                               out, err));
    (*out)->clock = o->dated ? LAC_CLOCK_1970 : LAC_CLOCK_NONE;
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, 1, err));
    for (size_t k = 0; k < o->indicators; k++) {
        LAC_TRY(add_indicator(*out, o, k, issues, err));
    }
    LAC_TRY(lac_dataset_add(*out, laid + 1, 3, err));
    LAC_TRY(o->readings != NULL ? add_json(*out, o, err) : LAC_OK);
out:
    return lac_dataset_described(out, status);
}
