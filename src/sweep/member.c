// SPDX-License-Identifier: GPL-3.0-or-later
// One member of a sweep: its case read, run and seen at even times.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"
#include "lacuna/simulation.h"
#include "sweep/ensemble.h"

// The slip rate on the common axis, between records along a line of its logarithm.
typedef struct watcher {
    lac_member *out;
    double step; // of the axis [s]
    size_t next; // place that is yet to be passed
    double time, rate;
} watcher;

static lac_status see(void *context, const lac_record *record, lac_error *err)
{
    watcher *w = context;
    const double t = record->time_origin + record->time_local;
    const double rate = fabs(record->observation.mean_rate);
    (void)err;
    for (; w->next < LAC_MEMBER_RECORDS && (double)w->next * w->step <= t; w->next++) {
        const double at = (double)w->next * w->step;
        const double part = t > w->time ? (at - w->time) / (t - w->time) : 1.0;
        const bool both = rate > 0.0 && w->rate > 0.0;
        w->out->rate[w->next] = (float)(both           ? w->rate * pow(rate / w->rate, part)
                                        : w->next == 0 ? rate
                                                       : NAN);
    }
    w->time = t;
    w->rate = rate;
    return LAC_OK;
}

static void take(const lac_run_result *r, watcher *w)
{
    lac_member *m = w->out;
    m->failed = r->failed;
    m->end = (int)r->end;
    m->failure_time = r->failed ? r->failure_origin + r->failure_local : NAN;
    m->time = r->time;
    m->mean_slip = r->mean_slip;
    m->max_slip_rate = r->max_slip_rate;
    m->least_safety = r->safety.least;
    m->steps = (double)r->steps;
    for (size_t k = w->next; k < LAC_MEMBER_RECORDS; k++) {
        m->rate[k] = r->failed ? INFINITY : NAN;
    }
}

// Reads the case with the member's values, each of which may stand at several keys.
static lac_status read_case(const lac_sweep *sweep, size_t member, const char *path,
                            const lac_override *set, size_t count, lac_case **c, lac_error *err)
{
    size_t keys = 0, n = count;
    for (size_t p = 0; p < sweep->params; p++) {
        for (const char *at = sweep->param[p].key; at != NULL; at = strchr(at + 1, '+')) {
            keys++;
        }
    }
    lac_override *all = malloc((count + keys + 1) * sizeof *all);
    char(*value)[LAC_SWEEP_TEXT] = malloc((sweep->params + 1) * sizeof *value);
    char *key = malloc(1), *names = key;
    lac_status status = all != NULL && value != NULL && key != NULL ? LAC_OK : lac_fail_memory(err);
    free(names);
    names = NULL;
    for (size_t i = 0; status == LAC_OK && i < count; i++) {
        all[i] = set[i];
    }
    for (size_t p = 0; status == LAC_OK && p < sweep->params; p++) {
        const char *text = lac_sweep_text(sweep, member, p, value[p]);
        char *copy = text != NULL ? strdup(sweep->param[p].key) : NULL, *rest = copy;
        for (char *one; copy != NULL && (one = strsep(&rest, "+")) != NULL;) {
            all[n++] = (lac_override){strdup(one), text};
        }
        free(copy);
    }
    if (status == LAC_OK) {
        const lac_case_request how = {LAC_FOR_RUN, all, n};
        char text[512];
        lac_case_issues report = {0};
        status = lac_case_read(path, &how, c, &report, err);
        for (size_t i = report.count; status != LAC_OK && i-- > 0;) {
            if (!report.issue[i].warning) { // the first one stays
                (void)lac_fail(err, status, "%s",
                               lac_case_issue_format(&report.issue[i], text, sizeof text));
            }
        }
        lac_case_issues_clear(&report);
    }
    for (size_t i = count; all != NULL && i < n; i++) {
        free((char *)all[i].key);
    }
    free(all);
    free(value);
    return status;
}

lac_status lac_member_run(const lac_sweep *sweep, size_t member, const char *path,
                          const lac_override *set, size_t count, lac_member *out, lac_error *err)
{
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_error why = {""};
    *out = (lac_member){.done = true,
                        .failure_time = NAN,
                        .time = NAN,
                        .mean_slip = NAN,
                        .max_slip_rate = NAN,
                        .least_safety = NAN,
                        .steps = NAN};
    for (size_t k = 0; k < LAC_MEMBER_RECORDS; k++) {
        out->rate[k] = NAN;
    }
    lac_status status = read_case(sweep, member, path, set, count, &c, &why);
    if (status == LAC_OK) {
        c->run.beyond = 0;
        status = lac_simulation_create(c, NULL, &simulation, &why);
    }
    if (status == LAC_OK) {
        watcher w = {.out = out, .step = c->run.end / (double)(LAC_MEMBER_RECORDS - 1)};
        lac_sink sink = lac_sink_default();
        sink.context = &w;
        sink.record = see;
        status = lac_simulation_run(simulation, &sink, &why);
        if (status == LAC_OK) {
            take(lac_simulation_result(simulation), &w);
        }
    }
    lac_simulation_free(simulation);
    lac_case_free(c);
    if (status == LAC_EINTERRUPT || status == LAC_ENOMEM) {
        return lac_fail(err, status, "%s", why.message);
    }
    if (status != LAC_OK) {
        (void)snprintf(out->message, sizeof out->message, "%s", why.message);
    }
    return LAC_OK;
}
