// SPDX-License-Identifier: GPL-3.0-or-later
// Indicators at one time after the other, each of nothing but what was known then.
#include <math.h>
#include <stdlib.h>

#include "precursor/precursor.h"

// The events that had ended by `now`, in the order of their starts.
typedef struct past_events {
    double *time, *moment;
    lac_event_list list;
} past_events;

static lac_status keep_events(const lac_event_list *all, double now, past_events *out,
                              lac_error *err)
{
    const size_t room = all->n > 0 ? all->n : 1;
    size_t n = 0;
    *out = (past_events){.time = malloc(room * sizeof *out->time),
                         .moment = malloc(room * sizeof *out->moment)};
    LAC_FAIL_MEMORY_IF(out->time == NULL || out->moment == NULL, err);
    for (size_t i = 0; i < all->n; i++) {
        if ((all->end != NULL ? all->end[i] : all->time[i]) <= now) {
            out->time[n] = all->time[i];
            out->moment[n++] = all->moment[i];
        }
    }
    out->list = (lac_event_list){.n = n, .time = out->time, .moment = out->moment};
    return LAC_OK;
}

static lac_slip_history keep_slip(const lac_slip_history *all, double now)
{
    lac_slip_history past = *all;
    while (past.n > 0 && (!(past.time[past.n - 1] <= now) || isnan(past.length[past.n - 1]))) {
        past.n--;
    }
    return past;
}

static void set_time_of_failure(const lac_forecast_set *o, lac_precursor_inputs *observation)
{
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        if (f->kind->dates && f->issued) {
            observation->tc = f->time;
            observation->start = f->window_start;
        }
    }
}

lac_indicator_inputs lac_evidence_default(void)
{
    return (lac_indicator_inputs){.seed = 1, .surrogates = 199};
}

lac_status lac_precursors_at(const lac_indicator_inputs *inputs, const lac_forecast_set *forecasts,
                             lac_precursor *out, size_t *count, lac_error *err)
{
    past_events events = {0};
    lac_slip_history slip;
    lac_precursor_inputs observation = {.motion = forecasts->motion,
                                        .tc = NAN,
                                        .start = NAN,
                                        .seed = inputs->seed,
                                        .surrogates = inputs->surrogates};
    lac_status status = LAC_OK;
    set_time_of_failure(forecasts, &observation);
    if (inputs->events != NULL) {
        LAC_TRY(keep_events(inputs->events, forecasts->issue_time, &events, err));
        observation.events = &events.list;
    }
    if (inputs->slip != NULL) {
        slip = keep_slip(inputs->slip, forecasts->issue_time);
        observation.slip = &slip;
    }
    LAC_TRY(lac_precursors_evaluate(&observation, out, count, err));
out:
    free(events.time);
    free(events.moment);
    return status;
}

lac_status lac_indicator_series_create(const lac_indicator_inputs *inputs, size_t most,
                                       lac_indicator_series **out, lac_error *err)
{
    lac_indicator_series *indicator_series = calloc(1, sizeof *indicator_series);
    *out = NULL;
    LAC_FAIL_MEMORY_IF(indicator_series == NULL, err);
    *indicator_series = (lac_indicator_series){.inputs = inputs, .most = most};
    while (lac_precursor_kind_get(indicator_series->kinds) != NULL) {
        indicator_series->kinds++;
    }
    indicator_series->found =
        calloc(most * indicator_series->kinds, sizeof *indicator_series->found);
    if (indicator_series->found == NULL) {
        free(indicator_series);
        return lac_fail_memory(err);
    }
    *out = indicator_series;
    return LAC_OK;
}

void lac_indicator_series_free(lac_indicator_series *indicator_series)
{
    if (indicator_series != NULL) {
        free(indicator_series->found);
        free(indicator_series);
    }
}

lac_status lac_indicator_series_see(void *context, const lac_forecast_set *forecasts,
                                    lac_error *err)
{
    lac_indicator_series *indicator_series = context;
    size_t count = 0;
    lac_precursor *found =
        indicator_series->found + indicator_series->issues * indicator_series->kinds;
    lac_status status = lac_precursors_at(indicator_series->inputs, forecasts, found, &count, err);
    indicator_series->issues += status == LAC_OK ? 1 : 0;
    return status;
}
