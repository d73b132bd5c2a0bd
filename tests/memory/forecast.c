// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/forecast.h"
#include "base/fail.h"

#include <math.h>

#include "forecast/hindcast.h"
#include "precursor/precursor.h"
#include "store/store.h"

enum { N = 16, EVENTS = 30 };

lac_status whole_forecast(const char *path, lac_error *err)
{
    double time[N], displacement[N], rain[N], moment[EVENTS];
    for (size_t i = 0; i < N; i++) {
        time[i] = (double)i;
        displacement[i] = -log(18.0 - time[i]);
        rain[i] = (double)(i * i % 7);
    }
    for (size_t i = 0; i < EVENTS; i++) {
        moment[i] = 1e9 * (double)(1 + i % 7);
    }
    const lac_readings readings = {.n = N, .time = time, .displacement = displacement};
    const lac_event_list events = {.n = N, .time = time, .moment = moment};
    const lac_driver driver = {.name = "rain", .unit = "mm", .n = N, .time = time, .value = rain};
    lac_forecast_def def = lac_forecast_default();
    lac_slowing slowing;
    lac_dataset *dataset = NULL;
    lac_forecast_outcome outcome = {
        .source = "here", .failed_at = 18.0, .horizon = 5.0, .readings = &readings};
    lac_status status;
    def.driver = &driver;
    def.drivers = 1;
    const lac_indicator_inputs evidence = {.events = &events, .seed = 1, .surrogates = 3};
    LAC_TRY(lac_forecast_look(&def, &evidence, 1, NULL, &outcome, err));
    LAC_TRY(lac_slowing_measure(N, displacement, 1, 3, &slowing, err));
    const lac_provenance provenance = {.title = "a forecast", .seed = 1};
    LAC_TRY(lac_forecast_describe(&outcome, &dataset, err));
    LAC_TRY(lac_store_dataset(path, true, &provenance, dataset, err));
out:
    lac_dataset_free(dataset);
    lac_forecast_outcome_clear(&outcome);
    return status;
}
