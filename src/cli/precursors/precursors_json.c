// SPDX-License-Identifier: GPL-3.0-or-later
// What `lacuna precursors` found, as JSON: times in seconds and, where known, as dates.
#include <math.h>

#include "base/date.h"
#include "cli/precursors/precursors.h"

static void write_time(lac_json *json, const cli_precursors_result *r, const char *key,
                       const char *date_key, double t)
{
    char date[32];
    lac_json_number(json, key, t);
    const char *text =
        r->watched->dated && isfinite(t) ? lac_date_format(t, date, sizeof date) : "";
    lac_json_text(json, date_key, text[0] != '\0' ? text : NULL);
}

static void write_interval(lac_json *json, const char *key, double low, double high)
{
    if (isnan(low) || isnan(high)) {
        lac_json_null(json, key);
        return;
    }
    lac_json_open(json, key, '[');
    lac_json_number(json, NULL, low);
    lac_json_number(json, NULL, high);
    lac_json_close(json, ']');
}

static void write_forecast(lac_json *json, const cli_precursors_result *r, const lac_forecast *f)
{
    const lac_finding *fit = &f->fit;
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "method", f->kind->about.name);
    write_time(json, r, "tc_s", "tc_date", f->time);
    write_interval(json, "interval50_s", f->low50, f->high50);
    write_interval(json, "interval90_s", f->low90, f->high90);
    if (fit->posterior) {
        lac_json_open(json, "posterior_s", '[');
        for (size_t q = 0; q < LAC_FORECAST_LEVELS; q++) {
            lac_json_number(json, NULL, f->issue_time + exp(fit->quantile[q]));
        }
        lac_json_close(json, ']');
    } else {
        lac_json_null(json, "posterior_s");
    }
    lac_json_boolean(json, "issued", f->issued);
    lac_json_text(json, "reason", f->issued ? NULL : fit->reason);
    lac_json_number(json, "rms", fit->rms);
    lac_json_text(json, "rms_unit", fit->rms_unit);
    lac_json_number(json, "misfit", fit->misfit);
    lac_json_number(json, "relative_error", fit->error);
    lac_json_integer(json, "points", (int64_t)fit->points);
    lac_json_open(json, "parameters", '{');
    for (size_t i = 0; i < fit->count; i++) {
        lac_json_number(json, fit->value[i].key, fit->value[i].value);
    }
    lac_json_close(json, '}');
    lac_json_open(json, "at_end_of_range", '[');
    for (size_t i = 0; i < fit->ends; i++) {
        lac_json_text(json, NULL, fit->end[i]);
    }
    lac_json_close(json, ']');
    lac_json_close(json, '}');
}

static void write_forecasts(lac_json *json, const cli_precursors_result *r, size_t count,
                            const lac_forecast *forecast)
{
    lac_json_open(json, "forecasts", '[');
    for (size_t k = 0; k < count; k++) {
        write_forecast(json, r, &forecast[k]);
    }
    lac_json_close(json, ']');
}

static void write_series(lac_json *json, const cli_precursors_result *r)
{
    const lac_readings *in = &r->watched->readings;
    const lac_motion *m = r->outlook->motion;
    const lac_series *s = r->watched->series;
    lac_json_open(json, "series", '{');
    lac_json_text(json, "path", r->watched->path);
    lac_json_text(json, "kind", r->watched->run ? "run" : "series");
    lac_json_integer(json, "readings", (int64_t)in->n);
    write_time(json, r, "first_s", "first_date", in->time[0]);
    write_time(json, r, "last_s", "last_date", in->time[in->n - 1]);
    lac_json_integer(json, "missing", s != NULL ? (int64_t)s->missing : 0);
    lac_json_integer(json, "duplicates", s != NULL ? (int64_t)s->duplicates : 0);
    lac_json_integer(json, "conflicts", s != NULL ? (int64_t)s->conflicts : 0);
    lac_json_integer(json, "disordered", s != NULL ? (int64_t)s->disordered : 0);
    lac_json_integer(json, "gaps", (int64_t)m->gaps);
    lac_json_number(json, "median_interval_s", m->interval);
    lac_json_number(json, "longest_interval_s", m->longest_gap);
    lac_json_integer(json, "outliers", (int64_t)m->outliers);
    lac_json_integer(json, "resets", (int64_t)m->resets);
    lac_json_integer(json, "resets_disbelieved", (int64_t)m->disbelieved);
    lac_json_boolean(json, "falling", m->falling);
    lac_json_number(json, "noise_m", m->noise);
    lac_json_number(json, "resolution_m", m->integrated ? NAN : m->resolution);
    lac_json_integer(json, "velocities", (int64_t)m->velocities);
    lac_json_boolean(json, "integrated", m->integrated);
    lac_json_text(json, "attribution", s != NULL ? s->attribution : NULL);
    cli_series_warnings(json, s);
    lac_json_close(json, '}');
}

static void write_skill(lac_json *json, const lac_skill *s)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "method", s->kind->about.name);
    lac_json_integer(json, "asked", (int64_t)s->asked);
    lac_json_integer(json, "issued", (int64_t)s->issued);
    lac_json_number(json, "median_error_s", s->error);
    lac_json_integer(json, "inside50", (int64_t)s->inside50);
    lac_json_integer(json, "inside90", (int64_t)s->inside90);
    lac_json_number(json, "crps_s", s->crps);
    lac_json_number(json, "persistence_crps_s", s->persistence_crps);
    lac_json_integer(json, "alarms", (int64_t)s->alarms);
    lac_json_integer(json, "hits", (int64_t)s->hits);
    lac_json_integer(json, "false_alarms", (int64_t)s->false_alarms);
    lac_json_integer(json, "misses", (int64_t)s->misses);
    lac_json_open(json, "lead", '[');
    for (size_t i = 0; i < LAC_LEADS; i++) {
        lac_json_open(json, NULL, '{');
        lac_json_integer(json, "issued", (int64_t)s->lead_count[i]);
        lac_json_number(json, "median_error_s", s->lead_error[i]);
        lac_json_number(json, "median_remaining_over_true", s->lead_bias[i]);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
    lac_json_close(json, '}');
}

static void write_rolling(lac_json *json, const cli_precursors_result *r)
{
    const lac_rolling *roll = r->rolling;
    lac_json_open(json, "rolling", '{');
    lac_json_number(json, "horizon_s", r->plan->horizon);
    write_time(json, r, "failed_at_s", "failed_at_date", r->watched->failed_at);
    lac_json_open(json, "issues", '[');
    for (size_t i = 0; i < roll->issues; i++) {
        const lac_forecast *f = &roll->forecast[i * roll->methods];
        lac_json_open(json, NULL, '{');
        write_time(json, r, "issue_time_s", "issue_date", roll->issue_time[i]);
        write_time(json, r, "window_start_s", "window_start_date", f->window_start);
        write_forecasts(json, r, roll->methods, f);
        cli_indicators_json(json, r->course->kinds, &r->course->found[i * r->course->kinds]);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
    if (r->skill != NULL) {
        lac_json_open(json, "skill", '[');
        for (size_t k = 0; k < roll->methods; k++) {
            write_skill(json, &r->skill[k]);
        }
        lac_json_close(json, ']');
    } else {
        lac_json_null(json, "skill");
    }
    lac_json_close(json, '}');
}

void cli_precursors_json(const cli_precursors_result *r)
{
    const lac_outlook *o = r->outlook;
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    write_series(&json, r);
    write_time(&json, r, "issue_time_s", "issue_date", o->issue_time);
    write_time(&json, r, "window_start_s", "window_start_date", o->asked ? o->window_start : NAN);
    lac_json_boolean(&json, "accelerating", o->accelerating);
    write_forecasts(&json, r, o->count, o->forecast);
    cli_indicators_json(&json, r->indicators, r->indicator);
    if (r->rolling != NULL) {
        write_rolling(&json, r);
    }
    lac_json_text(&json, "output", r->output);
    lac_json_close(&json, '}');
}
