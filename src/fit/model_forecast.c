// SPDX-License-Identifier: GPL-3.0-or-later
// A case as a method of forecasting: fitted to what was read, then run on.
#include "fit/model_forecast.h"

#include "fit/internal.h"

static const double far_from_converged = 1.2; // R-hat
static const double most_fail = 0.95;

static size_t readings_within(const lac_case *c, const lac_motion *m, double shift)
{
    size_t inside = 0;
    const double *time = m->integrated ? m->velocity_time : m->time;
    for (size_t i = 0; i < (m->integrated ? m->velocities : m->n); i++) {
        inside += time[i] >= shift && time[i] - shift <= c->run.end ? 1 : 0;
    }
    return inside;
}

static bool lacks_sigma(const lac_case *c, const lac_motion *m)
{
    bool lacks = c->fit.columns.sigma != NULL && m->integrated;
    for (size_t i = 0; c->fit.columns.sigma != NULL && !m->integrated && i < m->n; i++) {
        lacks = lacks || !(m->sigma[i] > 0.0);
    }
    return lacks;
}

static double worst_rhat(const lac_fit_result *r)
{
    double worst = 0.0;
    for (size_t k = 0; k < r->unknowns; k++) {
        worst = fmax(worst, r->unknown[k].converged.rhat);
    }
    return worst;
}

static void judge(const lac_fit_result *r, lac_forecast_fit *found)
{
    const bool velocities = !(r->displacements > 0);
    found->points = r->displacements + r->velocities;
    found->rms = velocities ? r->log_rate_rms : r->displacement_rms;
    found->rms_unit = velocities ? "1" : "m";
    found->misfit = r->misfit;
    found->excess = r->excess;
    found->poor = r->poor;
}

// The draws' times of failure.
static void take_posterior(const lac_fit_result *r, double now, lac_forecast_fit *found)
{
    lac_forecast_fit_add(found, "failing", r->failing);
    lac_forecast_fit_add(found, "rhat", worst_rhat(r));
    if (!(r->failing >= most_fail)) {
        (void)lac_forecast_fit_refuse(found,
                                      "%.0f %% of the draws fail by time.end, at least %.0f %%",
                                      100.0 * r->failing, 100.0 * most_fail);
    } else if (!(worst_rhat(r) <= far_from_converged)) {
        (void)lac_forecast_fit_refuse(found,
                                      "the chain has not converged: R-hat %.2f, at most %.1f",
                                      worst_rhat(r), far_from_converged);
    } else {
        found->posterior = true;
        for (size_t q = 0; q < LAC_FORECAST_LEVELS; q++) {
            found->quantile[q] = log(fmax(r->failures.quantile[q] - now, 1e-300));
        }
        found->error = (found->quantile[4] - found->quantile[0]) / (2.0 * 1.6448536269514722);
    }
}

static void take(const lac_fit_result *r, double now, lac_forecast_fit *found)
{
    judge(r, found);
    found->remaining = r->failure - now;
    found->error = r->failure_error / found->remaining;
    if (r->sampled) {
        take_posterior(r, now, found);
    } else if (isnan(r->failure)) {
        (void)lac_forecast_fit_refuse(found, "the best fit does not fail by time.end");
    } else if (isnan(r->failure_error)) {
        (void)lac_forecast_fit_refuse(found,
                                      "least squares tell no error of it: sample (fit.steps)");
    }
    for (size_t k = 0; k < r->parameters; k++) {
        lac_forecast_fit_add(found, r->unknown[k].key, r->unknown[k].best);
        if (r->unknown[k].end != 0 && found->ends < LAC_FORECAST_VALUES) {
            found->end[found->ends++] = r->unknown[k].key;
        }
    }
}

// The steps of many fits are kept one after the other, each behind what it follows from.
static lac_status begin_kept(const lac_fit_watch *watch, uint64_t of, lac_error *err)
{
    uint64_t before = of;
    if (watch == NULL || watch->kept == NULL) {
        return LAC_OK;
    }
    if (!lac_kept_read(watch->kept, &before, sizeof before)) {
        return lac_kept_put(watch->kept, &of, sizeof of, err);
    }
    return before == of ? LAC_OK
                        : lac_fail(err, LAC_EINPUT,
                                   "--resume: the steps that were kept are of other readings or "
                                   "options; without it they are made anew");
}

static lac_status fit(const lac_model_forecast *how, const lac_series *series, double now,
                      lac_forecast_fit *found, lac_error *err)
{
    lac_fit *fit = NULL;
    lac_fit_result result;
    lac_error why = {""};
    lac_status status = lac_fit_create(how->source, series, how->threads, &fit, &why);
    if (status == LAC_OK) {
        LAC_TRY(begin_kept(how->watch, lac_fit_sum(fit), err));
        status = lac_fit_run(fit, how->watch, &result, &why);
    }
    if (status == LAC_OK) {
        take(&result, now, found);
    } else if (status == LAC_EINPUT || status == LAC_ENUMERIC) {
        status = lac_forecast_fit_refuse(found, "%s", why.message);
    } else {
        *err = why;
    }
out:
    lac_fit_free(fit);
    return status;
}

static lac_status foresee(void *context, const lac_motion *m, double now, lac_forecast_fit *found,
                          lac_error *err)
{
    const lac_model_forecast *how = context;
    const lac_case *c = how->source;
    const double shift = how->dated ? c->start_date : 0.0;
    const bool v = m->integrated;
    const lac_series series = {.n = v ? m->velocities : m->n,
                               .dated = how->dated,
                               .time = v ? m->velocity_time : m->time,
                               .displacement = v ? NULL : m->displacement,
                               .velocity = v ? m->velocity : NULL,
                               .value = m->sigma,
                               .displacement_digit = m->resolution};
    LAC_FAIL_IF(how->dated && !c->dated, err, LAC_EINPUT,
                "the series has dates, so time.start of %s must be a date", c->path);
    if (lac_fit_has_rates(&c->fit) || c->fit.columns.value != NULL) {
        return lac_forecast_fit_refuse(
            found, "fit.friction, velocity_sigma, velocity_most and time_within "
                   "are of lacuna fit; with fit.until it forecasts");
    }
    const size_t inside = readings_within(c, m, shift);
    if (inside < c->fit.count + 3) {
        return lac_forecast_fit_refuse(
            found, "too few readings between time.start and time.end: %zu, at least %zu", inside,
            c->fit.count + 3);
    }
    return lacks_sigma(c, m) ? lac_forecast_fit_refuse(found, "a reading has no standard error")
                             : fit(how, &series, now - shift, found, err);
}

lac_forecast_model lac_model_forecast_method(lac_model_forecast *how)
{
    return (lac_forecast_model){.kind = &lac_forecast_case, .context = how, .fit = foresee};
}
