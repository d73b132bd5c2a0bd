// SPDX-License-Identifier: GPL-3.0-or-later
// The monitoring series beside a run.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/run.h"
#include "series/motion.h"

enum { MOST_READINGS = 3000 };

lac_status lac_page_readings(const lac_page *page, double **time, lac_error *err)
{
    const lac_series *series = page->def->series;
    *time = malloc((series->n + 1) * sizeof **time);
    LAC_FAIL_MEMORY_IF(*time == NULL, err);
    for (size_t i = 0; i < series->n; i++) {
        (*time)[i] = series->time[i] - (series->dated ? page->run->start : 0.0);
    }
    return LAC_OK;
}

// Readings on the run's clock and the run on the same, seconds since its start.
typedef struct beside {
    lac_series view; // times are owned, the rest is the series'
    lac_misfit misfit;
    lac_motion *motion; // NULL: nothing to derive velocities from
} beside;

static lac_status lay(const lac_page *page, beside *b, lac_error *err)
{
    const lac_page_run *run = page->run;
    const lac_history history = {.n = run->n,
                                 .time = run->time,
                                 .slip = lac_page_run_column(run, "slip"),
                                 .rate = lac_page_run_column(run, "slip_rate")};
    b->view = *page->def->series;
    const lac_status status = lac_page_readings(page, &b->view.time, err);
    if (status != LAC_OK) {
        return status;
    }
    lac_series_compare(&b->view, &history, &b->misfit);
    if (b->view.velocity == NULL && b->view.displacement != NULL) {
        const lac_readings readings = {.n = b->view.n,
                                       .time = b->view.time,
                                       .displacement = b->view.displacement,
                                       .sigma = b->view.sigma};
        const lac_motion_def plain = {.smoothing = LAC_SMOOTH_NONE};
        return lac_motion_create(&plain, &readings, &b->motion, err);
    }
    return LAC_OK;
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

static void write_series(const lac_page *page, const char *key, const beside *b)
{
    lac_json *json = page->json;
    const bool derived = b->motion != NULL;
    lac_json_open(json, key, '{');
    lac_json_text(json, "name", page->def->series_name);
    lac_json_text(json, "attribution", b->view.attribution);
    lac_json_integer(json, "readings", (int64_t)b->view.n);
    write_column(json, "time", b->view.n, b->view.time);
    write_column(json, "displacement", b->view.n, b->view.displacement);
    lac_json_boolean(json, "derived", derived);
    lac_json_boolean(json, "falling", derived && b->motion->falling);
    if (derived) {
        write_column(json, "rate_time", b->motion->velocities, b->motion->velocity_time);
        write_column(json, "rate", b->motion->velocities, b->motion->velocity);
    } else {
        write_column(json, "rate_time", b->view.n, b->view.time);
        write_column(json, "rate", b->view.n, b->view.velocity);
    }
    write_misfit(json, &b->misfit);
    lac_json_close(json, '}');
}

lac_status lac_page_series(const lac_page *page, const char *key, lac_error *err)
{
    beside b = {0};
    lac_status status = LAC_OK;
    if (page->def->series == NULL) {
        return LAC_OK;
    }
    LAC_FAIL_IF(page->def->series->dated && !page->run->dated, err, LAC_EINPUT,
                "%s: has dates, and the run %s has none", page->def->series_name, page->def->run);
    LAC_TRY(lay(page, &b, err));
    write_series(page, key, &b);
out:
    lac_motion_free(b.motion);
    free(b.view.time);
    return status;
}
