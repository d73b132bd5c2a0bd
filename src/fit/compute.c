// SPDX-License-Identifier: GPL-3.0-or-later
// A case and a series to the dataset of a fit, and a series to that of its forecasts and
// indicators, in one call each.
#include "base/ask.h"
#include "case/levels.h"
#include "fit/model_forecast.h"
#include "lacuna/forecast.h"
#include "precursor/precursor.h"

// What a dataset is of, which it keeps.
typedef struct fit_made {
    lac_fit *fit;
    lac_fit_result result;
    lac_fit_outcome outcome;
    lac_made_from made;
} fit_made;

static void fit_made_free(void *result)
{
    fit_made *f = result;
    lac_fit_free(f->fit);
    free(f->made.case_text);
    free(f);
}

lac_status lac_fit_series(const lac_case *c, const char *path, lac_series **out, lac_error *err)
{
    LAC_TRY_RETURN(LAC_NEED(err, c, path, out));
    *out = NULL;
    LAC_TRY_RETURN(lac_case_serves(c, LAC_FOR_FIT, err));
    lac_series_def def = c->fit.columns;
    def.size = sizeof def;
    def.path = path;
    def.value_si = def.value != NULL ? "1" : "m";
    if (def.value == NULL) {
        def.value = def.sigma;
        def.value_unit = def.sigma_unit;
    }
    def.sigma = def.sigma_unit = NULL;
    return lac_series_create(&def, out, err);
}

// What was computed is handed out whole, also where it was interrupted.
static lac_status hand_out(fit_made *f, lac_status computed, lac_dataset **out, lac_error *err)
{
    LAC_TRY_RETURN(lac_fit_describe(&f->outcome, out, err));
    lac_dataset_keep(*out, f, fit_made_free, &f->made.provenance);
    return computed == LAC_OK ? lac_fit_trust(&f->result, err) : computed;
}

lac_status lac_fit_compute(const lac_case *c, const lac_series *series,
                           const lac_fit_options *options, lac_dataset **out, lac_error *err)
{
    lac_fit_options own = lac_fit_options_default();
    fit_made *f = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, series, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_fit_options", options, &own, sizeof own, err));
    LAC_TRY(lac_case_serves(c, LAC_FOR_FIT, err));
    f = calloc(1, sizeof *f);
    LAC_TRY(f != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_made_from_case(c, &f->made, err));
    f->made.provenance.seed = c->fit.seed;
    LAC_TRY(lac_fit_create(c, series, own.threads > 0 ? own.threads : 1, &f->fit, err));
    const lac_fit_watch watch = {own.interrupted, own.progress, own.context, NULL};
    status = lac_fit_run(f->fit, &watch, &f->result, err);
    f->outcome = (lac_fit_outcome){c, &f->result, status == LAC_OK ? "complete" : "interrupted"};
    if (status == LAC_OK || (status == LAC_EINTERRUPT && f->result.times > 0)) {
        status = hand_out(f, status, out, err);
        f = *out != NULL ? NULL : f;
    }
out:
    if (f != NULL) {
        fit_made_free(f);
    }
    return status;
}

// What a dataset is of, which it keeps.
typedef struct forecast_made {
    lac_forecast_options options;
    lac_levels levels;
    lac_fit_watch watch;
    lac_model_forecast how;
    lac_forecast_model model;
    lac_indicator_inputs evidence;
    lac_readings readings;
    lac_forecast_outcome outcome;
    lac_made_from made;
} forecast_made;

static void forecast_free(void *result)
{
    forecast_made *f = result;
    lac_forecast_outcome_clear(&f->outcome);
    free(f->made.case_text);
    free(f);
}

static lac_status take_case(forecast_made *f, bool dated, lac_error *err)
{
    const lac_forecast_options *o = &f->options;
    f->made.provenance.seed = INT64_MIN;
    if (o->source == NULL) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_case_serves(o->source, LAC_FOR_FIT, err));
    LAC_TRY_RETURN(lac_made_from_case(o->source, &f->made, err));
    f->made.provenance.seed = o->source->fit.seed;
    f->how = (lac_model_forecast){
        .source = o->source, .dated = dated, .threads = o->threads > 0 ? o->threads : 1};
    f->model = lac_model_forecast_method(&f->how);
    return LAC_OK;
}

static lac_status take_levels(forecast_made *f, lac_error *err)
{
    lac_units *units = NULL;
    f->levels = lac_levels_default();
    if (f->options.levels == NULL) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_units_create(&units, err));
    const lac_status status = lac_levels_read(f->options.levels, units, &f->levels, err);
    lac_units_free(units);
    return status;
}

static lac_forecast_def plan(const forecast_made *f)
{
    const lac_forecast_options *o = &f->options;
    lac_forecast_def def = lac_forecast_default();
    def.motion = (lac_motion_def){o->smoothing, o->points, o->order, o->window, o->raw};
    def.since = o->since;
    def.onset = o->short_run > 0 || o->long_run > 0;
    def.short_run = o->short_run > 0 ? o->short_run : def.short_run;
    def.long_run = o->long_run > 0 ? o->long_run : def.long_run;
    def.levels = f->levels;
    def.model = o->source != NULL ? &f->model : NULL;
    return def;
}

static lac_status look(forecast_made *f, const lac_series *s, lac_error *err)
{
    const lac_forecast_options *o = &f->options;
    const lac_forecast_def def = plan(f);
    const lac_rolling_watch watch = {.context = o->context, .go_on = o->go_on};
    f->readings = lac_series_readings(s);
    while (f->readings.n > 0 && f->readings.time[f->readings.n - 1] > o->until) {
        f->readings.n--;
    }
    LAC_FAIL_IF(f->readings.n == 0, err, LAC_EINPUT, "no reading until %g s", o->until);
    f->evidence = lac_evidence_default();
    f->outcome = (lac_forecast_outcome){.series = s,
                                        .readings = &f->readings,
                                        .dated = s->dated,
                                        .failed_at = o->failed_at,
                                        .horizon = f->levels.horizon};
    return lac_forecast_look(&def, &f->evidence, o->issues, &watch, &f->outcome, err);
}

lac_status lac_forecast_compute(const lac_series *series, const lac_forecast_options *options,
                                lac_dataset **out, lac_error *err)
{
    forecast_made *f = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, series, out));
    *out = NULL;
    f = calloc(1, sizeof *f);
    LAC_TRY(f != NULL ? LAC_OK : lac_fail_memory(err));
    f->options = lac_forecast_options_default();
    LAC_TRY(lac_take_options("lac_forecast_options", options, &f->options, sizeof f->options, err));
    LAC_TRY(take_levels(f, err));
    LAC_TRY(take_case(f, series->dated, err));
    status = look(f, series, err);
    if (status == LAC_OK || f->outcome.interrupted) {
        const lac_status told = lac_forecast_describe(&f->outcome, out, err);
        if (told == LAC_OK) {
            lac_dataset_keep(*out, f, forecast_free, &f->made.provenance);
            f = NULL;
        }
        status = told == LAC_OK ? status : told;
    }
out:
    if (f != NULL) {
        forecast_free(f);
    }
    return status;
}
