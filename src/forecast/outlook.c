// SPDX-License-Identifier: GPL-3.0-or-later
// All methods asked at the last reading, and which of their answers are good enough as forecasts.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "forecast/kinds.h"

enum { LONGEST_RUN = 1000, INTEGRABLE = 20 };
static const double vaguest = 1.5; // standard error of ln remaining that still is a forecast

lac_forecast_def lac_forecast_default(void)
{
    return (lac_forecast_def){.since = NAN, .short_run = 3, .long_run = 7};
}

static lac_status check(const lac_forecast_def *def, const lac_readings *readings, lac_error *err)
{
    LAC_FAIL_IF(readings->n == 0, err, LAC_EINPUT, "there is no reading to forecast from");
    LAC_FAIL_IF(def->short_run < 1 || def->long_run <= def->short_run ||
                    def->long_run > LONGEST_RUN,
                err, LAC_EINPUT,
                "the means of the onset must be of 1 or more velocities, and of more, at most %d",
                (int)LONGEST_RUN);
    return LAC_OK;
}

// Where an interval ends: q errors from the fit, or from the posterior's median by the error that
// its quantile at `level` stands for.
static double end_of(const lac_forecast_fit *fit, double spread, int level, double q)
{
    static const double normal[LAC_FORECAST_LEVELS] = {1.6448536269514722, 0.6744897501960817, 1.0,
                                                       0.6744897501960817, 1.6448536269514722};
    if (!fit->posterior) {
        return fit->remaining * exp(hypot(fit->error, spread) * q);
    }
    const double e = (fit->quantile[level] - fit->quantile[2]) / normal[level];
    return exp(fit->quantile[2] + hypot(e, spread) * q);
}

static void set_interval(const lac_forecast_kind *kind, double now, lac_forecast *f)
{
    const lac_calibration *c = &kind->calibration;
    // what calibration knows of a method's bias may leave its own time beside the interval
    f->low90 = fmin(f->time, now + end_of(&f->fit, c->spread, 0, c->low90));
    f->low50 = now + end_of(&f->fit, c->spread, 1, c->low50);
    f->high50 = now + end_of(&f->fit, c->spread, 3, c->high50);
    f->high90 = fmax(f->time, now + end_of(&f->fit, c->spread, 4, c->high90));
    f->issued = isfinite(f->low90) && isfinite(f->high90);
    if (!f->issued) {
        (void)lac_forecast_fit_refuse(&f->fit, "its error is not finite");
    }
}

static void judge(const lac_forecast_kind *kind, double nearest, lac_forecast *f)
{
    lac_forecast_fit *fit = &f->fit;
    if (fit->reason[0] != '\0') {
        return;
    }
    if (!isfinite(fit->remaining) || !(fit->remaining > nearest)) {
        (void)lac_forecast_fit_refuse(fit, "points to a time that is over");
    } else if (!(fit->misfit <= kind->worst)) {
        (void)lac_forecast_fit_refuse(fit,
                                      "bad fit: the residuals are %.2g of the range, at most %.2g",
                                      fit->misfit, kind->worst);
    } else if (!(fit->error <= vaguest)) {
        (void)lac_forecast_fit_refuse(fit, "too vague: uncertain by a factor of %.2g, at most %.2g",
                                      exp(fit->error), exp(vaguest));
    } else {
        set_interval(kind, f->issue_time, f);
    }
}

static lac_status ask(const lac_forecast_def *def, const lac_motion *m, const lac_window *w,
                      lac_forecast *f, lac_error *err)
{
    const lac_forecast_kind *kind = f->kind;
    const size_t points = w->n < w->velocities ? w->n : w->velocities;
    f->issue_time = w->now;
    f->window_start = w->start;
    if (points < kind->least) {
        return lac_forecast_fit_refuse(&f->fit, "too few points: %zu in the window, at least %zu",
                                       points, kind->least);
    }
    if (kind->displacements && w->integrated && w->n < INTEGRABLE) {
        return lac_forecast_fit_refuse(&f->fit, "too few velocities to integrate: %zu, at least %d",
                                       w->n, (int)INTEGRABLE);
    }
    lac_status status = kind->fit != NULL
                            ? kind->fit(w, &f->fit, err)
                            : def->model->fit(def->model->context, m, w->now, &f->fit, err);
    if (status == LAC_OK) {
        f->time = w->now + f->fit.remaining;
        // what is a thousandth of the last interval away, the last reading only just does not
        // forbid
        judge(kind, w->n > 1 ? -1e-3 * w->time[w->n - 2] : 0.0, f);
    }
    return status;
}

static lac_status forecast(lac_forecast_set *o, const lac_forecast_def *def, lac_error *err)
{
    char reason[LAC_FORECAST_TEXT] = "";
    lac_window *w = NULL;
    lac_status status = LAC_OK;
    lac_window_gate(def, o->motion, &o->window_start, &o->accelerating, reason);
    o->asked = reason[0] == '\0';
    if (o->asked) {
        LAC_TRY(lac_window_create(o->motion, o->window_start, &w, err));
    }
    for (size_t k = 0; k < o->count; k++) {
        lac_forecast *f = &o->forecast[k];
        *f = (lac_forecast){.kind = lac_forecast_kind_of(def, k),
                            .issue_time = o->issue_time,
                            .window_start = NAN,
                            .time = NAN,
                            .low50 = NAN,
                            .high50 = NAN,
                            .low90 = NAN,
                            .high90 = NAN,
                            .fit = {.remaining = NAN, .error = NAN, .rms = NAN, .misfit = NAN}};
        memcpy(f->fit.reason, reason, sizeof reason);
        if (o->asked) {
            LAC_TRY(ask(def, o->motion, w, f, err));
        }
    }
out:
    lac_window_free(w);
    return status;
}

lac_status lac_forecast_set_create(const lac_forecast_def *def, const lac_readings *readings,
                                   lac_forecast_set **out, lac_error *err)
{
    const size_t count = lac_forecast_count(def);
    lac_status status;
    *out = NULL;
    LAC_TRY_RETURN(check(def, readings, err));
    lac_forecast_set *o = calloc(1, sizeof *o + count * sizeof *o->forecast);
    LAC_FAIL_MEMORY_IF(o == NULL, err);
    o->count = count;
    o->forecast = (lac_forecast *)(o + 1);
    LAC_TRY(lac_motion_create(&def->motion, readings, &o->motion, err));
    o->issue_time = readings->time[readings->n - 1];
    LAC_TRY(forecast(o, def, err));
    *out = o;
    o = NULL;
out:
    lac_forecast_set_free(o);
    return status;
}

void lac_forecast_set_free(lac_forecast_set *forecasts)
{
    if (forecasts != NULL) {
        lac_motion_free(forecasts->motion);
        free(forecasts);
    }
}
