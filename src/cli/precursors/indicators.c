// SPDX-License-Identifier: GPL-3.0-or-later
// The events and cells of a run, from which `precursors` has its indicators; how those are shown.
#include "cli/precursors/precursors.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/statistics.h"
#include "store/store_file.h"

void cli_cells_clear(cli_cells *cells)
{
    lac_stored_values *const all[] = {
        &cells->event_time, &cells->event_duration, &cells->event_moment, &cells->time,
        &cells->n_slip,     &cells->n_tot,          &cells->length,       &cells->critical};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        lac_stored_values_clear(all[i]);
    }
}

static lac_status read_values(const char *path, cli_cells *c, lac_error *err)
{
    const struct {
        const char *name;
        lac_stored_values *to;
    } wanted[] = {
        {"event_time", &c->event_time},
        {"event_duration", &c->event_duration},
        {"event_moment", &c->event_moment},
        {"time", &c->time},
        {"n_slip", &c->n_slip},
        {"n_tot", &c->n_tot},
        {"correlation_length", &c->length},
        {"critical_fraction", &c->critical},
    };
    lac_stored_file *file = NULL;
    lac_status status = LAC_OK;
    LAC_TRY(lac_stored_file_open(path, &file, err));
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        LAC_TRY(lac_stored_file_values(file, wanted[i].name, wanted[i].to, err));
    }
out:
    lac_stored_file_close(file);
    return status;
}

// An event, to be put in the order of starts.
typedef struct event {
    double time, end, moment;
} event;

// The events in the order of their starts, on the series' clock.
static lac_status sort_events(cli_cells *c, double start, lac_error *err)
{
    const size_t n = c->event_time.n;
    event *list = malloc((n > 0 ? n : 1) * sizeof *list);
    size_t kept = 0;
    if (list == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < n; i++) {
        const double from = c->event_time.value[i] + start;
        const double to = c->event_time.value[i] + c->event_duration.value[i] + start;
        if (isfinite(from) && isfinite(to)) {
            list[kept++] = (event){from, to, c->event_moment.value[i]};
        }
    }
    qsort(list, kept, sizeof *list, lac_by_first);
    for (size_t i = 0; i < kept; i++) {
        c->event_time.value[i] = list[i].time;
        c->event_duration.value[i] = list[i].end;
        c->event_moment.value[i] = list[i].moment;
    }
    free(list);
    c->events = (lac_event_list){.n = kept,
                                 .time = c->event_time.value,
                                 .moment = c->event_moment.value,
                                 .end = c->event_duration.value};
    return LAC_OK;
}

// The records of slipping blocks, on the series' clock.
static void take_slip(cli_cells *c, double start)
{
    size_t n = c->time.n < c->n_slip.n ? c->time.n : c->n_slip.n;
    n = n < c->length.n ? n : c->length.n;
    for (size_t i = 0; i < n; i++) {
        c->time.value[i] += start;
    }
    c->slip = (lac_slip_history){.n = n,
                                 .levels = c->n_slip.width,
                                 .time = c->time.value,
                                 .n_slip = c->n_slip.value,
                                 .n_tot = c->n_tot.value,
                                 .length = c->length.value,
                                 .critical_fraction =
                                     c->critical.value != NULL ? c->critical.value[0] : NAN};
}

lac_status cli_cells_read(const cli_watched *watched, cli_cells *out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = (cli_cells){.evidence = lac_evidence_default()};
    if (!watched->run) {
        return LAC_OK;
    }
    LAC_TRY(read_values(watched->path, out, err));
    if (out->event_time.value != NULL && out->event_duration.value != NULL &&
        out->event_moment.value != NULL) {
        LAC_TRY(sort_events(out, watched->start, err));
        out->evidence.events = &out->events;
    }
    if (out->time.value != NULL && out->n_slip.value != NULL && out->n_tot.value != NULL &&
        out->length.value != NULL) {
        take_slip(out, watched->start);
        out->evidence.slip = &out->slip;
    }
out:
    return status;
}

void cli_indicators_print(size_t count, const lac_precursor *indicator)
{
    printf("\n  indicator\n");
    for (size_t k = 0; k < count; k++) {
        const lac_finding *found = &indicator[k].found;
        printf("  %-19s", indicator[k].kind->about.name);
        for (size_t i = 0; i < found->count; i++) {
            const double value = found->value[i].value;
            printf(isnan(value) ? " %s -" : " %s %.4g", found->value[i].key, value);
        }
        if (found->reason[0] != '\0') {
            printf("%s%s", found->count > 0 ? "; " : " none: ", found->reason);
        } else {
            printf(", %zu points", found->points);
        }
        printf("\n");
    }
}

// What a table shows of an indicator; NaN: it has nothing to say.
static double headline(const lac_precursor *p)
{
    return lac_precursor_find(p, p->kind->value[p->kind->headline].key);
}

// Which kinds a table shows: those that say something at some time.
static size_t find_shown(const lac_precursor_course *course, size_t *shown)
{
    size_t count = 0;
    for (size_t k = 0; k < course->kinds; k++) {
        bool any = false;
        for (size_t i = 0; i < course->issues; i++) {
            any = any || !isnan(headline(&course->found[i * course->kinds + k]));
        }
        if (any) {
            shown[count++] = k;
        }
    }
    return count;
}

static void print_heads(size_t count, const size_t *shown)
{
    printf("\n  indicators            ");
    for (size_t k = 0; k < count; k++) {
        printf(" %18s", lac_precursor_kind_at(shown[k])->about.name);
    }
    printf("\n  %-22s", "");
    for (size_t k = 0; k < count; k++) {
        const lac_precursor_kind *kind = lac_precursor_kind_at(shown[k]);
        printf(" %18s", kind->value[kind->headline].key);
    }
    printf("\n");
}

void cli_course_print(const cli_precursors_result *r)
{
    const lac_precursor_course *course = r->course;
    size_t shown[LAC_PRECURSORS_MAX];
    const size_t count = find_shown(course, shown);
    char text[40];
    if (count == 0) {
        return;
    }
    print_heads(count, shown);
    for (size_t i = 0; i < course->issues; i++) {
        double value[LAC_PRECURSORS_MAX];
        bool any = false;
        for (size_t k = 0; k < count; k++) {
            value[k] = headline(&course->found[i * course->kinds + shown[k]]);
            any = any || !isnan(value[k]);
        }
        if (!any) {
            continue;
        }
        printf("  %-22s",
               cli_watched_time(r->watched, r->rolling->issue_time[i], text, sizeof text));
        for (size_t k = 0; k < count; k++) {
            (void)snprintf(text, sizeof text, isnan(value[k]) ? "." : "%.4g", value[k]);
            printf(" %18s", text);
        }
        printf("\n");
    }
}

void cli_indicators_json(lac_json *json, size_t count, const lac_precursor *indicator)
{
    lac_json_open(json, "indicators", '[');
    for (size_t k = 0; k < count; k++) {
        const lac_precursor *p = &indicator[k];
        lac_json_open(json, NULL, '{');
        lac_json_text(json, "indicator", p->kind->about.name);
        lac_json_text(json, "needs", lac_needs_name(p->kind->needs));
        lac_json_integer(json, "points", (int64_t)p->found.points);
        lac_json_text(json, "reason", p->found.reason[0] != '\0' ? p->found.reason : NULL);
        lac_json_open(json, "values", '{');
        for (size_t i = 0; i < p->found.count; i++) {
            lac_json_number(json, p->found.value[i].key, p->found.value[i].value);
        }
        lac_json_close(json, '}');
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}
