// SPDX-License-Identifier: GPL-3.0-or-later
// All indicators of coming failure, looked at together at one time after the other, each of nothing
// but what was known then; one that lacks its data says what it needs.
#include "precursor/kinds.h"

static const lac_precursor_kind *const kinds[] = {
    &lac_precursor_slip_fraction, &lac_precursor_length,          &lac_precursor_event_rate,
    &lac_precursor_b_value,       &lac_precursor_b_positive,      &lac_precursor_moment,
    &lac_precursor_slowing,       &lac_precursor_log_periodicity,
};

LAC_KINDS_AT(lac_precursor_kind, lac_precursor_kind_get, kinds)

const char *lac_needs_name(lac_needs needs)
{
    static const char *const names[] = {
        [LAC_NEEDS_MOTION] = "series", [LAC_NEEDS_EVENTS] = "events", [LAC_NEEDS_CELLS] = "cells"};
    return names[needs];
}

double lac_precursor_find(const lac_precursor *found, const char *key)
{
    for (size_t i = 0; i < found->found.count; i++) {
        if (strcmp(found->found.value[i].key, key) == 0) {
            return found->found.value[i].value;
        }
    }
    return NAN;
}

lac_status lac_precursors_evaluate(const lac_precursor_inputs *in, lac_precursor *out,
                                   size_t *count, lac_error *err)
{
    const lac_precursor_kind *kind;
    for (*count = 0; (kind = lac_precursor_kind_get(*count)) != NULL; (*count)++) {
        lac_precursor *p = &out[*count];
        *p = (lac_precursor){.kind = kind};
        if (kind->needs == LAC_NEEDS_EVENTS && in->events == NULL) {
            (void)lac_forecast_fit_refuse(
                &p->found,
                "needs a catalogue of events: a run of a case with analysis: {events: ...}");
        } else if (kind->needs == LAC_NEEDS_CELLS && in->slip == NULL) {
            (void)lac_forecast_fit_refuse(&p->found,
                                          "needs cells: a run of a case with analysis: {rg: ...}");
        } else {
            LAC_TRY_RETURN(kind->evaluate(in, &p->found, err));
        }
    }
    return LAC_OK;
}

// The events that had ended by `now`, in the order of their starts. @param room  [2][events]
static lac_event_list keep_events(const lac_event_list *all, double now, double *room)
{
    double *moment = room + all->n;
    size_t n = 0;
    for (size_t i = 0; i < all->n; i++) {
        if ((all->end != NULL ? all->end[i] : all->time[i]) <= now) {
            room[n] = all->time[i];
            moment[n++] = all->moment[i];
        }
    }
    return (lac_event_list){.n = n, .time = room, .moment = moment};
}

static lac_slip_history keep_slip(const lac_slip_history *all, double now)
{
    lac_slip_history past = *all;
    while (past.n > 0 && (!(past.time[past.n - 1] <= now) || isnan(past.length[past.n - 1]))) {
        past.n--;
    }
    return past;
}

static void set_time_of_failure(const lac_forecast_set *o, lac_precursor_inputs *in)
{
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        if (f->kind->dates && f->issued) {
            in->tc = f->raw_time; // what the law itself fits
            in->start = f->window_start;
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
    double *room = NULL;
    lac_event_list events;
    lac_slip_history slip;
    lac_precursor_inputs in = {.motion = forecasts->motion,
                               .tc = NAN,
                               .start = NAN,
                               .seed = inputs->seed,
                               .surrogates = inputs->surrogates};
    set_time_of_failure(forecasts, &in);
    if (inputs->events != NULL) {
        room = malloc((2 * inputs->events->n + 1) * sizeof *room);
        LAC_FAIL_MEMORY_IF(room == NULL, err);
        events = keep_events(inputs->events, forecasts->issue_time, room);
        in.events = &events;
    }
    if (inputs->slip != NULL) {
        slip = keep_slip(inputs->slip, forecasts->issue_time);
        in.slip = &slip;
    }
    const lac_status status = lac_precursors_evaluate(&in, out, count, err);
    free(room);
    return status;
}

lac_status lac_indicator_series_create(const lac_indicator_inputs *inputs, size_t most,
                                       lac_indicator_series **out, lac_error *err)
{
    const size_t all = sizeof kinds / sizeof *kinds;
    lac_indicator_series *s = calloc(1, sizeof *s + most * all * sizeof *s->found);
    *out = s;
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    *s = (lac_indicator_series){.inputs = inputs, .most = most, .kinds = all};
    s->found = (lac_precursor *)(s + 1);
    return LAC_OK;
}

void lac_indicator_series_free(lac_indicator_series *indicator_series) { free(indicator_series); }

lac_status lac_indicator_series_see(void *context, const lac_forecast_set *forecasts,
                                    lac_error *err)
{
    lac_indicator_series *s = context;
    size_t count = 0;
    LAC_TRY_RETURN(
        lac_precursors_at(s->inputs, forecasts, s->found + s->issues * s->kinds, &count, err));
    s->issues++;
    return LAC_OK;
}
