// SPDX-License-Identifier: GPL-3.0-or-later
// What `lacuna precursors` found, as JSON: times in seconds and, where known, as dates.
#include <math.h>

#include "base/date.h"
#include "cli/indicators.h"

static void write_time(cli_json *json, const cli_precursors_result *r, const char *key,
                       const char *date_key, double t)
{
    char date[32];
    cli_json_number(json, key, t);
    const char *text =
        r->watched->dated && isfinite(t) ? lac_date_format(t, date, sizeof date) : "";
    cli_json_text(json, date_key, text[0] != '\0' ? text : NULL);
}

static void write_interval(cli_json *json, const char *key, double low, double high)
{
    if (isnan(low) || isnan(high)) {
        cli_json_null(json, key);
        return;
    }
    cli_json_open(json, key, '[');
    cli_json_number(json, NULL, low);
    cli_json_number(json, NULL, high);
    cli_json_close(json, ']');
}

static void write_forecast(cli_json *json, const cli_precursors_result *r, const lac_forecast *f)
{
    const lac_finding *fit = &f->fit;
    cli_json_open(json, NULL, '{');
    cli_json_text(json, "method", f->kind->about.name);
    write_time(json, r, "tc_s", "tc_date", f->time);
    write_interval(json, "interval50_s", f->low50, f->high50);
    write_interval(json, "interval90_s", f->low90, f->high90);
    if (fit->posterior) {
        cli_json_open(json, "posterior_s", '[');
        for (size_t q = 0; q < LAC_FORECAST_LEVELS; q++) {
            cli_json_number(json, NULL, f->issue_time + exp(fit->quantile[q]));
        }
        cli_json_close(json, ']');
    } else {
        cli_json_null(json, "posterior_s");
    }
    cli_json_boolean(json, "issued", f->issued);
    cli_json_text(json, "reason", f->issued ? NULL : fit->reason);
    cli_json_number(json, "rms", fit->rms);
    cli_json_text(json, "rms_unit", fit->rms_unit);
    cli_json_number(json, "misfit", fit->misfit);
    cli_json_number(json, "relative_error", fit->error);
    cli_json_integer(json, "points", (int64_t)fit->points);
    cli_json_open(json, "parameters", '{');
    for (size_t i = 0; i < fit->count; i++) {
        cli_json_number(json, fit->value[i].key, fit->value[i].value);
    }
    cli_json_close(json, '}');
    cli_json_open(json, "at_end_of_range", '[');
    for (size_t i = 0; i < fit->ends; i++) {
        cli_json_text(json, NULL, fit->end[i]);
    }
    cli_json_close(json, ']');
    cli_json_close(json, '}');
}

static void write_forecasts(cli_json *json, const cli_precursors_result *r, size_t count,
                            const lac_forecast *forecast)
{
    cli_json_open(json, "forecasts", '[');
    for (size_t k = 0; k < count; k++) {
        write_forecast(json, r, &forecast[k]);
    }
    cli_json_close(json, ']');
}

static void write_series(cli_json *json, const cli_precursors_result *r)
{
    const lac_readings *in = &r->watched->readings;
    const lac_motion *m = r->outlook->motion;
    const lac_series *s = r->watched->series;
    cli_json_open(json, "series", '{');
    cli_json_text(json, "path", r->watched->path);
    cli_json_text(json, "kind", r->watched->run ? "run" : "series");
    cli_json_integer(json, "readings", (int64_t)in->n);
    write_time(json, r, "first_s", "first_date", in->time[0]);
    write_time(json, r, "last_s", "last_date", in->time[in->n - 1]);
    cli_json_integer(json, "missing", s != NULL ? (int64_t)s->missing : 0);
    cli_json_integer(json, "duplicates", s != NULL ? (int64_t)s->duplicates : 0);
    cli_json_integer(json, "conflicts", s != NULL ? (int64_t)s->conflicts : 0);
    cli_json_integer(json, "disordered", s != NULL ? (int64_t)s->disordered : 0);
    cli_json_integer(json, "gaps", (int64_t)m->gaps);
    cli_json_number(json, "median_interval_s", m->interval);
    cli_json_number(json, "longest_interval_s", m->longest_gap);
    cli_json_integer(json, "outliers", (int64_t)m->outliers);
    cli_json_integer(json, "resets", (int64_t)m->resets);
    cli_json_integer(json, "resets_disbelieved", (int64_t)m->disbelieved);
    cli_json_boolean(json, "falling", m->falling);
    cli_json_number(json, "noise_m", m->noise);
    cli_json_number(json, "resolution_m", m->integrated ? NAN : m->resolution);
    cli_json_integer(json, "velocities", (int64_t)m->velocities);
    cli_json_boolean(json, "integrated", m->integrated);
    cli_json_text(json, "attribution", s != NULL ? s->attribution : NULL);
    cli_series_warnings(json, s);
    cli_json_close(json, '}');
}

static void write_skill(cli_json *json, const lac_skill *s)
{
    cli_json_open(json, NULL, '{');
    cli_json_text(json, "method", s->kind->about.name);
    cli_json_integer(json, "asked", (int64_t)s->asked);
    cli_json_integer(json, "issued", (int64_t)s->issued);
    cli_json_number(json, "median_error_s", s->error);
    cli_json_integer(json, "inside50", (int64_t)s->inside50);
    cli_json_integer(json, "inside90", (int64_t)s->inside90);
    cli_json_number(json, "crps_s", s->crps);
    cli_json_number(json, "persistence_crps_s", s->persistence_crps);
    cli_json_integer(json, "alarms", (int64_t)s->alarms);
    cli_json_integer(json, "hits", (int64_t)s->hits);
    cli_json_integer(json, "false_alarms", (int64_t)s->false_alarms);
    cli_json_integer(json, "misses", (int64_t)s->misses);
    cli_json_open(json, "lead", '[');
    for (size_t i = 0; i < LAC_LEADS; i++) {
        cli_json_open(json, NULL, '{');
        cli_json_integer(json, "issued", (int64_t)s->lead_count[i]);
        cli_json_number(json, "median_error_s", s->lead_error[i]);
        cli_json_number(json, "median_remaining_over_true", s->lead_bias[i]);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
    cli_json_close(json, '}');
}

static void write_rolling(cli_json *json, const cli_precursors_result *r)
{
    const lac_rolling *roll = r->rolling;
    cli_json_open(json, "rolling", '{');
    cli_json_number(json, "horizon_s", r->plan->horizon);
    write_time(json, r, "failed_at_s", "failed_at_date", r->watched->failed_at);
    cli_json_open(json, "issues", '[');
    for (size_t i = 0; i < roll->issues; i++) {
        const lac_forecast *f = &roll->forecast[i * roll->methods];
        cli_json_open(json, NULL, '{');
        write_time(json, r, "issue_time_s", "issue_date", roll->issue_time[i]);
        write_time(json, r, "window_start_s", "window_start_date", f->window_start);
        write_forecasts(json, r, roll->methods, f);
        cli_indicators_json(json, r->course->kinds, &r->course->found[i * r->course->kinds]);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
    if (r->skill != NULL) {
        cli_json_open(json, "skill", '[');
        for (size_t k = 0; k < roll->methods; k++) {
            write_skill(json, &r->skill[k]);
        }
        cli_json_close(json, ']');
    } else {
        cli_json_null(json, "skill");
    }
    cli_json_close(json, '}');
}

void cli_precursors_json(const cli_precursors_result *r)
{
    const lac_outlook *o = r->outlook;
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    write_series(&json, r);
    write_time(&json, r, "issue_time_s", "issue_date", o->issue_time);
    write_time(&json, r, "window_start_s", "window_start_date", o->asked ? o->window_start : NAN);
    cli_json_boolean(&json, "accelerating", o->accelerating);
    write_forecasts(&json, r, o->count, o->forecast);
    cli_indicators_json(&json, r->indicators, r->indicator);
    if (r->rolling != NULL) {
        write_rolling(&json, r);
    }
    cli_json_text(&json, "output", r->output);
    cli_json_close(&json, '}');
}
