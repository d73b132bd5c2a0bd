// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna precursors FILE: indicators and forecasts, at the end of the data or all along them.
#include "cli/precursors/precursors.h"

#include <sys/stat.h>

#include "base/statistics.h"
#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/pool.h"
#include "cli/report/report.h"
#include "fit/model_forecast.h"
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
    lac_json *json;      // that results go to; NULL: to the file alone
    const char *station; // the column, where there are several; NULL
    lac_units *units;
    lac_case *source; // the slope's own model, with --case
    lac_fit_watch watch;
    lac_model_forecast how;
    lac_forecast_model model;
    cli_watched watched;
    cli_forecast_plan plan;
    cells cells;
    cli_drivers drivers;
} precursors_job;

// The case that forecasts beside the methods that know only the motion.
static lac_status read_case(precursors_job *job, lac_error *err)
{
    cli_request of_case = *job->request;
    const char *path = of_case.argument[0] = of_case.forecast.case_file;
    int threads;
    LAC_TRY_RETURN(cli_pool_threads(&of_case, &threads, err));
    LAC_FAIL_IF(path == NULL && of_case.trade.jobs != NULL, err, LAC_EINPUT,
                "--jobs: is of the fits of a case: --case names one");
    if (path == NULL) {
        return of_case.set_count == 0
                   ? LAC_OK
                   : lac_fail(err, LAC_EINPUT, "--set: overrides a case: --case names one");
    }
    const lac_status status = cli_case_read(&of_case, LAC_FOR_FIT, &job->source, NULL, err);
    job->watch.interrupted = cli_signals_stop;
    job->how =
        (lac_model_forecast){.source = job->source, .threads = threads, .watch = &job->watch};
    job->model = lac_model_forecast_method(&job->how);
    return status;
}

static bool go_on(void *context, size_t done, size_t all)
{
    (void)done, (void)all;
    return !cli_signals_stop(context);
}

// The line of --jsonl.
static lac_status see(void *dated, const lac_forecast_set *forecasts, lac_error *err)
{
    lac_json json = {.out = stdout, .line = true};
    lac_dataset *issue = NULL;
    LAC_TRY_RETURN(lac_issue_describe(forecasts, *(const bool *)dated, &issue, err));
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(issue, &json);
    lac_json_close(&json, '}');
    lac_dataset_free(issue);
    return LAC_OK;
}

static lac_status look(precursors_job *job, lac_error *err)
{
    lac_forecast_outcome *of = &job->watched.of;
    const bool rolling = job->request->forecast.rolling != NULL;
    const bool lines = job->request->forecast.lines != NULL;
    const lac_rolling_watch watch = {.go_on = go_on, .seer = &of->dated, .see = lines ? see : NULL};
    if (rolling) {
        cli_say(job->request, "forecasting at %zu readings", job->watched.readings.n);
        cli_signals_hold();
    }
    const lac_status status = lac_forecast_look(&job->plan.def, &job->cells.inputs,
                                                rolling ? job->plan.issues : 0, &watch, of, err);
    return of->interrupted ? LAC_OK : status;
}

static lac_status write_file(const precursors_job *job, lac_dataset *dataset, lac_error *err)
{
    const lac_case *c = job->source;
    char *text = c != NULL ? lac_case_text(c) : NULL;
    LAC_FAIL_MEMORY_IF(c != NULL && text == NULL, err);
    lac_provenance provenance = {.title = job->watched.of.source,
                                 .case_text = text,
                                 .seed = c != NULL ? c->fit.seed : INT64_MIN};
    cli_sign(job->request, &provenance);
    const lac_status status = cli_put_dataset(job->request, cli_given(job->request, CLI_OPT_FORCE),
                                              &provenance, job->request->output, dataset, err);
    free(text);
    return status;
}

static lac_status put_out(const precursors_job *job, lac_error *err)
{
    const cli_request *request = job->request;
    const lac_forecast_outcome *of = &job->watched.of;
    lac_dataset *dataset = NULL;
    lac_status status;
    if (request->forecast.lines != NULL) { // they are out
        return LAC_OK;
    }
    LAC_TRY(lac_forecast_describe(of, &dataset, err));
    if (request->output != NULL || request->pipe != 0) {
        LAC_TRY(write_file(job, dataset, err));
    }
    if (job->json == NULL) {
        goto out;
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json_open(job->json, NULL, '{');
        if (job->station != NULL) {
            lac_json_text(job->json, "station", job->station);
        }
        lac_dataset_json(dataset, job->json);
        lac_json_text(job->json, "output", request->output);
        lac_json_close(job->json, '}');
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

// A window in which no two readings lie gives no velocity, and no method an answer.
static lac_status check_times(const precursors_job *job, lac_error *err)
{
    const lac_readings *r = &job->watched.readings;
    const lac_motion_def *motion = &job->plan.def.motion;
    const double last = r->time[r->n - 1];
    double least = INFINITY;
    LAC_FAIL_IF(job->plan.def.since > last, err, LAC_EINPUT,
                "--since: \"%s\" is after the last reading, %s", job->request->forecast.since,
                cli_watched_time(&job->watched.of, last).s);
    for (size_t i = 1; i < r->n; i++) {
        least = fmin(least, r->time[i] - r->time[i - 1]);
    }
    LAC_FAIL_IF(motion->smoothing == LAC_SMOOTH_WINDOW && r->n > 1 && motion->window < least, err,
                LAC_EINPUT,
                "--smooth: \"%s\" is %g s, shorter than every interval of the readings, %g s or "
                "more: such as \"window:7 day\"",
                job->request->forecast.smooth, motion->window, least);
    return LAC_OK;
}

// What goes with --rolling alone.
static lac_status check_rolling(const cli_request *request, lac_error *err)
{
    const bool rolling = request->forecast.rolling != NULL;
    LAC_FAIL_IF(request->forecast.lines != NULL &&
                    (!rolling || request->output != NULL ||
                     cli_given(request, CLI_OPT_JSON | CLI_OPT_PIPE)),
                err, LAC_EINPUT, "--jsonl: is of --rolling, without -o, --json and --pipe");
    LAC_FAIL_IF(request->forecast.failed_at != NULL && !rolling, err, LAC_EINPUT,
                "--failed-at: judges the forecasts of --rolling: give both");
    return LAC_OK;
}

// The steps of the sampler, beside the file that they are for.
static lac_status keep_steps(precursors_job *job, bool resume, lac_error *err)
{
    const char *output = job->json != NULL ? job->request->output : NULL;
    uint64_t sum = 0;
    if (output == NULL || job->source == NULL || job->source->fit.steps == 0) {
        return resume ? lac_fail(err, LAC_EINPUT,
                                 "--resume: goes on with the sampler of --case (fit.steps), whose "
                                 "steps are kept beside -o FILE")
                      : LAC_OK;
    }
    LAC_TRY_RETURN(cli_case_sum(job->request, job->source, &sum, err));
    char *path = lac_text_join(output, "", ".chains");
    LAC_FAIL_MEMORY_IF(path == NULL, err);
    const lac_status status = lac_kept_open(path, "precursors", sum, resume, &job->watch.kept, err);
    free(path);
    return status;
}

static void end_steps(precursors_job *job, lac_status status, lac_error *err)
{
    const lac_error why = *err;
    if (status == LAC_EINTERRUPT && job->watch.kept != NULL) {
        (void)lac_fail(err, status, "%s; --resume goes on", why.message);
    }
    lac_kept_close(job->watch.kept, status == LAC_OK);
}

static lac_status answer(const cli_request *given, const char *station, lac_json *json,
                         lac_error *err)
{
    const cli_request own = cli_request_anew(given, true), *request = &own;
    precursors_job job = {.request = request, .station = station, .json = json};
    lac_forecast_outcome *of = &job.watched.of;
    lac_status status;
    LAC_TRY(check_rolling(request, err));
    LAC_TRY(lac_units_create(&job.units, err));
    LAC_TRY(read_case(&job, err));
    if (request->output != NULL) {
        LAC_TRY(cli_output_check(request, job.source, request->output, err));
    }
    LAC_TRY(keep_steps(&job, cli_given(given, CLI_OPT_RESUME), err));
    LAC_TRY(cli_watched_read(request, job.source, job.units, &job.watched, err));
    LAC_TRY(cli_forecast_plan_read(request, of->dated, job.units, &job.plan, err));
    LAC_TRY(check_times(&job, err));
    LAC_TRY(cli_drivers_read(request, job.source, &job.watched, job.units, &job.drivers, err));
    job.plan.def.drivers = job.drivers.n;
    job.plan.def.driver = job.drivers.driver;
    of->horizon = job.plan.def.levels.horizon;
    if (job.watched.run) { // a run has neither outliers nor resets
        job.plan.def.motion.raw = true;
    }
    if (job.source != NULL) {
        job.how.dated = of->dated;
        job.plan.def.model = &job.model;
        cli_signals_hold();
        cli_say(request, "fitting %s to %zu readings", job.source->path, job.watched.readings.n);
    }
    LAC_TRY(read_cells(&job.watched, &job.cells, err));
    LAC_TRY(look(&job, err));
    LAC_TRY(put_out(&job, err));
    LAC_LEAVE_IF(of->interrupted, err, LAC_EINTERRUPT, "interrupted after %zu issue times",
                 of->rolling->issues);
out:
    lac_forecast_outcome_clear(of);
    for (size_t i = 0; i < VALUES; i++) {
        lac_stored_values_clear(&job.cells.value[i]);
    }
    end_steps(&job, status, err);
    cli_drivers_clear(&job.drivers);
    cli_watched_clear(&job.watched);
    lac_case_free(job.source);
    lac_units_free(job.units);
    return status;
}

// What is asked of several columns cannot be one file, nor read twice from a pipe.
static lac_status check_several(const cli_request *request, lac_error *err)
{
    struct stat file;
    const char *path = request->argument[0];
    LAC_FAIL_IF(request->output != NULL, err, LAC_EINPUT,
                "-o: a file holds one column of displacements, and %zu were named: run lacuna once "
                "for each",
                request->displacements.n);
    const char *alone = request->series.velocity != NULL     ? "velocity"
                        : request->series.components != NULL ? "components"
                        : request->forecast.lines != NULL    ? "jsonl"
                        : request->pipe != 0                 ? "pipe"
                                                             : NULL;
    LAC_FAIL_IF(alone != NULL, err, LAC_EINPUT,
                "--%s: goes with one column of displacements, and %zu were named", alone,
                request->displacements.n);
    LAC_FAIL_IF(stat(path, &file) == 0 && !S_ISREG(file.st_mode), err, LAC_EINPUT,
                "%s: is no file, and each of %zu columns reads it anew: save it first", path,
                request->displacements.n);
    return LAC_OK;
}

// A column as if it were the only one; why it has no answer is said in its place.
static lac_status answer_one(const cli_request *request, const char *column, lac_json *json,
                             lac_error *err)
{
    cli_request one = *request;
    const bool as_json = cli_given(request, CLI_OPT_JSON);
    const char *colon = strrchr(column, ':');
    char *station = strndup(column, colon != NULL ? (size_t)(colon - column) : strlen(column));
    LAC_FAIL_MEMORY_IF(station == NULL, err);
    one.series.displacement = column;
    if (!as_json) {
        printf("station %s\n", station);
        (void)fflush(stdout);
    }
    const lac_status status = answer(&one, station, json, err);
    if (status == LAC_EINPUT || status == LAC_ENUMERIC) {
        if (as_json) {
            LAC_JSON_TEXTS(json, "station", station, "error", err->message);
        }
        cli_note("%s", err->message);
    }
    free(station);
    return status;
}

// One that has no answer, a prism that was lost, does not silence the others.
static lac_status answer_each(const cli_request *request, lac_json *json, lac_error *err)
{
    const size_t n = request->displacements.n;
    const bool as_json = cli_given(request, CLI_OPT_JSON);
    lac_status worst = LAC_OK;
    size_t lost = 0;
    LAC_TRY_RETURN(check_several(request, err));
    if (as_json) {
        lac_json_open(json, NULL, '{');
        lac_json_open(json, "stations", '[');
    }
    for (size_t i = 0; i < n; i++) {
        const lac_status status = answer_one(request, request->displacements.word[i], json, err);
        if (status != LAC_OK && status != LAC_EINPUT && status != LAC_ENUMERIC) {
            return status;
        }
        worst = worst == LAC_OK ? status : worst;
        lost += status != LAC_OK ? 1 : 0;
        if (!as_json && i + 1 < n) {
            printf("\n");
        }
    }
    if (as_json) {
        lac_json_close(json, ']');
        lac_json_close(json, '}');
    }
    return worst == LAC_OK ? worst
                           : lac_fail(err, worst, "%zu of %zu columns have no answer", lost, n);
}

lac_status cli_precursors(const cli_request *request, lac_error *err)
{
    lac_json json = {.out = stdout};
    return request->displacements.n > 1 ? answer_each(request, &json, err)
                                        : answer(request, NULL, &json, err);
}

lac_status cli_precursors_file(const cli_request *request, const char *output, lac_error *err)
{
    cli_request rolling = *request;
    rolling.output = output;
    rolling.forecast.rolling = "--rolling";
    return answer(&rolling, NULL, NULL, err);
}
