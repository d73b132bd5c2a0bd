// SPDX-License-Identifier: GPL-3.0-or-later
// What a method answers at one time of issue: whether its fit is good enough as a forecast, and
// its intervals.
#include <math.h>

#include "forecast/kinds.h"

enum { INTEGRABLE = 20 };
static const double vaguest = 1.5; // standard error of ln remaining that still is a forecast

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

lac_status lac_forecast_ask(const lac_forecast_def *def, const lac_motion *m, const lac_window *w,
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
