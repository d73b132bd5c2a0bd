// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna precursors FILE: indicators and forecasts, at the end of the data or all along them.
#include "cli/precursors/precursors.h"

#include <math.h>
#include <stdlib.h>

#include "base/statistics.h"
#include "cli/common/command.h"
#include "cli/common/libraries.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "data/dataset.h"
#include "store/store.h"
#include "store/store_file.h"

// What a source holds besides its motion: of a run its events and cells.
typedef struct cells {
    lac_stored_values event_time, event_duration, event_moment; // the second turns into ends
    lac_stored_values time, n_slip, n_tot, length, critical;
    lac_event_list events;
    lac_slip_history slip;
    lac_evidence evidence; // of the two above; points into this
} cells;

static void cells_clear(cells *c)
{
    lac_stored_values *const all[] = {&c->event_time, &c->event_duration, &c->event_moment,
                                      &c->time,       &c->n_slip,         &c->n_tot,
                                      &c->length,     &c->critical};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        lac_stored_values_clear(all[i]);
    }
}

static lac_status read_values(const char *path, cells *c, lac_error *err)
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
static lac_status sort_events(cells *c, double start, lac_error *err)
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
static void take_slip(cells *c, double start)
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

// Where what it reads ends is cut off at each time of issue.
static lac_status read_cells(const cli_watched *watched, cells *out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = (cells){.evidence = lac_evidence_default()};
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

typedef struct precursors_job {
    const cli_request *request;
    lac_units *units;
    cli_foreseer foreseer;
    cli_watched watched;
    cli_forecast_plan plan;
    lac_outlook *outlook;
    cells cells;
    size_t indicators;
    lac_precursor indicator[LAC_PRECURSORS_MAX];
    lac_rolling *rolling;
    bool interrupted;
    lac_precursor_course *course;
    lac_skill *skill;
} precursors_job;

static bool go_on(void *context, size_t done, size_t all)
{
    (void)context, (void)done, (void)all;
    return !cli_signals_stop();
}

static lac_status roll(precursors_job *job, lac_error *err)
{
    const cli_watched *w = &job->watched;
    const size_t most = job->plan.issues < w->readings.n ? job->plan.issues : w->readings.n;
    lac_status status;
    LAC_TRY(lac_precursor_course_create(&job->cells.evidence, most, &job->course, err));
    const lac_rolling_watch watch = {
        .go_on = go_on, .seer = job->course, .see = lac_precursor_course_see};
    cli_say(job->request, "forecasting at %zu readings", w->readings.n);
    cli_signals_hold();
    status = lac_rolling_create(&job->plan.def, &w->readings, job->plan.issues, &watch,
                                &job->rolling, err);
    job->interrupted = status == LAC_EINTERRUPT && job->rolling != NULL;
    LAC_TRY(job->interrupted ? LAC_OK : status);
    if (!isnan(w->failed_at)) {
        job->skill = calloc(job->rolling->methods, sizeof *job->skill);
        LAC_TRY(job->skill != NULL ? LAC_OK : lac_fail_memory(err));
        LAC_TRY(
            lac_rolling_measure(job->rolling, w->failed_at, job->plan.horizon, job->skill, err));
    }
out:
    return status;
}

static lac_status write_file(const precursors_job *job, const lac_dataset *dataset, lac_error *err)
{
    char libraries[256];
    const lac_case *c = job->foreseer.source;
    char *text = c != NULL ? lac_case_text(c) : NULL;
    if (c != NULL && text == NULL) {
        return lac_fail_memory(err);
    }
    lac_provenance provenance = {
        .title = job->watched.path, .case_text = text, .seed = c != NULL ? c->fit.seed : INT64_MIN};
    cli_sign(job->request, cli_libraries(libraries, sizeof libraries), &provenance);
    const lac_status status = lac_store_dataset(
        job->request->output, cli_given(job->request, CLI_OPT_FORCE), &provenance, dataset, err);
    free(text);
    return status;
}

static lac_status put_out(const precursors_job *job, lac_error *err)
{
    const cli_request *request = job->request;
    const lac_forecast_outcome outcome = {.source = job->watched.path,
                                          .series = job->watched.series,
                                          .readings = &job->watched.readings,
                                          .dated = job->watched.dated,
                                          .failed_at = job->watched.failed_at,
                                          .horizon = job->plan.horizon,
                                          .outlook = job->outlook,
                                          .indicators = job->indicators,
                                          .indicator = job->indicator,
                                          .rolling = job->rolling,
                                          .interrupted = job->interrupted,
                                          .course = job->course,
                                          .skill = job->skill};
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(lac_forecast_describe(&outcome, &dataset, err));
    if (request->output != NULL) {
        LAC_TRY(write_file(job, dataset, err));
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        lac_json_open(&json, NULL, '{');
        lac_dataset_json(dataset, &json);
        lac_json_text(&json, "output", request->output);
        lac_json_close(&json, '}');
    } else {
        cli_precursors_print(&outcome, &job->watched, cli_given(request, CLI_OPT_VERBOSE));
        if (request->output != NULL) {
            printf("\n");
            cli_row("file", "%s", request->output);
        }
    }
out:
    lac_dataset_free(dataset);
    return status;
}

lac_status cli_precursors(const cli_request *request, lac_error *err)
{
    precursors_job job = {.request = request};
    lac_status status;
    LAC_TRY(lac_units_create(&job.units, err));
    LAC_TRY(cli_foreseer_read(request, &job.foreseer, err));
    if (request->output != NULL) {
        LAC_TRY(cli_output_check(request, job.foreseer.source, request->output, err));
    }
    LAC_TRY(cli_watched_read(&job.foreseer.named, job.units, &job.watched, err));
    LAC_TRY(cli_forecast_plan_read(request, job.watched.dated, job.units, &job.plan, err));
    if (job.watched.run) { // a run has neither outliers nor resets
        job.plan.def.motion.raw = true;
    }
    if (job.foreseer.source != NULL) {
        job.foreseer.how.dated = job.watched.dated;
        job.plan.def.model = &job.foreseer.model;
        cli_signals_hold();
        cli_say(request, "fitting %s to %zu readings", job.foreseer.source->path,
                job.watched.readings.n);
    }
    LAC_TRY(lac_outlook_create(&job.plan.def, &job.watched.readings, &job.outlook, err));
    LAC_TRY(read_cells(&job.watched, &job.cells, err));
    LAC_TRY(
        lac_precursors_at(&job.cells.evidence, job.outlook, job.indicator, &job.indicators, err));
    if (request->forecast.rolling != NULL) {
        LAC_TRY(roll(&job, err));
    }
    LAC_TRY(put_out(&job, err));
    if (job.interrupted) {
        LAC_TRY(lac_fail(err, LAC_EINTERRUPT, "interrupted after %zu issue times",
                         job.rolling->issues));
    }
out:
    free(job.skill);
    lac_rolling_free(job.rolling);
    lac_precursor_course_free(job.course);
    cells_clear(&job.cells);
    lac_outlook_free(job.outlook);
    cli_watched_clear(&job.watched);
    cli_foreseer_clear(&job.foreseer);
    lac_units_free(job.units);
    return status;
}
