// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna fit CASE SERIES.csv
#include "cli/fit/fit.h"

#include <stdlib.h>
#include <string.h>

#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "cli/report/report.h"

// Everything that a fit holds.
typedef struct fit_job {
    const cli_request *request;
    cli_fit_columns columns;
    lac_case *source, *fitted;
    lac_series *series;
    lac_fit *fit;
    lac_fit_result result;
    cli_progress progress;
    char *path, *case_path;
    double started;
} fit_job;

static void job_clear(fit_job *job)
{
    lac_fit_free(job->fit);
    lac_series_free(job->series);
    lac_case_free(job->source);
    lac_case_free(job->fitted);
    cli_fit_columns_clear(&job->columns);
    free(job->path);
    free(job->case_path);
}

static lac_status read_series(fit_job *job, lac_error *err)
{
    const char *path = job->request->argument[1];
    const lac_status status = lac_fit_series(job->source, path, &job->series, err);
    if (status == LAC_OK) {
        cli_series_warn(job->request, path, job->series);
    }
    return status;
}

// OUT.yaml beside OUT.nc.
static lac_status name_case(fit_job *job, lac_error *err)
{
    size_t n = strlen(job->path);
    const char ending[] = ".yaml";
    if (n > 3 && strcmp(job->path + n - 3, ".nc") == 0) {
        n -= 3;
    }
    job->case_path = malloc(n + sizeof ending);
    if (job->case_path == NULL) {
        return lac_fail_memory(err);
    }
    memcpy(job->case_path, job->path, n);
    memcpy(job->case_path + n, ending, sizeof ending);
    return cli_output_check(job->request, job->source, job->case_path, err);
}

static lac_status prepare(fit_job *job, lac_error *err)
{
    const int threads = job->request->threads > 0 ? job->request->threads : 1;
    lac_status status;
    lac_case_report report = {0};
    LAC_TRY(cli_fit_columns_create(job->request, &job->columns, err));
    const cli_request *request = job->request = &job->columns.request;
    LAC_TRY(cli_case_read(request, LAC_FOR_FIT, &job->source, NULL, err));
    LAC_TRY(cli_output_path(request, job->source, NULL, "-fit.nc", &job->path, err));
    LAC_TRY(name_case(job, err));
    LAC_TRY(read_series(job, err));
    status = lac_fit_create(job->source, job->series, threads, &job->fit, err);
    if (status != LAC_OK) {
        (void)lac_fail_within(err, status, "%s", request->argument[1]);
        goto out;
    }
    const lac_case_request how = {LAC_FOR_FIT, request->overrides, request->set_count};
    LAC_TRY(lac_case_read(request->argument[0], &how, &job->fitted, &report, err));
out:
    lac_case_report_clear(&report);
    return status;
}

static bool on_interrupted(void *context)
{
    (void)context;
    return cli_signals_stop();
}

static void on_progress(void *context, const char *stage, size_t done, size_t total)
{
    cli_progress_stage(context, stage, done, total);
}

static lac_status compute(fit_job *job, lac_error *err)
{
    const lac_fit_watch watch = {on_interrupted, on_progress, &job->progress};
    cli_signals_hold();
    cli_progress_start(&job->progress, job->request);
    lac_status status = lac_fit_run(job->fit, &watch, &job->result, err);
    cli_progress_clear(&job->progress);
    return cli_blame(job->source, status, err);
}

// What was computed is written whole, also where it was interrupted.
static lac_status put_out(fit_job *job, lac_status computed, lac_error *err)
{
    lac_status status = LAC_OK;
    const char *ended = computed == LAC_OK ? "complete" : "interrupted";
    cli_fit_view view = {.outcome = {job->source, &job->result, ended},
                         .series = job->request->argument[1],
                         .readings = job->series,
                         .output = job->path,
                         .case_output = job->case_path,
                         .wall_time = cli_clock() - job->started};
    LAC_TRY(cli_fit_store(job->request, &view, err));
    LAC_TRY(cli_fit_write_case(&view, job->fitted, err));
    if (cli_given(job->request, CLI_OPT_JSON)) {
        status = cli_fit_json(&view, err);
    } else {
        cli_fit_print(&view, cli_given(job->request, CLI_OPT_VERBOSE));
    }
out:
    return status;
}

lac_status cli_fit(const cli_request *request, lac_error *err)
{
    fit_job job = {.request = request, .started = cli_clock()};
    lac_status status;
    LAC_TRY(prepare(&job, err));
    cli_say(request, "fitting %zu numbers of %s to %s", job.source->fit.count, request->argument[0],
            request->argument[1]);
    status = compute(&job, err);
    if (status == LAC_OK || (status == LAC_EINTERRUPT && job.result.times > 0)) {
        lac_status written = put_out(&job, status, status == LAC_OK ? err : NULL);
        status = status == LAC_OK ? written : status;
        if (status == LAC_OK) {
            status = lac_fit_trust(&job.result, err);
        } else if (status == LAC_EINTERRUPT) {
            status = lac_fail(err, status, "interrupted; %s holds the draws up to there", job.path);
        }
    }
out:
    job_clear(&job);
    return status;
}
