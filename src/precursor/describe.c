// SPDX-License-Identifier: GPL-3.0-or-later
// What forecasts and indicators came to, as tables: the variables of their file, and their JSON.
#include "data/describe.h"
#include "precursor/kinds.h"

enum { NAME = 80, LONG_NAME = 160, MOST_VALUES = 64 };

#define OUTCOME const lac_forecast_outcome *o = of
#define MOTION const lac_motion *m = of
#define READINGS const lac_readings *in = of
#define SET const lac_forecast_set *s = of
#define FORECAST const lac_forecast *f = of
#define INDICATOR const lac_precursor *p = of
#define SKILL const lac_skill *s = of

LAC_TEXT_GETTER(kind, OUTCOME, o->series == NULL ? "run" : "series")
LAC_TEXT_GETTER(run_status, OUTCOME, o->run_status[0] != '\0' ? o->run_status : NULL)
LAC_TEXT_GETTER(doubt, OUTCOME, o->series->doubt[at[0]])
LAC_TEXT_GETTER(time_zone, OUTCOME, !o->dated ? NULL : lac_outcome_zoned(o) ? "UTC" : "not stated")
LAC_TEXT_GETTER(attribution, OUTCOME, o->series != NULL ? o->series->attribution : NULL)
LAC_TEXT_GETTER(status, OUTCOME, o->interrupted ? "interrupted" : "complete")
LAC_GETTER(double, last_time, READINGS, in->time[in->n - 1])
LAC_GETTER(double, resolution, MOTION, m->integrated ? (double)NAN : m->resolution)
LAC_GETTER(double, window_start, SET, s->asked ? s->window_start : (double)NAN)

LAC_TEXT_GETTER(method, FORECAST, f->kind->info.name)
LAC_GETTER(bool, has50, FORECAST, !isnan(f->low50) && !isnan(f->high50))
LAC_GETTER(bool, has90, FORECAST, !isnan(f->low90) && !isnan(f->high90))
LAC_GETTER(bool, has_posterior, FORECAST, f->fit.posterior)
LAC_GETTER(bool, judged, FORECAST, f->kind == &lac_forecast_case && !isnan(f->fit.rms))
#define POSTERIOR(k) \
    LAC_GETTER(double, posterior##k, FORECAST, f->issue_time + exp(f->fit.quantile[k]))
POSTERIOR(0)
POSTERIOR(1)
POSTERIOR(2)
POSTERIOR(3)
POSTERIOR(4)
LAC_TEXT_GETTER(why, FORECAST, f->issued ? NULL : f->fit.reason)
LAC_GETTER(bool, has_value, FORECAST, at[0] < f->fit.count)
LAC_TEXT_GETTER(key, FORECAST, f->fit.value[at[0]].key)
LAC_GETTER(double, value, FORECAST, f->fit.value[at[0]].value)
LAC_GETTER(bool, has_end, FORECAST, at[0] < f->fit.ends)
LAC_TEXT_GETTER(end, FORECAST, f->fit.end[at[0]])

LAC_TEXT_GETTER(indicator, INDICATOR, p->kind->info.name)
LAC_TEXT_GETTER(needs, INDICATOR, lac_needs_name(p->kind->needs))
LAC_GETTER(bool, has_found, INDICATOR, at[0] < p->found.count)
LAC_TEXT_GETTER(found_key, INDICATOR, p->found.value[at[0]].key)
LAC_GETTER(double, found_value, INDICATOR, p->found.value[at[0]].value)
LAC_TEXT_GETTER(skill_method, SKILL, s->kind->info.name)

#define O(kind_, field) LAC_HELD(kind_, lac_forecast_outcome, field)
#define M(kind_, field) LAC_HELD(kind_, lac_motion, field)
#define F(kind_, field) LAC_HELD(kind_, lac_forecast, field)
#define DATE .flags = LAC_DATE
#define TIME(name, field, long_name, ...) \
    LAC_ROW(name, NULL, NULL, long_name, field, .flags = LAC_TIME | __VA_ARGS__)

static const lac_variable of_methods[] = {
    LAC_ROW("method", NULL, NULL, "method of forecasting", T(method), .flags = LAC_MEANINGS)};
static const lac_variable of_readings[] = {
    TIME("reading_time", M(REALS, time), "time of the reading", 0),
    LAC_ROW("displacement", NULL, "m", "displacement", M(REALS, displacement),
            .comment =
                "without outliers, resets of the sensor taken out; its negative where it falls "
                "(attribute falling); the integral of the velocity where only that was given"),
};
static const lac_variable of_velocities[] = {
    TIME("velocity_time", M(REALS, velocity_time), "time of the velocity", LAC_EMPTY),
    LAC_ROW("velocity", NULL, "m s-1", "velocity", M(REALS, velocity), .comment = "looks back only",
            .flags = LAC_EMPTY),
};
static const lac_variable of_issues[] = {
    TIME("issue_time", F(REAL, issue_time), "time at which the forecasts are issued", 0,
         .comment = "nothing later was known to them"),
    TIME("window_start", F(REAL, window_start), "start of what was fitted", LAC_MISSING,
         .comment = "missing where nothing was"),
};

#define EACH(name, field, long_name, ...) \
    LAC_ROW(name, NULL, NULL, long_name, field, .coordinates = "issue_time method", __VA_ARGS__)
#define MAYBE .flags = LAC_MISSING
#define MAYBE_TIME .flags = (LAC_TIME | LAC_MISSING)
static const lac_variable of_each[] = {
    EACH("failure_time", F(REAL, time), "forecast time of failure: the calibrated median",
         MAYBE_TIME, .comment = "also where it is not issued, as far as the fit went"),
    EACH("failure_time_raw", F(REAL, raw_time), "time of failure that the method itself finds",
         MAYBE_TIME, .comment = "also where it is not issued, as far as the fit went"),
    EACH("failure_time_low50", F(REAL, low50), "lower end of the 50 % interval", MAYBE_TIME),
    EACH("failure_time_high50", F(REAL, high50), "upper end of the 50 % interval", MAYBE_TIME),
    EACH("failure_time_low90", F(REAL, low90), "lower end of the 90 % interval", MAYBE_TIME),
    EACH("failure_time_high90", F(REAL, high90), "upper end of the 90 % interval", MAYBE_TIME),
    EACH("issued", F(BOOL, issued), "1 where the forecast is issued", .has = NULL),
    EACH("rms", F(REAL, fit.rms), "rms of the residuals", MAYBE,
         .comment = "in m, of inv8, inv and slo in s/m: the residuals of inverse velocity; of a "
                    "case fitted to velocities in their logarithm"),
    EACH("misfit", F(REAL, fit.misfit), "rms of the residuals over the range of what was fitted",
         MAYBE),
    EACH("excess", F(REAL, fit.excess), "what of the misfit the noise of readings does not explain",
         MAYBE),
    EACH("relative_error", F(REAL, fit.error),
         "standard error of the logarithm of the remaining time, by the fit", MAYBE),
    EACH("reason", F(CHARS, fit.reason), "why the forecast is not issued",
         .comment = "empty where it is", .flags = LAC_CHARS),
};

static const lac_variable of_source[] = {
    {.name = "source_file", .json = "series/path", O(TEXT, source)},
    {.json = "series/kind", T(kind)},
    {.name = "run_status", .json = "series/run_status", T(run_status)},
    {.name = "source_attribution", T(attribution)},
    {.name = "time_zone", .json = "series/time_zone", T(time_zone)},
    {.name = "failed_at_s", .unit = "s", O(REAL, failed_at)},
    {.name = "failed_at_date", O(REAL, failed_at), DATE},
};
static const lac_variable of_input[] = {
    LAC_JSON("series/readings", COUNT, lac_readings, n),
    LAC_JSON("series/first_s", REALS, lac_readings, time),
    {.json = "series/first_date", LAC_HELD(REALS, lac_readings, time), DATE},
    {.json = "series/last_s", G(last_time)},
    {.json = "series/last_date", G(last_time), DATE},
};
static const lac_variable of_series[] = {
    LAC_JSON("series/missing", COUNT, lac_series, missing),
    LAC_JSON("series/duplicates", COUNT, lac_series, duplicates),
    LAC_JSON("series/conflicts", COUNT, lac_series, conflicts),
    LAC_JSON("series/disordered", COUNT, lac_series, disordered),
};
static const lac_variable of_motion[] = {
    {.json = "series/gaps", M(COUNT, gaps)},
    {.json = "series/median_interval_s", M(REAL, interval)},
    {.json = "series/longest_interval_s", M(REAL, longest_gap)},
    {.name = "noise_m", .unit = "m", M(REAL, noise)},
    {.name = "outliers", .json = "series/outliers", M(COUNT, outliers), .flags = LAC_WHOLE},
    {.name = "resets", .json = "series/resets", M(COUNT, resets), .flags = LAC_WHOLE},
    LAC_BOTH("resets_disbelieved", "series/resets_disbelieved", M(COUNT, disbelieved),
             .flags = LAC_WHOLE),
    {.name = "falling", .json = "series/falling", M(BOOL, falling), .flags = LAC_WHOLE},
    {.name = "gaps", M(COUNT, gaps), .flags = LAC_WHOLE},
    {.json = "series/noise_m", M(REAL, noise)},
    {.json = "series/resolution_m", G(resolution)},
    {.json = "series/velocities", M(COUNT, velocities)},
    {.json = "series/integrated", M(BOOL, integrated)},
};
static const lac_variable of_outcome[] = {
    {.json = "series/attribution", T(attribution)},
    {.json = "series/warnings[]", .dims = "doubt", T(doubt)},
    {.name = "status", T(status)},
};
static const lac_variable of_set[] = {
    LAC_JSON("issue_time_s", REAL, lac_forecast_set, issue_time),
    {.json = "issue_date", LAC_HELD(REAL, lac_forecast_set, issue_time), DATE},
    {.json = "window_start_s", G(window_start)},
    {.json = "window_start_date", G(window_start), DATE},
    LAC_JSON("accelerating", BOOL, lac_forecast_set, accelerating),
};

// What is told of a forecast and of an indicator, at the last reading and at issue times.
#define OF_FORECAST(in, over)                                                                    \
    {.json = in "method", T(method)}, {.json = in "tc_s", F(REAL, time)},                        \
        {.json = in "tc_date", F(REAL, time), DATE}, {.json = in "tc_raw_s", F(REAL, raw_time)}, \
        {.json = in "interval50_s", F(REAL, low50), .has = has50},                               \
        {.json = in "interval50_s", F(REAL, high50)},                                            \
        {.json = in "interval90_s", F(REAL, low90), .has = has90},                               \
        {.json = in "interval90_s", F(REAL, high90)},                                            \
        {.json = in "posterior_s", G(posterior0), .has = has_posterior},                         \
        {.json = in "posterior_s", G(posterior1)}, {.json = in "posterior_s", G(posterior2)},    \
        {.json = in "posterior_s", G(posterior3)}, {.json = in "posterior_s", G(posterior4)},    \
        {.json = in "issued", F(BOOL, issued)}, {.json = in "reason", T(why)},                   \
        {.json = in "rms", F(REAL, fit.rms)}, {.json = in "rms_unit", F(TEXT, fit.rms_unit)},    \
        {.json = in "misfit", F(REAL, fit.misfit)}, {.json = in "excess", F(REAL, fit.excess)},  \
        {.json = in "fits_badly", F(BOOL, fit.poor), .has = judged},                             \
        {.json = in "relative_error", F(REAL, fit.error)},                                       \
        {.json = in "points", F(COUNT, fit.points)},                                             \
        {.json = in "parameters{}",                                                              \
         .dims = over " value",                                                                  \
         G(value),                                                                               \
         .label = key,                                                                           \
         .has = has_value},                                                                      \
    {                                                                                            \
        .json = in "at_end_of_range[]", .dims = over " value", T(end), .has = has_end            \
    }
#define P(kind_, field) LAC_HELD(kind_, lac_precursor, field)
#define OF_INDICATOR(in, over)                                                            \
    {.json = in "indicator", T(indicator)}, {.json = in "needs", T(needs)},               \
        {.json = in "points", P(COUNT, found.points)},                                    \
        {.json = in "reason", P(CHARS, found.reason), .flags = LAC_MISSING},              \
    {                                                                                     \
        .json = in "values{}", .dims = over " value", G(found_value), .label = found_key, \
        .has = has_found                                                                  \
    }
static const lac_variable of_forecasts[] = {OF_FORECAST("forecasts[]/", "method")};
static const lac_variable of_indicators[] = {OF_INDICATOR("indicators[]/", "indicator")};
static const lac_variable of_rolling[] = {
    {.json = "rolling/horizon_s", O(REAL, horizon)},
    {.json = "rolling/failed_at_s", O(REAL, failed_at)},
    {.json = "rolling/failed_at_date", O(REAL, failed_at), DATE},
};
static const lac_variable of_times[] = {
    {.json = "rolling/issues[]/issue_time_s", F(REAL, issue_time)},
    {.json = "rolling/issues[]/issue_date", F(REAL, issue_time), DATE},
    {.json = "rolling/issues[]/window_start_s", F(REAL, window_start)},
    {.json = "rolling/issues[]/window_start_date", F(REAL, window_start), DATE},
};
static const lac_variable of_rolled[] = {
    OF_FORECAST("rolling/issues[]/forecasts[]/", "issue method")};
static const lac_variable of_course[] = {
    OF_INDICATOR("rolling/issues[]/indicators[]/", "issue kind")};
static const lac_variable no_skill[] = {{.json = "rolling/skill"}};

#define K(name_, kind_, field, ...)                                                      \
    {                                                                                    \
        .json = "rolling/skill[]/" name_, LAC_HELD(kind_, lac_skill, field), __VA_ARGS__ \
    }
#define LEAD .dims = "method lead"
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
    K("lead[]/issued", COUNT, lead_count, LEAD),
    K("lead[]/median_error_s", REAL, lead_error, LEAD),
    K("lead[]/median_remaining_over_true", REAL, lead_bias, LEAD),
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
                                : lac_forecast_fit_find(&p->found, p->kind->value[v].key);
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
    const size_t size = sizeof(lac_forecast), sized = sizeof(lac_precursor);
    const lac_rolling *r = o->rolling;
    const lac_indicator_series *series = o->indicator_series;
    const lac_laid now[] = {{LAC_VARIABLES(of_forecasts, "method", size), o->forecasts->forecast},
                            {LAC_VARIABLES(of_indicators, "indicator", sized), o->indicator}};
    LAC_TRY_RETURN(lac_dataset_add(d, now, 2, err));
    if (r == NULL) {
        return LAC_OK;
    }
    const lac_laid then[] = {
        {LAC_VARIABLES(of_rolling, "", 0), o},
        {LAC_VARIABLES(of_times, "issue", o->forecasts->count * size), r->forecast},
        {LAC_VARIABLES(of_rolled, "issue method", size), r->forecast},
        {LAC_VARIABLES(of_course, "issue kind", sized), series != NULL ? series->found : NULL},
        o->skill != NULL ? (lac_laid){LAC_VARIABLES(of_skill, "method", sizeof *o->skill), o->skill}
                         : (lac_laid){LAC_VARIABLES(no_skill, "", 0), NULL}};
    return lac_dataset_add(d, then, sizeof then / sizeof *then, err);
}

lac_status lac_forecast_describe(const lac_forecast_outcome *o, lac_dataset **out, lac_error *err)
{
    static const lac_series of_run = {0};
    const lac_motion *m = o->forecasts->motion;
    const lac_forecast *first = o->rolling != NULL ? o->rolling->forecast : o->forecasts->forecast;
    const size_t issues = o->rolling != NULL ? o->rolling->issues : 1, size = sizeof *first;
    const lac_extent dims[] = {
        {"reading", m->n},
        {"velocity_reading", m->velocities},
        {"issue", issues},
        {"method", o->forecasts->count},
        {"indicator", o->indicators},
        {"kind", o->indicator_series != NULL ? o->indicator_series->kinds : 0},
        {"value", LAC_FORECAST_VALUES},
        {"doubt", o->series != NULL ? o->series->doubts : 0},
        {"lead", LAC_LEADS},
        {"span", LAC_SPANS},
        {"quantile", LAC_FORECAST_LEVELS}};
    const lac_laid in_file[] = {
        {LAC_VARIABLES(of_methods, "method", size), first},
        {LAC_VARIABLES(of_readings, "reading", 0), m},
        {LAC_VARIABLES(of_velocities, "velocity_reading", 0), m},
        {LAC_VARIABLES(of_issues, "issue", o->forecasts->count * size), first},
        {LAC_VARIABLES(of_each, "issue method", size), first}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_source, "", 0), o},
        {LAC_VARIABLES(of_input, "", 0), o->readings},
        {LAC_VARIABLES(of_series, "", 0), o->series != NULL ? o->series : &of_run},
        {LAC_VARIABLES(of_motion, "", 0), m},
        {LAC_VARIABLES(of_outcome, "", 0), o},
        {LAC_VARIABLES(of_set, "", 0), o->forecasts}};
    lac_status status;
    LAC_TRY(lac_dataset_create("Forecasts of the time of failure of a slope, by several methods, "
                               "and indicators of it, from what was known at each issue time.",
                               out, err));
    (*out)->clock = o->dated ? LAC_CLOCK_1970 : LAC_CLOCK_NONE;
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, in_file, sizeof in_file / sizeof *in_file, err));
    for (size_t k = 0; k < o->indicators; k++) {
        LAC_TRY(add_indicator(*out, o, k, issues, err));
    }
    LAC_TRY(o->readings != NULL ? lac_verdict_describe(&o->forecasts->verdict, *out, err) : LAC_OK);
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
    LAC_TRY(lac_drivers_describe(o->forecasts, o->readings != NULL, *out, err));
    LAC_TRY(o->readings != NULL ? add_json(*out, o, err) : LAC_OK);
    LAC_TRY(lac_verdicts_describe(o, *out, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}

lac_status lac_issue_describe(const lac_forecast_set *forecasts, bool dated, lac_dataset **out,
                              lac_error *err)
{
    const lac_extent dims[] = {
        {"method", forecasts->count}, {"value", LAC_FORECAST_VALUES}, {"span", LAC_SPANS}};
    const lac_laid when = {LAC_VARIABLES(of_set, "", 0), forecasts};
    const lac_laid each = {LAC_VARIABLES(of_forecasts, "method", sizeof *forecasts->forecast),
                           forecasts->forecast};
    lac_status status;
    LAC_TRY(lac_dataset_create("Forecasts of the time of failure at one time.", out, err));
    (*out)->clock = dated ? LAC_CLOCK_1970 : LAC_CLOCK_NONE;
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, &when, 1, err));
    LAC_TRY(lac_verdict_describe(&forecasts->verdict, *out, err));
    LAC_TRY(lac_dataset_add(*out, &each, 1, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}
