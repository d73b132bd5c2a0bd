// SPDX-License-Identifier: GPL-3.0-or-later
// What a method answers at one time of issue: the calibrated median and intervals of its time of
// failure, and whether its fit is good enough as a forecast. Readings that come every so often know
// no time better than that: with the step the median of the last five intervals, no median is
// nearer than half a step, no 90 % interval narrower than one, no 50 % interval than 0.4 of one;
// what is, is widened about the median, in time, but not to what is over.
#include "forecast/kinds.h"

enum { INTEGRABLE = 20, MIDDLE = 2 };
static const double vaguest = 1.5; // standard error of ln remaining that still is a forecast
static const double nearest = 0.5, narrowest50 = 0.4, narrowest90 = 1.0; // steps

// Remaining time at a level: q errors from the fit, or from the posterior's median by the error
// that its quantile at this level stands for.
static double place(const lac_forecast *f, double window, int level, double q)
{
    static const double normal[LAC_FORECAST_LEVELS] = {1.6448536269514722, 0.6744897501960817, 0.0,
                                                       0.6744897501960817, 1.6448536269514722};
    const lac_forecast_fit *fit = &f->fit;
    const lac_calibration *c = &f->kind->calibration;
    const double found = fit->posterior ? fit->quantile[MIDDLE] : log(fit->remaining);
    const double error = fit->posterior && level != MIDDLE
                             ? (fit->quantile[level] - found) / normal[level]
                             : fit->error;
    return exp(found + c->pull * (log(window) - found) + hypot(error, c->spread) * q);
}

static void widen(double step, double *left)
{
    const double middle = fmax(left[MIDDLE], nearest * step);
    left[MIDDLE] = middle;
    left[1] = fmin(left[1], middle - 0.5 * narrowest50 * step);
    left[3] = fmax(left[3], middle + 0.5 * narrowest50 * step);
    left[0] = fmin(left[0], fmax(0.0, fmin(left[1], middle - 0.5 * narrowest90 * step)));
    left[4] = fmax(left[4], fmax(left[3], middle + 0.5 * narrowest90 * step));
}

// Remaining time at each level. @return whether it is known
static bool find_levels(const lac_window *w, const lac_forecast *f, double *left)
{
    const lac_calibration *c = &f->kind->calibration;
    const double q[LAC_FORECAST_LEVELS] = {c->low90, c->low50, c->median, c->high50, c->high90};
    bool known = isfinite(f->fit.error);
    for (int k = 0; k < LAC_FORECAST_LEVELS && known; k++) {
        left[k] = place(f, w->now - fmax(w->start, w->now + w->time[0]), k, q[k]);
        known = isfinite(left[k]);
    }
    if (known) {
        widen(w->step, left);
    }
    return known;
}

// Whether a time of failure is to come: by more than a thousandth of the last interval, which the
// last reading only just does not forbid.
static bool is_to_come(const lac_window *w, const lac_forecast_fit *fit)
{
    return isfinite(fit->remaining) &&
           fit->remaining > (w->n > 1 ? -1e-3 * w->time[w->n - 2] : 0.0);
}

// @return whether nothing speaks against it
static bool passes(const lac_window *w, const lac_forecast_kind *kind, lac_forecast_fit *fit)
{
    if (fit->reason[0] != '\0') {
        // it says why
    } else if (!is_to_come(w, fit)) {
        (void)lac_forecast_fit_refuse(fit, "points to a time that is over");
    } else if (!(fit->excess <= kind->worst)) {
        (void)lac_forecast_fit_refuse(fit,
                                      "bad fit: the residuals are %.2g of the range, %.2g of it "
                                      "more than the noise explains, at most %.2g",
                                      fit->misfit, fit->excess, kind->worst);
    } else if (!(fit->error <= vaguest)) {
        (void)lac_forecast_fit_refuse(fit, "too vague: uncertain by a factor of %.2g, at most %.2g",
                                      exp(fit->error), exp(vaguest));
    }
    return fit->reason[0] == '\0';
}

static void judge(const lac_window *w, lac_forecast *f)
{
    double left[LAC_FORECAST_LEVELS];
    const bool known = is_to_come(w, &f->fit) && find_levels(w, f, left);
    f->raw_time = w->now + f->fit.remaining;
    f->time = known ? w->now + left[MIDDLE] : (double)NAN;
    if (passes(w, f->kind, &f->fit) && !known) {
        (void)lac_forecast_fit_refuse(&f->fit, "its error is not finite");
    }
    f->issued = f->fit.reason[0] == '\0';
    if (f->issued) {
        f->low90 = w->now + left[0];
        f->low50 = w->now + left[1];
        f->high50 = w->now + left[3];
        f->high90 = w->now + left[4];
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
        judge(w, f);
    }
    return status;
}
