// SPDX-License-Identifier: GPL-3.0-or-later
// Forecasts of the time of failure as they would have been issued: of the monitoring series where
// there is one, else of the run.
#include <math.h>
#include <stdlib.h>

#include "forecast/hindcast.h"
#include "report/run.h"

enum { ISSUES = 40, BUCKETS = 40, FEWEST = 6 };

// Records of a run as far as a double tells their times apart, thinned: a run has far more than a
// method of forecasting needs.
static lac_status see_run(const lac_page_run *run, double **owned, lac_readings *out,
                          lac_error *err)
{
    const double *slip = lac_page_run_column(run, "slip");
    const double *rate = lac_page_run_column(run, "slip_rate");
    uint8_t *keep = malloc(run->n);
    double *time = *owned = malloc(3 * run->n * sizeof *time);
    lac_status status = keep != NULL && time != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    double *displacement = time + run->n, *velocity = displacement + run->n;
    (void)lac_page_thin(run->n, run->time, run->before, BUCKETS, 0, NULL, keep);
    size_t n = 0;
    for (size_t i = 0; i < run->n; i++) {
        if (keep[i] && isfinite(run->time[i]) && (n == 0 || run->time[i] > time[n - 1])) {
            time[n] = run->time[i];
            displacement[n] = slip[i];
            velocity[n++] = rate[i];
        }
    }
    *out = (lac_readings){.n = n, .time = time, .displacement = displacement, .velocity = velocity};
out:
    free(keep);
    return status;
}

static lac_status see_series(const lac_page *page, double **time, lac_readings *out, lac_error *err)
{
    const lac_series *series = page->def->series;
    const lac_status status = lac_page_readings(page, time, err);
    *out = lac_series_readings(series);
    out->time = *time;
    return status;
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

static void write_rolling(const lac_page *page, const lac_rolling *rolling)
{
    lac_json *json = page->json;
    lac_json_open(json, "methods", '[');
    for (size_t m = 0; m < rolling->methods; m++) {
        const lac_forecast_kind *kind = rolling->forecast[m].kind;
        lac_json_open(json, NULL, '{');
        lac_json_text(json, "name", kind->info.name);
        lac_json_text(json, "summary", kind->info.summary);
        lac_json_text(json, "reference", kind->info.reference);
        lac_json_boolean(json, "baseline", kind->baseline);
        lac_json_close(json, '}');
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

// Whether any method but the baseline issued a forecast.
static bool any_issued(const lac_rolling *rolling)
{
    for (size_t i = 0; i < rolling->issues * rolling->methods; i++) {
        if (rolling->forecast[i].issued && !rolling->forecast[i].kind->baseline) {
            return true;
        }
    }
    return false;
}

static lac_status forecast(const lac_page *page, const char *key, bool measured, bool *issued,
                           lac_error *err)
{
    lac_forecast_def def = lac_forecast_default();
    lac_rolling *rolling = NULL;
    lac_readings readings;
    double *owned = NULL;
    lac_status status = measured ? see_series(page, &owned, &readings, err)
                                 : see_run(page->run, &owned, &readings, err);
    LAC_TRY(status);
    if (readings.n < FEWEST) {
        goto out;
    }
    def.motion.raw = !measured; // a run has neither outliers nor resets
    const size_t issues = page->def->issues > 0 ? (size_t)page->def->issues : ISSUES;
    LAC_TRY(lac_rolling_create(&def, &readings, issues, NULL, &rolling, err));
    *issued = any_issued(rolling);
    if (*issued) {
        lac_json_open(page->json, key, '{');
        lac_json_boolean(page->json, "measured", measured);
        lac_json_integer(page->json, "readings", (int64_t)readings.n);
        write_rolling(page, rolling);
        lac_json_close(page->json, '}');
    }
out:
    lac_rolling_free(rolling);
    free(owned);
    return status;
}

lac_status lac_page_forecasts(const lac_page *page, const char *key, lac_error *err)
{
    bool issued = false;
    lac_status status = LAC_OK;
    if (page->def->issues >= 0 && page->def->series != NULL) {
        LAC_TRY(forecast(page, key, true, &issued, err));
    }
    if (page->def->issues >= 0 && !issued) {
        LAC_TRY(forecast(page, key, false, &issued, err));
    }
out:
    return status;
}
