// SPDX-License-Identifier: GPL-3.0-or-later
// The monitoring series beside a run, and forecasts of the time of failure as they would have been
// issued: of the series where there is one, else of the run.
#include "forecast/hindcast.h"
#include "report/run.h"

enum { MOST_READINGS = 3000 };

// Times of the readings on the run's clock. @return [n] NULL: no memory
static double *readings_of(lac_page *page)
{
    const lac_series *series = page->def->series;
    double *time = lac_page_room(page, series->n * sizeof *time);
    for (size_t i = 0; time != NULL && i < series->n; i++) {
        time[i] = series->time[i] - (series->dated ? page->start : 0.0);
    }
    return time;
}

// Velocities of a series that has none. @return NULL: nothing to derive them from
static lac_motion *derive(lac_page *page, const lac_series *view)
{
    const lac_readings readings = {
        .n = view->n, .time = view->time, .displacement = view->displacement, .sigma = view->sigma};
    const lac_motion_def plain = {.smoothing = LAC_SMOOTH_NONE};
    lac_motion *motion = NULL;
    if (view->velocity == NULL && view->displacement != NULL) {
        (void)lac_page_good(page, lac_motion_create(&plain, &readings, &motion, page->err));
    }
    return motion;
}

// Every `stride`th reading and the last, so that at most about MOST_READINGS stand on the page.
static void write_column(lac_json *json, const char *key, size_t n, const double *value)
{
    const size_t stride = n / MOST_READINGS + 1;
    lac_json_open(json, key, '[');
    for (size_t i = 0; value != NULL && i < n; i++) {
        if (i % stride == 0 || i + 1 == n) {
            lac_json_digits(json, NULL, value[i], 10);
        }
    }
    lac_json_close(json, ']');
}

// What a series is laid beside: the motion of the joint, or of a point of that name.
static lac_history history_of(lac_page *page)
{
    const char *name = page->def->point;
    lac_page_points points = {0};
    if (name == NULL) {
        return (lac_history){.n = page->n,
                             .time = page->time,
                             .slip = lac_page_over_time(page, "slip"),
                             .rate = lac_page_over_time(page, "slip_rate")};
    }
    (void)lac_page_read_points(page, &points);
    size_t k = 0;
    while (k < points.all && strcmp(points.name[k], name) != 0) {
        k++;
    }
    const bool there = k < points.all;
    const double *slip = there ? lac_page_point_column(page, &points, "point_slip", k) : NULL;
    const double *rate = there ? lac_page_point_column(page, &points, "point_slip_rate", k) : NULL;
    if (slip == NULL || rate == NULL) {
        (void)lac_page_good(
            page, lac_fail(page->err, LAC_EINPUT, "%s: has no point \"%s\"", page->def->run, name));
        return (lac_history){0};
    }
    return (lac_history){page->n, page->time, slip, rate};
}

static void write_series(lac_page *page, const lac_series *view, const lac_motion *derived)
{
    const lac_history history = history_of(page);
    lac_json *json = &page->json;
    lac_misfit misfit = {0};
    lac_series_compare(view, &history, &misfit);
    const bool slips = misfit.displacement_count > 0, speeds = misfit.velocity_count > 0;
    lac_json_text(json, "name", page->def->series_name);
    if (page->def->point != NULL) {
        lac_json_text(json, "point", page->def->point);
    }
    lac_json_text(json, "attribution", view->attribution);
    lac_json_integer(json, "readings", (int64_t)view->n);
    write_column(json, "time", view->n, view->time);
    write_column(json, "displacement", view->n, view->displacement);
    lac_json_boolean(json, "derived", derived != NULL);
    lac_json_boolean(json, "falling", derived != NULL && derived->falling);
    const size_t rates = derived != NULL ? derived->velocities : view->n;
    write_column(json, "rate_time", rates, derived != NULL ? derived->velocity_time : view->time);
    write_column(json, "rate", rates, derived != NULL ? derived->velocity : view->velocity);
    lac_json_digits(json, "offset", slips ? misfit.displacement_offset : NAN, 8);
    lac_json_digits(json, "slip_rms", slips ? misfit.displacement_rms : NAN, 4);
    lac_json_integer(json, "slip_readings", (int64_t)misfit.displacement_count);
    lac_json_digits(json, "rate_rms_log10", speeds ? misfit.log_rate_rms : NAN, 4);
    lac_json_integer(json, "rate_readings", (int64_t)misfit.velocity_count);
    lac_json_integer(json, "outside", (int64_t)misfit.outside);
}

void lac_page_series(lac_page *page, const char *key)
{
    const lac_series *series = page->def->series;
    if (series != NULL && series->dated && !page->dated) {
        (void)lac_page_good(page, lac_fail(page->err, LAC_EINPUT,
                                           "%s: has dates, and the run %s has none",
                                           page->def->series_name, page->def->run));
    } else if (series != NULL) {
        lac_series view = *series;
        view.time = readings_of(page);
        lac_motion *derived = view.time != NULL ? derive(page, &view) : NULL;
        if (page->status == LAC_OK) {
            lac_json_open(&page->json, key, '{');
            write_series(page, &view, derived);
            lac_json_close(&page->json, '}');
        }
        lac_motion_free(derived);
    }
}

enum { ISSUES = 24, BUCKETS = 24, FEWEST = 6 };

// Records of a run as far as a double tells their times apart, thinned: a run has far more than a
// method of forecasting needs.
static lac_readings see_run(lac_page *page)
{
    const double *slip = lac_page_over_time(page, "slip");
    const double *rate = lac_page_over_time(page, "slip_rate");
    uint8_t *keep = lac_page_room(page, page->n);
    double *time = lac_page_room(page, 3 * page->n * sizeof *time);
    if (keep == NULL || time == NULL) {
        return (lac_readings){0};
    }
    double *displacement = time + page->n, *velocity = displacement + page->n;
    (void)lac_page_thin(page->n, page->time, page->before, BUCKETS, 0, NULL, keep);
    size_t n = 0;
    for (size_t i = 0; i < page->n; i++) {
        if (keep[i] && isfinite(page->time[i]) && (n == 0 || page->time[i] > time[n - 1])) {
            time[n] = page->time[i];
            displacement[n] = slip[i];
            velocity[n++] = rate[i];
        }
    }
    return (lac_readings){.n = n, .time = time, .displacement = displacement, .velocity = velocity};
}

// Times of failure count from the time of issue: what remains is told to the last digit.
static void write_forecast(lac_json *json, const lac_forecast *f)
{
    const double after[] = {f->time, f->low90, f->low50, f->high50, f->high90};
    lac_json_open(json, NULL, '[');
    lac_json_boolean(json, NULL, f->issued);
    for (size_t i = 0; i < sizeof after / sizeof *after; i++) {
        lac_json_digits(json, NULL, after[i] - f->issue_time, 6);
    }
    lac_json_text(json, NULL, f->issued ? "" : f->fit.reason);
    lac_json_open(json, NULL, '[');
    for (size_t i = 0; i < f->fit.ends; i++) {
        lac_json_text(json, NULL, f->fit.end[i]);
    }
    lac_json_close(json, ']');
    lac_json_close(json, ']');
}

static void write_rolling(lac_page *page, const lac_rolling *rolling)
{
    lac_json *json = &page->json;
    lac_json_open(json, "methods", '[');
    for (size_t m = 0; m < rolling->methods; m++) {
        lac_page_method(page, rolling->forecast[m].kind->info.name, rolling->forecast[m].kind);
    }
    lac_json_close(json, ']');
    lac_page_column(page, "issue", rolling->issues, rolling->issue_time, NULL, 17);
    lac_json_open(json, "forecast", '[');
    for (size_t i = 0; i < rolling->issues; i++) {
        lac_json_open(json, NULL, '[');
        for (size_t m = 0; m < rolling->methods; m++) {
            write_forecast(json, &rolling->forecast[i * rolling->methods + m]);
        }
        lac_json_close(json, ']');
    }
    lac_json_close(json, ']');
}

// @return whether any method but the baseline issued one
static bool forecast(lac_page *page, const char *key, bool measured)
{
    lac_forecast_def def = lac_forecast_default();
    lac_rolling *rolling = NULL;
    lac_readings readings = measured ? lac_series_readings(page->def->series) : see_run(page);
    readings.time = measured ? readings_of(page) : readings.time;
    if (page->status != LAC_OK || readings.n < FEWEST) {
        return false;
    }
    def.motion.raw = !measured; // a run has neither outliers nor resets
    const size_t issues = page->def->issues > 0 ? (size_t)page->def->issues : ISSUES;
    const bool made =
        lac_page_good(page, lac_rolling_create(&def, &readings, issues, NULL, &rolling, page->err));
    bool issued = false;
    for (size_t i = 0; made && i < rolling->issues * rolling->methods; i++) {
        const lac_forecast *f = &rolling->forecast[i];
        issued = issued || (f->issued && !f->kind->baseline);
    }
    if (issued) {
        lac_json_open(&page->json, key, '{');
        lac_json_boolean(&page->json, "measured", measured);
        lac_json_integer(&page->json, "readings", (int64_t)readings.n);
        write_rolling(page, rolling);
        lac_json_close(&page->json, '}');
    }
    lac_rolling_free(rolling);
    return issued;
}

void lac_page_forecasts(lac_page *page, const char *key)
{
    if (page->def->issues >= 0 && !(page->def->series != NULL && forecast(page, key, true))) {
        (void)forecast(page, key, false);
    }
}
