// SPDX-License-Identifier: GPL-3.0-or-later
// The input of `lacuna precursors`: the motion in a series or a run, and the plan of forecasts.
#include "base/date.h"
#include "case/levels.h"
#include "cli/precursors/precursors.h"
#include "store/store_file.h"

enum { ISSUES = 200, MOST_ISSUES = 1000000 };

// Records whose time a double tells apart from the one before.
static size_t keep_increasing(cli_watched *w, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(w->time[i]) && (kept == 0 || w->time[i] > w->time[kept - 1])) {
            w->time[kept] = w->time[i];
            w->displacement[kept] = w->displacement[i];
            w->velocity[kept++] = w->velocity[i];
        }
    }
    return kept;
}

static lac_status read_run(cli_watched *w, lac_error *err)
{
    static const char *const names[] = {"time", "slip", "slip_rate"};
    double **const to[] = {&w->time, &w->displacement, &w->velocity};
    lac_stored_file *file = NULL;
    lac_stored_values read;
    char text[64];
    size_t n = 0;
    double start = 0.0;
    lac_status status;
    LAC_TRY(lac_stored_file_open(w->of.source, &file, err));
    for (size_t i = 0; i < 3; i++) {
        LAC_TRY(lac_stored_file_series(file, names[i], &read, err));
        *to[i] = read.value;
        n = read.n;
    }
    w->of.dated = lac_stored_file_text(file, NULL, "time_coverage_start", text, sizeof text) &&
                  lac_date_parse(text, &start);
    w->start = start;
    (void)lac_stored_file_text(file, NULL, "status", w->of.run_status, sizeof w->of.run_status);
    w->of.failed_at = lac_stored_file_number(file, NULL, "failure_time_s") + start;
    for (size_t i = 0; i < n; i++) {
        w->time[i] += start;
    }
    w->readings = (lac_readings){.n = keep_increasing(w, n),
                                 .time = w->time,
                                 .displacement = w->displacement,
                                 .velocity = w->velocity};
out:
    lac_stored_file_close(file);
    return status;
}

lac_status cli_watched_read(const cli_request *request, const lac_case *known,
                            const lac_units *units, cli_watched *out, lac_error *err)
{
    const char *failed_at = request->forecast.failed_at, *until = request->until;
    double last = INFINITY;
    *out = (cli_watched){
        .of = {.source = request->argument[0], .readings = &out->readings, .failed_at = NAN}};
    char text[32];
    out->run = !cli_series_named(request) &&
               lac_store_read_attribute(request->argument[0], "lacuna_format_version", text,
                                        sizeof text, NULL) == LAC_OK;
    lac_series *series = NULL;
    lac_status status;
    if (out->run) {
        LAC_TRY(read_run(out, err));
    } else {
        LAC_TRY(cli_series_read(request, known != NULL ? &known->fit.columns : NULL, out->of.source,
                                units, &series, err));
        out->of.series = series;
        out->of.dated = series->dated;
        out->readings = lac_series_readings(series);
    }
    if (strcmp(out->of.run_status, "failed") == 0 && !cli_given(request, CLI_OPT_QUIET)) {
        cli_note("warning: %s: this run ended by an error: neither its motion is a result nor what "
                 "follows from it",
                 out->of.source);
    }
    if (until != NULL) {
        LAC_TRY(cli_series_time("until", until, out->of.dated, units, &last, err));
    }
    while (out->readings.n > 0 && out->readings.time[out->readings.n - 1] > last) {
        out->readings.n--;
    }
    LAC_LEAVE_IF(out->readings.n == 0, err, LAC_EINPUT, "%s: has no reading%s%s", out->of.source,
                 until != NULL ? " until " : "", until != NULL ? until : "");
    if (failed_at != NULL && strcmp(failed_at, "never") == 0) {
        out->of.failed_at = INFINITY;
    } else if (failed_at != NULL) {
        LAC_TRY(
            cli_series_time("failed-at", failed_at, out->of.dated, units, &out->of.failed_at, err));
    }
    LAC_LEAVE_IF(failed_at != NULL && !(out->of.failed_at > out->readings.time[0]), err, LAC_EINPUT,
                 "--failed-at: \"%s\" must be later than the first reading", failed_at);
out:
    return status;
}

void cli_watched_clear(cli_watched *watched)
{
    lac_series_free((lac_series *)watched->of.series);
    free(watched->time);
    free(watched->displacement);
    free(watched->velocity);
}

// The number after a colon, or after a comma that follows; 0 where it is none.
static size_t read_count(const char *text, const char **end)
{
    char *after = NULL;
    const long long value = strtoll(text, &after, 10);
    *end = after;
    return after != text && value > 0 && value <= MOST_ISSUES ? (size_t)value : 0;
}

static lac_status read_smoothing(const char *text, const lac_units *units, lac_motion_def *def,
                                 lac_error *err)
{
    const char *end = "";
    bool known = false;
    if (strcmp(text, "none") == 0) {
        known = true;
    } else if (strncmp(text, "average:", 8) == 0) {
        def->smoothing = LAC_SMOOTH_AVERAGE;
        def->points = read_count(text + 8, &end);
        known = def->points > 0 && *end == '\0';
    } else if (strncmp(text, "window:", 7) == 0) {
        def->smoothing = LAC_SMOOTH_WINDOW;
        lac_status status = lac_units_parse(units, text + 7, "s", &def->window, err);
        return lac_fail_within(err, status, "--smooth: \"%s\"", text);
    } else if (strncmp(text, "savgol:", 7) == 0) {
        def->smoothing = LAC_SMOOTH_SAVGOL;
        def->points = read_count(text + 7, &end);
        def->order = *end == ',' ? read_count(end + 1, &end) : 0;
        known = def->points > 0 && def->order > 0 && *end == '\0';
    }
    return known
               ? LAC_OK
               : lac_fail(
                     err, LAC_EINPUT,
                     "--smooth: \"%s\" must be none, average:N, window:TIME or savgol:POINTS,ORDER",
                     text);
}

static lac_status read_onset(const char *text, lac_forecast_def *def, lac_error *err)
{
    const char *end = "";
    def->onset = true;
    def->short_run = read_count(text, &end);
    def->long_run = *end == ',' ? read_count(end + 1, &end) : 0;
    return def->short_run > 0 && def->long_run > def->short_run && *end == '\0'
               ? LAC_OK
               : lac_fail(
                     err, LAC_EINPUT,
                     "--onset: \"%s\" must be two numbers of velocities, the second larger: 3,7",
                     text);
}

// "2000", "90 day", "2000,90 day": a number without a unit is one of readings.
static lac_status read_window(const char *text, const lac_units *units, lac_forecast_def *def,
                              lac_error *err)
{
    const char *end = "";
    const size_t count = read_count(text, &end);
    const bool both = count > 0 && *end == ',';
    const bool counted = count > 0 && (both || *end == '\0');
    def->window_count = counted ? count : 0;
    if (both || !counted) {
        const lac_status status =
            lac_units_parse(units, both ? end + 1 : text, "s", &def->window_time, err);
        LAC_FAIL_IF(status != LAC_OK || !(def->window_time > 0.0), err, LAC_EINPUT,
                    "--window: \"%s\" must be a number of readings, a time or both: 2000, \"90 "
                    "day\", \"2000,90 day\"",
                    text);
    }
    return LAC_OK;
}

lac_status cli_forecast_plan_read(const cli_request *request, bool dated, const lac_units *units,
                                  cli_forecast_plan *plan, lac_error *err)
{
    const cli_forecast_words *words = &request->forecast;
    lac_status status = LAC_OK;
    *plan = (cli_forecast_plan){.def = lac_forecast_default(), .issues = ISSUES};
    plan->def.motion.raw = words->raw != NULL;
    if (words->smooth != NULL) {
        LAC_TRY(read_smoothing(words->smooth, units, &plan->def.motion, err));
    }
    if (words->since != NULL) {
        LAC_TRY(cli_series_time("since", words->since, dated, units, &plan->def.since, err));
    }
    if (words->onset != NULL) {
        LAC_TRY(read_onset(words->onset, &plan->def, err));
    }
    if (words->window != NULL) {
        LAC_TRY(read_window(words->window, units, &plan->def, err));
    }
    if (words->issues != NULL) {
        const char *end = "";
        plan->issues = read_count(words->issues, &end);
        LAC_LEAVE_IF(plan->issues == 0 || *end != '\0', err, LAC_EINPUT,
                     "--issues: \"%s\" must be a number from 1 to %d", words->issues,
                     (int)MOST_ISSUES);
    }
    if (words->levels != NULL) {
        LAC_TRY(lac_levels_read(words->levels, units, &plan->def.levels, err));
    }
    if (words->horizon != NULL) {
        double *horizon = &plan->def.levels.horizon;
        status = lac_units_parse(units, words->horizon, "s", horizon, err);
        if (status != LAC_OK || !(*horizon >= LAC_LEAST_HORIZON)) { // "3" is three seconds
            status = lac_fail(err, LAC_EINPUT,
                              "--horizon: \"%s\" must be a time >= %g s, such as \"7 day\"",
                              words->horizon, LAC_LEAST_HORIZON);
        }
    }
out:
    return status;
}

cli_text cli_watched_time(const lac_forecast_outcome *of, double t)
{
    cli_text text;
    (void)lac_outcome_time(of, t, text.s, sizeof text.s);
    return text;
}

cli_text cli_watched_span(const lac_forecast_outcome *of, double begin, double end)
{
    return cli_format("%s to %s", cli_watched_time(of, begin).s, cli_watched_time(of, end).s);
}
