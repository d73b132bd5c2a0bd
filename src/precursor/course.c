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
    if (out->time == NULL || out->moment == NULL) {
        return lac_fail_memory(err);
    }
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

static void set_time_of_failure(const lac_outlook *o, lac_observed *seen)
{
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        if (f->kind->dates && f->issued) {
            seen->tc = f->time;
            seen->start = f->window_start;
        }
    }
}

lac_evidence lac_evidence_default(void) { return (lac_evidence){.seed = 1, .surrogates = 199}; }

lac_status lac_precursors_at(const lac_evidence *evidence, const lac_outlook *outlook,
                             lac_precursor *out, size_t *count, lac_error *err)
{
    past_events events = {0};
    lac_slip_history slip;
    lac_observed seen = {.motion = outlook->motion,
                         .tc = NAN,
                         .start = NAN,
                         .seed = evidence->seed,
                         .surrogates = evidence->surrogates};
    lac_status status = LAC_OK;
    set_time_of_failure(outlook, &seen);
    if (evidence->events != NULL) {
        LAC_TRY(keep_events(evidence->events, outlook->issue_time, &events, err));
        seen.events = &events.list;
    }
    if (evidence->slip != NULL) {
        slip = keep_slip(evidence->slip, outlook->issue_time);
        seen.slip = &slip;
    }
    LAC_TRY(lac_precursors_look(&seen, out, count, err));
out:
    free(events.time);
    free(events.moment);
    return status;
}

lac_status lac_precursor_course_create(const lac_evidence *evidence, size_t most,
                                       lac_precursor_course **out, lac_error *err)
{
    lac_precursor_course *course = calloc(1, sizeof *course);
    *out = NULL;
    if (course == NULL) {
        return lac_fail_memory(err);
    }
    *course = (lac_precursor_course){.evidence = evidence, .most = most};
    while (lac_precursor_kind_at(course->kinds) != NULL) {
        course->kinds++;
    }
    course->found = calloc(most * course->kinds, sizeof *course->found);
    if (course->found == NULL) {
        free(course);
        return lac_fail_memory(err);
    }
    *out = course;
    return LAC_OK;
}

void lac_precursor_course_free(lac_precursor_course *course)
{
    if (course != NULL) {
        free(course->found);
        free(course);
    }
}

lac_status lac_precursor_course_see(void *context, const lac_outlook *outlook, lac_error *err)
{
    lac_precursor_course *course = context;
    size_t count = 0;
    lac_precursor *found = course->found + course->issues * course->kinds;
    lac_status status = lac_precursors_at(course->evidence, outlook, found, &count, err);
    course->issues += status == LAC_OK ? 1 : 0;
    return status;
}
