// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/forecast.h"

#include <math.h>

#include "lacuna/hindcast.h"
#include "lacuna/precursor.h"
#include "lacuna/store_forecast.h"

enum { N = 16, EVENTS = 30 };

lac_status whole_forecast(const char *path, lac_error *err)
{
    double time[N], displacement[N], moment[EVENTS];
    for (size_t i = 0; i < N; i++) {
        time[i] = (double)i;
        displacement[i] = -log(18.0 - time[i]);
    }
    for (size_t i = 0; i < EVENTS; i++) {
        moment[i] = 1e9 * (double)(1 + i % 7);
    }
    const lac_readings readings = {.n = N, .time = time, .displacement = displacement};
    const lac_event_list events = {N, time, moment};
    const lac_forecast_def def = lac_forecast_default();
    lac_outlook *outlook = NULL;
    lac_rolling *rolling = NULL;
    lac_skill skill[16];
    lac_precursor found[LAC_PRECURSORS_MAX];
    lac_slowing slowing;
    size_t count = 0;
    lac_status status;
    LAC_TRY(lac_outlook_create(&def, &readings, &outlook, err));
    LAC_TRY(lac_rolling_create(&def, &readings, 1, NULL, &rolling, err));
    LAC_TRY(lac_rolling_measure(rolling, 18.0, 5.0, skill, err));
    const lac_observed seen = {outlook->motion, &events, NULL, 18.0, 0.0, 1, 3};
    LAC_TRY(lac_precursors_look(&seen, found, &count, err));
    LAC_TRY(lac_slowing_measure(N, displacement, 1, 3, &slowing, err));
    const lac_provenance provenance = {.title = "a forecast", .seed = 1};
    const lac_forecast_file file = {
        .source = "here", .failed_at = 18.0, .outlook = outlook, .rolling = rolling};
    LAC_TRY(lac_store_forecast(path, true, &provenance, &file, err));
out:
    lac_rolling_free(rolling);
    lac_outlook_free(outlook);
    return status;
}
