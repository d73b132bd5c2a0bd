// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna precursors FILE: indicators and forecasts, at the end of the data or all along them.
#include "cli/precursors/precursors.h"

#include <math.h>
#include <stdlib.h>

#include "base/statistics.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/report/report.h"
#include "data/dataset.h"
#include "fit/model_forecast.h"
#include "store/store.h"
#include "store/store_file.h"

enum { EVENT_TIME, EVENT_DURATION, EVENT_MOMENT, TIME, N_SLIP, N_TOT, LENGTH, CRITICAL, VALUES };

// What a source holds besides its motion: of a run its events and cells.
typedef struct cells {
    lac_stored_values value[VALUES]; // durations of events turn into their ends
    lac_event_list events;
    lac_slip_history slip;
    lac_indicator_inputs inputs; // of the two above; points into this
} cells;

// Whether all that stands in [first, last] is there.
static bool has_all(const cells *c, size_t first, size_t last)
{
    while (first <= last && c->value[first].value != NULL) {
        first++;
    }
    return first > last;
}

// An event, to be put in the order of starts.
typedef struct event {
    double time, end, moment;
} event;

// The events in the order of their starts, on the series' clock.
static lac_status sort_events(cells *c, double start, lac_error *err)
{
    const size_t n = c->value[EVENT_TIME].n;
    double *time = c->value[EVENT_TIME].value, *end = c->value[EVENT_DURATION].value;
    double *moment = c->value[EVENT_MOMENT].value;
    event *list = malloc((n > 0 ? n : 1) * sizeof *list);
    size_t kept = 0;
    LAC_FAIL_MEMORY_IF(list == NULL, err);
    for (size_t i = 0; i < n; i++) {
        const double from = time[i] + start, to = time[i] + end[i] + start;
        if (isfinite(from) && isfinite(to)) {
            list[kept++] = (event){from, to, moment[i]};
        }
    }
    qsort(list, kept, sizeof *list, lac_by_first);
    for (size_t i = 0; i < kept; i++) {
        time[i] = list[i].time;
        end[i] = list[i].end;
        moment[i] = list[i].moment;
    }
    free(list);
    c->events = (lac_event_list){.n = kept, .time = time, .moment = moment, .end = end};
    return LAC_OK;
}

// The records of slipping blocks, on the series' clock.
static void take_slip(cells *c, double start)
{
    const lac_stored_values *v = c->value;
    size_t n = v[TIME].n < v[N_SLIP].n ? v[TIME].n : v[N_SLIP].n;
    n = n < v[LENGTH].n ? n : v[LENGTH].n;
    for (size_t i = 0; i < n; i++) {
        v[TIME].value[i] += start;
    }
    c->slip = (lac_slip_history){.n = n,
                                 .levels = v[N_SLIP].width,
                                 .time = v[TIME].value,
                                 .n_slip = v[N_SLIP].value,
                                 .n_tot = v[N_TOT].value,
                                 .length = v[LENGTH].value,
                                 .critical_fraction =
                                     v[CRITICAL].value != NULL ? v[CRITICAL].value[0] : NAN};
}

// Where what it reads ends is cut off at each time of issue.
static lac_status read_cells(const cli_watched *watched, cells *c, lac_error *err)
{
    static const char *const names[VALUES] = {
        "event_time", "event_duration", "event_moment",       "time",
        "n_slip",     "n_tot",          "correlation_length", "critical_fraction"};
    lac_stored_file *file = NULL;
    lac_status status = LAC_OK;
    *c = (cells){.inputs = lac_evidence_default()};
    if (!watched->run) {
        return LAC_OK;
    }
    LAC_TRY(lac_stored_file_open(watched->of.source, &file, err));
    for (size_t i = 0; i < VALUES; i++) {
        LAC_TRY(lac_stored_file_values(file, names[i], &c->value[i], err));
    }
    if (has_all(c, EVENT_TIME, EVENT_MOMENT)) {
        LAC_TRY(sort_events(c, watched->start, err));
        c->inputs.events = &c->events;
    }
    if (has_all(c, TIME, LENGTH)) {
        take_slip(c, watched->start);
        c->inputs.slip = &c->slip;
    }
out:
    lac_stored_file_close(file);
    return status;
}

typedef struct precursors_job {
    const cli_request *request;
    lac_units *units;
    lac_case *source; // the slope's own model, with --case
    lac_fit_watch watch;
    lac_model_forecast how;
    lac_forecast_model model;
    cli_watched watched;
    cli_forecast_plan plan;
    cells cells;
    lac_precursor indicator[LAC_PRECURSORS_MAX];
} precursors_job;

// The case that forecasts beside the methods that know only the motion.
static lac_status read_case(precursors_job *job, lac_error *err)
{
    cli_request of_case = *job->request;
    const char *path = of_case.argument[0] = of_case.forecast.case_file;
    if (path == NULL) {
        return of_case.set_count == 0
                   ? LAC_OK
                   : lac_fail(err, LAC_EINPUT, "--set: overrides a case: --case names one");
    }
    const lac_status status = cli_case_read(&of_case, LAC_FOR_FIT, &job->source, NULL, err);
    job->watch.interrupted = cli_signals_stop;
    job->how = (lac_model_forecast){.source = job->source,
                                    .threads = of_case.threads > 0 ? of_case.threads : 1,
                                    .watch = &job->watch};
    job->model = lac_model_forecast_method(&job->how);
    return status;
}

static bool go_on(void *context, size_t done, size_t all)
{
    (void)context, (void)done, (void)all;
    return !cli_signals_stop(NULL);
}

static lac_status roll(precursors_job *job, lac_error *err)
{
    cli_watched *w = &job->watched;
    lac_forecast_outcome *of = &w->of;
    const size_t most = job->plan.issues < w->readings.n ? job->plan.issues : w->readings.n;
    lac_status status;
    LAC_TRY(lac_indicator_series_create(&job->cells.inputs, most, &of->indicator_series, err));
    const lac_rolling_watch watch = {
        .go_on = go_on, .seer = of->indicator_series, .see = lac_indicator_series_see};
    cli_say(job->request, "forecasting at %zu readings", w->readings.n);
    cli_signals_hold();
    status = lac_rolling_create(&job->plan.def, &w->readings, job->plan.issues, &watch,
                                &of->rolling, err);
    of->interrupted = status == LAC_EINTERRUPT && of->rolling != NULL;
    LAC_TRY(of->interrupted ? LAC_OK : status);
    if (!isnan(of->failed_at)) {
        of->skill = calloc(of->rolling->methods, sizeof *of->skill);
        LAC_TRY(of->skill != NULL ? LAC_OK : lac_fail_memory(err));
        LAC_TRY(lac_rolling_measure(of->rolling, of->failed_at, job->plan.horizon, of->skill, err));
    }
out:
    return status;
}

static lac_status write_file(const precursors_job *job, const lac_dataset *dataset, lac_error *err)
{
    const lac_case *c = job->source;
    char *text = c != NULL ? lac_case_text(c) : NULL;
    LAC_FAIL_MEMORY_IF(c != NULL && text == NULL, err);
    lac_provenance provenance = {.title = job->watched.of.source,
                                 .case_text = text,
                                 .seed = c != NULL ? c->fit.seed : INT64_MIN};
    cli_sign(job->request, &provenance);
    const lac_status status = lac_store_dataset(
        job->request->output, cli_given(job->request, CLI_OPT_FORCE), &provenance, dataset, err);
    free(text);
    return status;
}

static lac_status put_out(const precursors_job *job, lac_error *err)
{
    const cli_request *request = job->request;
    const lac_forecast_outcome *of = &job->watched.of;
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(lac_forecast_describe(of, &dataset, err));
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
        cli_precursors_print(of, cli_given(request, CLI_OPT_VERBOSE));
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
    lac_forecast_outcome *of = &job.watched.of;
    lac_status status;
    LAC_TRY(lac_units_create(&job.units, err));
    LAC_TRY(read_case(&job, err));
    if (request->output != NULL) {
        LAC_TRY(cli_output_check(request, job.source, request->output, err));
    }
    LAC_TRY(cli_watched_read(request, job.source, job.units, &job.watched, err));
    LAC_TRY(cli_forecast_plan_read(request, of->dated, job.units, &job.plan, err));
    of->horizon = job.plan.horizon;
    of->indicator = job.indicator;
    if (job.watched.run) { // a run has neither outliers nor resets
        job.plan.def.motion.raw = true;
    }
    if (job.source != NULL) {
        job.how.dated = of->dated;
        job.plan.def.model = &job.model;
        cli_signals_hold();
        cli_say(request, "fitting %s to %zu readings", job.source->path, job.watched.readings.n);
    }
    LAC_TRY(lac_forecast_set_create(&job.plan.def, &job.watched.readings, &of->forecasts, err));
    LAC_TRY(read_cells(&job.watched, &job.cells, err));
    LAC_TRY(
        lac_precursors_at(&job.cells.inputs, of->forecasts, job.indicator, &of->indicators, err));
    if (request->forecast.rolling != NULL) {
        LAC_TRY(roll(&job, err));
    }
    LAC_TRY(put_out(&job, err));
    LAC_LEAVE_IF(of->interrupted, err, LAC_EINTERRUPT, "interrupted after %zu issue times",
                 of->rolling->issues);
out:
    free(of->skill);
    lac_rolling_free(of->rolling);
    lac_indicator_series_free(of->indicator_series);
    for (size_t i = 0; i < VALUES; i++) {
        lac_stored_values_clear(&job.cells.value[i]);
    }
    lac_forecast_set_free(of->forecasts);
    cli_watched_clear(&job.watched);
    lac_case_free(job.source);
    lac_units_free(job.units);
    return status;
}
