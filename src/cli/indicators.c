// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/indicators.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/store_events.h"

enum { SEED = 1, SURROGATES = 199 };

// What the file of a run holds besides its motion.
typedef struct run_cells {
    lac_stored_values event_time, event_duration, event_moment;
    lac_stored_values time, n_slip, n_tot, length, critical;
    lac_event_list events;
    lac_slip_history slip;
} run_cells;

static void clear(run_cells *r)
{
    lac_stored_values *const all[] = {&r->event_time, &r->event_duration, &r->event_moment,
                                      &r->time,       &r->n_slip,         &r->n_tot,
                                      &r->length,     &r->critical};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        lac_stored_values_clear(all[i]);
    }
}

static lac_status read_cells(const char *path, run_cells *r, lac_error *err)
{
    const struct {
        const char *name;
        lac_stored_values *to;
    } wanted[] = {
        {"event_time", &r->event_time},
        {"event_duration", &r->event_duration},
        {"event_moment", &r->event_moment},
        {"time", &r->time},
        {"n_slip", &r->n_slip},
        {"n_tot", &r->n_tot},
        {"correlation_length", &r->length},
        {"critical_fraction", &r->critical},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        LAC_TRY(lac_store_read_values(path, wanted[i].name, wanted[i].to, err));
    }
out:
    return status;
}

// An event by its start and moment, to be put in the order of starts.
typedef struct event {
    double time, moment;
} event;

static int compare(const void *left, const void *right)
{
    const double a = ((const event *)left)->time;
    const double b = ((const event *)right)->time;
    return (a > b) - (a < b);
}

// The events that have ended by `now`, in the order of their starts, on the series' clock.
static lac_status keep_events(run_cells *r, double start, double now, lac_error *err)
{
    const size_t n = r->event_time.n;
    event *list = malloc((n > 0 ? n : 1) * sizeof *list);
    size_t kept = 0;
    if (list == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < n; i++) {
        if (r->event_time.value[i] + r->event_duration.value[i] + start <= now) {
            list[kept++] = (event){r->event_time.value[i] + start, r->event_moment.value[i]};
        }
    }
    qsort(list, kept, sizeof *list, compare);
    for (size_t i = 0; i < kept; i++) {
        r->event_time.value[i] = list[i].time;
        r->event_moment.value[i] = list[i].moment;
    }
    free(list);
    r->events = (lac_event_list){kept, r->event_time.value, r->event_moment.value};
    return LAC_OK;
}

// The records up to `now` that hold slipping blocks.
static void keep_slip(run_cells *r, double start, double now)
{
    size_t n = r->time.n < r->n_slip.n ? r->time.n : r->n_slip.n;
    n = n < r->length.n ? n : r->length.n;
    for (size_t i = 0; i < n; i++) {
        r->time.value[i] += start;
    }
    while (n > 0 && (!(r->time.value[n - 1] <= now) || isnan(r->length.value[n - 1]))) {
        n--;
    }
    r->slip = (lac_slip_history){.n = n,
                                 .levels = r->n_slip.width,
                                 .time = r->time.value,
                                 .n_slip = r->n_slip.value,
                                 .n_tot = r->n_tot.value,
                                 .length = r->length.value,
                                 .critical_fraction =
                                     r->critical.value != NULL ? r->critical.value[0] : NAN};
}

static void set_time_of_failure(const lac_outlook *o, lac_observed *seen)
{
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        if (strcmp(f->kind->about.name, "log") == 0 && f->issued) {
            seen->tc = f->time;
            seen->start = f->window_start;
        }
    }
}

lac_status cli_indicators_look(const cli_watched *watched, const lac_outlook *outlook,
                               cli_indicators *out, lac_error *err)
{
    run_cells r = {0};
    lac_observed seen = {
        .motion = outlook->motion, .tc = NAN, .start = NAN, .seed = SEED, .surrogates = SURROGATES};
    lac_status status = LAC_OK;
    set_time_of_failure(outlook, &seen);
    if (watched->run) {
        LAC_TRY(read_cells(watched->path, &r, err));
        const bool events = r.event_time.value != NULL && r.event_duration.value != NULL &&
                            r.event_moment.value != NULL;
        const bool cells = r.time.value != NULL && r.n_slip.value != NULL &&
                           r.n_tot.value != NULL && r.length.value != NULL;
        if (events) {
            LAC_TRY(keep_events(&r, watched->start, outlook->issue_time, err));
            seen.events = &r.events;
        }
        if (cells) {
            keep_slip(&r, watched->start, outlook->issue_time);
            seen.slip = &r.slip;
        }
    }
    LAC_TRY(lac_precursors_look(&seen, out->found, &out->count, err));
out:
    clear(&r);
    return status;
}

void cli_indicators_print(const cli_indicators *indicators)
{
    printf("\n  indicator\n");
    for (size_t k = 0; k < indicators->count; k++) {
        const lac_finding *found = &indicators->found[k].found;
        printf("  %-19s", indicators->found[k].kind->about.name);
        for (size_t i = 0; i < found->count; i++) {
            printf(" %s %.4g", found->value[i].key, found->value[i].value);
        }
        if (found->reason[0] != '\0') {
            printf("%s%s", found->count > 0 ? "; " : " none: ", found->reason);
        } else {
            printf(", %zu points", found->points);
        }
        printf("\n");
    }
}

static const char *needs_name(lac_needs needs)
{
    static const char *const names[] = {
        [LAC_NEEDS_MOTION] = "motion", [LAC_NEEDS_EVENTS] = "events", [LAC_NEEDS_CELLS] = "cells"};
    return names[needs];
}

void cli_indicators_json(cli_json *json, const cli_indicators *indicators)
{
    cli_json_open(json, "indicators", '[');
    for (size_t k = 0; k < indicators->count; k++) {
        const lac_precursor *p = &indicators->found[k];
        cli_json_open(json, NULL, '{');
        cli_json_text(json, "indicator", p->kind->about.name);
        cli_json_text(json, "needs", needs_name(p->kind->needs));
        cli_json_integer(json, "points", (int64_t)p->found.points);
        cli_json_text(json, "reason", p->found.reason[0] != '\0' ? p->found.reason : NULL);
        cli_json_open(json, "values", '{');
        for (size_t i = 0; i < p->found.count; i++) {
            cli_json_number(json, p->found.value[i].key, p->found.value[i].value);
        }
        cli_json_close(json, '}');
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}
