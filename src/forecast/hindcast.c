// SPDX-License-Identifier: GPL-3.0-or-later
// Forecasts as they would have been made in the past, each from the readings up to its own time,
// and how good they were, where the time of failure is known: errors, alarms, scores.
#include "forecast/hindcast.h"
#include "forecast/kinds.h"

// Readings that issue k of `issues` <= n may see; the last sees all.
static size_t seen(size_t n, size_t issues, size_t k)
{
    return issues == n ? k + 1 : (size_t)((double)n * ((double)(k + 1) / (double)issues) + 0.5);
}

static lac_status issue(lac_rolling *r, const lac_forecast_def *def, const lac_readings *readings,
                        size_t k, const lac_rolling_watch *watch, lac_error *err)
{
    lac_readings past = *readings;
    lac_forecast_set *forecasts = NULL;
    past.n = seen(readings->n, r->issues, k);
    lac_status status = lac_forecast_set_create(def, &past, &forecasts, err);
    if (status == LAC_OK) {
        r->issue_time[k] = forecasts->issue_time;
        r->verdict[k] = forecasts->verdict;
        memcpy(&r->forecast[k * r->methods], forecasts->forecast, r->methods * sizeof *r->forecast);
        if (watch != NULL && watch->see != NULL) {
            status = watch->see(watch->seer, forecasts, err);
        }
    }
    lac_forecast_set_free(forecasts);
    return status;
}

lac_status lac_rolling_create(const lac_forecast_def *def, const lac_readings *readings,
                              size_t most, const lac_rolling_watch *watch, lac_rolling **out,
                              lac_error *err)
{
    const size_t planned = readings->n < most ? readings->n : most;
    const size_t methods = lac_forecast_count(def);
    lac_status status = LAC_OK;
    *out = NULL;
    LAC_FAIL_IF(planned == 0, err, LAC_EINPUT, "there is no reading to forecast from");
    lac_rolling *r = malloc(sizeof *r + planned * (methods * sizeof *r->forecast +
                                                   sizeof *r->verdict + sizeof *r->issue_time));
    LAC_FAIL_MEMORY_IF(r == NULL, err);
    *r = (lac_rolling){.issues = planned, .methods = methods, .start = readings->time[0]};
    r->forecast = (lac_forecast *)(r + 1);
    r->verdict = (lac_verdict *)(r->forecast + planned * methods);
    r->issue_time = (double *)(r->verdict + planned);
    for (size_t k = 0; k < planned && status == LAC_OK; k++) {
        const bool go_on =
            watch == NULL || watch->go_on == NULL || watch->go_on(watch->context, k, planned);
        status = go_on ? issue(r, def, readings, k, watch, err) : LAC_EINTERRUPT;
        if (status == LAC_EINTERRUPT) {
            r->issues = k;
            (void)lac_fail(err, status, "interrupted after %zu of %zu issue times", k, planned);
        }
    }
    if (status == LAC_OK || (status == LAC_EINTERRUPT && r->issues > 0)) {
        *out = r;
    } else {
        lac_rolling_free(r);
    }
    return status;
}

void lac_rolling_free(lac_rolling *rolling) { free(rolling); }

enum { LEVELS = 5 };

// Twice the mean quantile loss over five levels: the CRPS, which is that over all levels, by five.
static double ranked_score(const lac_forecast *f, double failed_at)
{
    static const double level[LEVELS] = {0.05, 0.25, 0.5, 0.75, 0.95};
    static const double weight[LEVELS] = {0.15, 0.225, 0.25, 0.225, 0.15};
    const double quantile[LEVELS] = {f->low90, f->low50, f->time, f->high50, f->high90};
    double sum = 0.0;
    for (int i = 0; i < LEVELS; i++) {
        const double off = failed_at - quantile[i];
        sum += 2.0 * weight[i] * (off >= 0.0 ? level[i] * off : (level[i] - 1.0) * off);
    }
    return sum;
}

static size_t lead_class(const lac_rolling *r, double failed_at, double lead)
{
    const double part = lead / (failed_at - r->start);
    return part <= 0.125 ? 0 : part <= 0.25 ? 1 : part <= 0.5 ? 2 : 3;
}

static void count_alarm(const lac_forecast *f, double failed_at, double horizon, lac_skill *s)
{
    const bool alarm = f->issued && f->high50 <= f->issue_time + horizon;
    const bool near = failed_at <= f->issue_time + horizon;
    s->alarms += alarm ? 1 : 0;
    s->hits += alarm && near ? 1 : 0;
    s->false_alarms += alarm && !near ? 1 : 0;
    s->misses += !alarm && near ? 1 : 0;
}

static void count_inside(const lac_forecast *f, double failed_at, lac_skill *s)
{
    s->inside50 += failed_at >= f->low50 && failed_at <= f->high50 ? 1 : 0;
    s->inside90 += failed_at >= f->low90 && failed_at <= f->high90 ? 1 : 0;
}

// Errors and ratios of the issues whose lead time is of a class; of all where it is LAC_LEADS.
static size_t gather(const lac_rolling *r, size_t k, double failed_at, size_t lead, double *error,
                     double *ratio)
{
    size_t n = 0;
    for (size_t i = 0; i < r->issues; i++) {
        const lac_forecast *f = &r->forecast[i * r->methods + k];
        const double left = failed_at - f->issue_time;
        if (!f->issued || !(left > 0.0) ||
            (lead < LAC_LEADS && lead_class(r, failed_at, left) != lead)) {
            continue;
        }
        error[n] = fabs(f->time - failed_at);
        ratio[n++] = (f->time - f->issue_time) / left;
    }
    return n;
}

static void measure(const lac_rolling *r, size_t k, double failed_at, double horizon, double *work,
                    lac_skill *s)
{
    double *const error = work;
    double *const ratio = work + r->issues;
    *s = (lac_skill){.kind = r->forecast[k].kind};
    for (size_t i = 0; i < r->issues; i++) {
        const lac_forecast *f = &r->forecast[i * r->methods + k];
        const lac_forecast *baseline = &r->forecast[(i + 1) * r->methods - 1];
        if (!(f->issue_time < failed_at)) {
            continue;
        }
        s->asked++;
        s->issued += f->issued ? 1 : 0;
        count_alarm(f, failed_at, horizon, s);
        if (f->issued && isfinite(failed_at)) {
            count_inside(f, failed_at, s);
            s->crps += ranked_score(f, failed_at);
            s->persistence_crps += ranked_score(baseline, failed_at);
        }
    }
    s->crps = s->issued > 0 && isfinite(failed_at) ? s->crps / (double)s->issued : NAN;
    s->persistence_crps =
        s->issued > 0 && isfinite(failed_at) ? s->persistence_crps / (double)s->issued : NAN;
    for (size_t lead = 0; lead <= LAC_LEADS; lead++) {
        const size_t n = isfinite(failed_at) ? gather(r, k, failed_at, lead, error, ratio) : 0;
        if (lead == LAC_LEADS) {
            s->error = lac_median(n, error);
            continue;
        }
        s->lead_count[lead] = n;
        s->lead_error[lead] = lac_median(n, error);
        s->lead_bias[lead] = lac_median(n, ratio);
    }
}

lac_status lac_rolling_measure(const lac_rolling *rolling, double failed_at, double horizon,
                               lac_skill *skill, lac_error *err)
{
    double *work = malloc(2 * rolling->issues * sizeof *work);
    LAC_FAIL_MEMORY_IF(work == NULL, err);
    for (size_t k = 0; k < rolling->methods; k++) {
        measure(rolling, k, failed_at, horizon, work, &skill[k]);
    }
    free(work);
    return LAC_OK;
}
