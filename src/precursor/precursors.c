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

static lac_status see(void *context, const lac_forecast_set *forecasts, lac_error *err)
{
    lac_indicator_series *s = context;
    size_t count = 0;
    LAC_TRY_RETURN(
        lac_precursors_at(s->inputs, forecasts, s->found + s->issues * s->kinds, &count, err));
    s->issues++;
    return LAC_OK;
}

static lac_status roll(const lac_forecast_def *def, const lac_indicator_inputs *inputs,
                       size_t issues, const lac_rolling_watch *watch, lac_forecast_outcome *of,
                       lac_error *err)
{
    lac_rolling_watch own = watch != NULL ? *watch : (lac_rolling_watch){0};
    if (own.see == NULL) {
        const size_t all = sizeof kinds / sizeof *kinds;
        const size_t most = issues < of->readings->n ? issues : of->readings->n;
        lac_indicator_series *s = calloc(1, sizeof *s + most * all * sizeof *s->found);
        LAC_FAIL_MEMORY_IF(s == NULL, err);
        s->inputs = inputs;
        s->kinds = all;
        own.seer = of->indicator_series = s;
        own.see = see;
    }
    const lac_status status =
        lac_rolling_create(def, of->readings, issues, &own, &of->rolling, err);
    of->interrupted = status == LAC_EINTERRUPT && of->rolling != NULL;
    if ((status != LAC_OK && !of->interrupted) || isnan(of->failed_at)) {
        return status;
    }
    of->skill = calloc(of->rolling->methods, sizeof *of->skill);
    LAC_FAIL_MEMORY_IF(of->skill == NULL, err);
    LAC_TRY_RETURN(lac_rolling_measure(of->rolling, of->failed_at, of->horizon, of->skill, err));
    return status;
}

lac_status lac_forecast_look(const lac_forecast_def *def, const lac_indicator_inputs *inputs,
                             size_t issues, const lac_rolling_watch *watch,
                             lac_forecast_outcome *of, lac_error *err)
{
    lac_forecast_def last = *def;
    last.all = true; // what would be forecast without the gate
    LAC_TRY_RETURN(lac_forecast_set_create(&last, of->readings, &of->forecasts, err));
    LAC_TRY_RETURN(lac_precursors_at(inputs, of->forecasts, of->indicator, &of->indicators, err));
    return issues > 0 ? roll(def, inputs, issues, watch, of, err) : LAC_OK;
}

void lac_forecast_outcome_clear(lac_forecast_outcome *of)
{
    free(of->skill);
    lac_rolling_free(of->rolling);
    free(of->indicator_series);
    lac_forecast_set_free(of->forecasts);
}
