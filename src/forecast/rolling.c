// SPDX-License-Identifier: GPL-3.0-or-later
// Forecasts as they would have been made in the past, each from the readings up to its own time.
#include <stdlib.h>
#include <string.h>

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
    *out = NULL;
    LAC_FAIL_IF(readings->n == 0 || most == 0, err, LAC_EINPUT,
                "there is no reading to forecast from");
    lac_rolling *r = calloc(1, sizeof *r);
    lac_status status = r != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    r->start = readings->time[0];
    r->issues = readings->n < most ? readings->n : most;
    r->methods = lac_forecast_count(def);
    r->issue_time = malloc(r->issues * sizeof *r->issue_time);
    r->forecast = malloc(r->issues * r->methods * sizeof *r->forecast);
    if (r->issue_time == NULL || r->forecast == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    const size_t planned = r->issues;
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
        r = NULL;
    }
out:
    lac_rolling_free(r);
    return status;
}

void lac_rolling_free(lac_rolling *rolling)
{
    if (rolling == NULL) {
        return;
    }
    free(rolling->issue_time);
    free(rolling->forecast);
    free(rolling);
}
