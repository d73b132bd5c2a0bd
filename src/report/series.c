// SPDX-License-Identifier: GPL-3.0-or-later
// The monitoring series beside a run.
#include <math.h>

#include "report/run.h"
#include "series/motion.h"

enum { MOST_READINGS = 3000 };

double *lac_page_readings(lac_page *page)
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

static void write_misfit(lac_json *json, const lac_misfit *misfit)
{
    const bool slips = misfit->displacement_count > 0, rates = misfit->velocity_count > 0;
    lac_json_digits(json, "offset", slips ? misfit->displacement_offset : NAN, 8);
    lac_json_digits(json, "slip_rms", slips ? misfit->displacement_rms : NAN, 4);
    lac_json_integer(json, "slip_readings", (int64_t)misfit->displacement_count);
    lac_json_digits(json, "rate_rms_log10", rates ? misfit->log_rate_rms : NAN, 4);
    lac_json_integer(json, "rate_readings", (int64_t)misfit->velocity_count);
    lac_json_integer(json, "outside", (int64_t)misfit->outside);
}

// Readings on the run's clock.
static void write_series(lac_page *page, const lac_series *view, const lac_motion *derived)
{
    const lac_history history = {.n = page->n,
                                 .time = page->time,
                                 .slip = lac_page_over_time(page, "slip"),
                                 .rate = lac_page_over_time(page, "slip_rate")};
    lac_json *json = &page->json;
    lac_misfit misfit = {0};
    lac_series_compare(view, &history, &misfit);
    lac_json_text(json, "name", page->def->series_name);
    lac_json_text(json, "attribution", view->attribution);
    lac_json_integer(json, "readings", (int64_t)view->n);
    write_column(json, "time", view->n, view->time);
    write_column(json, "displacement", view->n, view->displacement);
    lac_json_boolean(json, "derived", derived != NULL);
    lac_json_boolean(json, "falling", derived != NULL && derived->falling);
    const size_t rates = derived != NULL ? derived->velocities : view->n;
    write_column(json, "rate_time", rates, derived != NULL ? derived->velocity_time : view->time);
    write_column(json, "rate", rates, derived != NULL ? derived->velocity : view->velocity);
    write_misfit(json, &misfit);
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
        view.time = lac_page_readings(page);
        lac_motion *derived = view.time != NULL ? derive(page, &view) : NULL;
        if (page->status == LAC_OK) {
            lac_json_open(&page->json, key, '{');
            write_series(page, &view, derived);
            lac_json_close(&page->json, '}');
        }
        lac_motion_free(derived);
    }
}
