// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna precursors FILE: indicators and forecasts, at the end of the data or all along them.
#include "cli/precursors/precursors.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "cli/common/command.h"
#include "cli/common/libraries.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "store/store.h"

typedef struct precursors_job {
    const cli_request *request;
    lac_units *units;
    cli_foreseer foreseer;
    cli_watched watched;
    cli_forecast_plan plan;
    lac_outlook *outlook;
    cli_cells cells;
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

static lac_status write_file(const precursors_job *job, lac_error *err)
{
    char libraries[256];
    const lac_case *c = job->foreseer.source;
    char *text = c != NULL ? lac_case_text(c) : NULL;
    if (c != NULL && text == NULL) {
        return lac_fail_memory(err);
    }
    const lac_provenance provenance = {
        .title = job->watched.path,
        .case_text = text,
        .command_line = job->request->command_line,
        .libraries = cli_libraries(libraries, sizeof libraries),
        .seed = c != NULL ? c->fit.seed : INT64_MIN,
        .now = (double)time(NULL),
    };
    const lac_forecast_outcome outcome = {
        .source = job->watched.path,
        .attribution = job->watched.series != NULL ? job->watched.series->attribution : NULL,
        .dated = job->watched.dated,
        .failed_at = job->watched.failed_at,
        .outlook = job->outlook,
        .rolling = job->rolling,
        .interrupted = job->interrupted,
        .indicators = job->course != NULL ? job->course->kinds : job->indicators,
        .indicator = job->course != NULL ? job->course->found : job->indicator,
    };
    lac_dataset *dataset = NULL;
    lac_status status = lac_forecast_describe(&outcome, &dataset, err);
    if (status == LAC_OK) {
        status = lac_store_dataset(job->request->output, cli_given(job->request, CLI_OPT_FORCE),
                                   &provenance, dataset, err);
    }
    lac_dataset_free(dataset);
    free(text);
    return status;
}

static lac_status put_out(const precursors_job *job, lac_error *err)
{
    const cli_request *request = job->request;
    lac_status status = LAC_OK;
    if (request->output != NULL) {
        LAC_TRY(write_file(job, err));
    }
    const cli_precursors_result result = {.watched = &job->watched,
                                          .plan = &job->plan,
                                          .outlook = job->outlook,
                                          .indicators = job->indicators,
                                          .indicator = job->indicator,
                                          .rolling = job->rolling,
                                          .course = job->course,
                                          .skill = job->skill,
                                          .output = request->output};
    if (cli_given(request, CLI_OPT_JSON)) {
        cli_precursors_json(&result);
    } else {
        cli_precursors_print(&result, cli_given(request, CLI_OPT_VERBOSE));
    }
out:
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
    LAC_TRY(cli_cells_read(&job.watched, &job.cells, err));
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
    cli_cells_clear(&job.cells);
    lac_outlook_free(job.outlook);
    cli_watched_clear(&job.watched);
    cli_foreseer_clear(&job.foreseer);
    lac_units_free(job.units);
    return status;
}
