// SPDX-License-Identifier: GPL-3.0-or-later
// Forecasts of the time of failure as they would have been issued: of the monitoring series where
// there is one, else of the run.
#include <math.h>
#include <stdlib.h>

#include "forecast/hindcast.h"
#include "report/run.h"

enum { ISSUES = 40, BUCKETS = 40, FEWEST = 6 };

// What the forecasts saw.
typedef struct sight {
    double *owned[3]; // time, displacement, velocity
    lac_readings readings;
} sight;

static void clear(sight *s)
{
    for (size_t i = 0; i < 3; i++) {
        free(s->owned[i]);
    }
}

static lac_status make_room(sight *s, size_t n, lac_error *err)
{
    for (size_t i = 0; i < 3; i++) {
        s->owned[i] = malloc(n * sizeof(double));
        if (s->owned[i] == NULL) {
            return lac_fail_memory(err);
        }
    }
    s->readings.time = s->owned[0];
    return LAC_OK;
}

// Records of a run as far as a double tells their times apart, thinned: a run has far more than a
// method of forecasting needs.
static lac_status see_run(const lac_page_run *run, sight *s, lac_error *err)
{
    const double *slip = lac_page_run_column(run, LAC_PAGE_SLIP);
    const double *rate = lac_page_run_column(run, LAC_PAGE_RATE);
    uint8_t *keep = malloc(run->n);
    lac_status status = keep != NULL ? make_room(s, run->n, err) : lac_fail_memory(err);
    LAC_TRY(status);
    (void)lac_page_thin(run->n, run->time, run->before, BUCKETS, 0, NULL, keep);
    size_t n = 0;
    for (size_t i = 0; i < run->n; i++) {
        if (keep[i] && isfinite(run->time[i]) && (n == 0 || run->time[i] > s->owned[0][n - 1])) {
            s->owned[0][n] = run->time[i];
            s->owned[1][n] = slip[i];
            s->owned[2][n++] = rate[i];
        }
    }
    s->readings.n = n;
    s->readings.displacement = s->owned[1];
    s->readings.velocity = s->owned[2];
out:
    free(keep);
    return status;
}

static lac_status see_series(const lac_page *page, sight *s, lac_error *err)
{
    const lac_series *series = page->def->series;
    const lac_status status = make_room(s, series->n > 0 ? series->n : 1, err);
    for (size_t i = 0; status == LAC_OK && i < series->n; i++) {
        s->owned[0][i] = series->time[i] - (series->dated ? page->run->start : 0.0);
    }
    s->readings.n = series->n;
    s->readings.displacement = series->displacement;
    s->readings.velocity = series->velocity;
    s->readings.sigma = series->sigma;
    s->readings.displacement_digit = series->displacement_digit;
    s->readings.velocity_digit = series->velocity_digit;
    return status;
}

// Times of failure count from the time of issue: what remains is told to the last digit.
static void write_forecast(lac_page_text *text, const lac_forecast *f)
{
    const double from = f->issue_time;
    lac_page_open(text, NULL, '[');
    lac_page_bool(text, NULL, f->issued);
    lac_page_number(text, NULL, f->time - from, 6);
    lac_page_number(text, NULL, f->low90 - from, 6);
    lac_page_number(text, NULL, f->low50 - from, 6);
    lac_page_number(text, NULL, f->high50 - from, 6);
    lac_page_number(text, NULL, f->high90 - from, 6);
    lac_page_string(text, NULL, f->issued ? "" : f->fit.reason);
    lac_page_open(text, NULL, '[');
    for (size_t i = 0; i < f->fit.ends; i++) {
        lac_page_string(text, NULL, f->fit.end[i]);
    }
    lac_page_close(text, ']');
    lac_page_close(text, ']');
}

static void write_methods(lac_page_text *text, const lac_rolling *rolling)
{
    lac_page_open(text, "methods", '[');
    for (size_t m = 0; m < rolling->methods; m++) {
        const lac_forecast_kind *kind = rolling->forecast[m].kind;
        lac_page_open(text, NULL, '{');
        lac_page_string(text, "name", kind->about.name);
        lac_page_string(text, "summary", kind->about.summary);
        lac_page_string(text, "reference", kind->about.reference);
        lac_page_bool(text, "baseline", kind->baseline);
        lac_page_close(text, '}');
    }
    lac_page_close(text, ']');
}

static void write_rolling(lac_page_text *text, const lac_rolling *rolling)
{
    write_methods(text, rolling);
    lac_page_column(text, "issue", rolling->issues, rolling->issue_time, NULL, 17);
    lac_page_open(text, "forecast", '[');
    for (size_t i = 0; i < rolling->issues; i++) {
        lac_page_open(text, NULL, '[');
        for (size_t m = 0; m < rolling->methods; m++) {
            write_forecast(text, &rolling->forecast[i * rolling->methods + m]);
        }
        lac_page_close(text, ']');
    }
    lac_page_close(text, ']');
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

static lac_status forecast(const lac_page *page, bool measured, bool *issued, lac_error *err)
{
    lac_forecast_def def = lac_forecast_default();
    lac_rolling *rolling = NULL;
    sight s = {0};
    lac_status status = measured ? see_series(page, &s, err) : see_run(page->run, &s, err);
    LAC_TRY(status);
    if (s.readings.n < FEWEST) {
        goto out;
    }
    def.motion.raw = !measured; // a run has neither outliers nor resets
    const size_t issues = page->def->issues > 0 ? (size_t)page->def->issues : ISSUES;
    LAC_TRY(lac_rolling_create(&def, &s.readings, issues, NULL, &rolling, err));
    *issued = any_issued(rolling);
    if (*issued) {
        lac_page_open(page->text, "forecasts", '{');
        lac_page_bool(page->text, "measured", measured);
        lac_page_number(page->text, "readings", (double)s.readings.n, 17);
        write_rolling(page->text, rolling);
        lac_page_close(page->text, '}');
    }
out:
    lac_rolling_free(rolling);
    clear(&s);
    return status;
}

lac_status lac_page_forecasts(const lac_page *page, lac_error *err)
{
    bool issued = false;
    lac_status status = LAC_OK;
    if (page->def->issues < 0) {
        return LAC_OK;
    }
    if (page->def->series != NULL) {
        status = forecast(page, true, &issued, err);
    }
    return status == LAC_OK && !issued ? forecast(page, false, &issued, err) : status;
}
