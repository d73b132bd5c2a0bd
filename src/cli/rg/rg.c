// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna rg CASE|FILE.nc: the cascade of slip over a joint that is made, or over stored cells.
#include "cli/rg/rg.h"

#include <stdio.h>
#include <stdlib.h>

#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "cli/report/report.h"
#include "cli/run/run_outcome.h"
#include "data/dataset.h"

typedef struct watching {
    const cli_request *request;
} watching;

static bool go_on(void *context, size_t done, size_t seeds)
{
    const watching *w = context;
    if (seeds > 1) {
        cli_say(w->request, "interface %zu of %zu", done + 1, seeds);
    }
    return !cli_signals_stop();
}

// Everything that the command holds.
typedef struct rg_job {
    const cli_request *request;
    lac_case *source;
    bool stored; // the argument is a file: `cells` hold
    lac_stored_cells cells;
    lac_scene_rg rg;
    char *path;
} rg_job;

static lac_rg_outcome outcome_of(const rg_job *job)
{
    return (lac_rg_outcome){.source = job->source,
                            .rg = &job->rg,
                            .file = job->request->argument[0],
                            .cells = job->stored ? &job->cells : NULL};
}

static void print_result(const rg_job *job)
{
    if (job->source->title != NULL) {
        puts(job->source->title);
    }
    if (job->stored) {
        cli_rg_file_print(&job->cells, &job->rg);
    }
    cli_rg_print(job->source, &job->rg, cli_given(job->request, CLI_OPT_VERBOSE));
    cli_row("file", "%s", job->path);
}

static void print_json(const rg_job *job, const lac_dataset *dataset)
{
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(dataset, &json);
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_text(&json, "output", job->path);
    lac_json_close(&json, '}');
}

static lac_status read_source(rg_job *job, lac_error *err)
{
    const char *name = job->request->argument[0];
    job->stored = cli_rg_is_file(name);
    if (job->stored) {
        return cli_rg_file_read(job->request, &job->source, &job->cells, err);
    }
    if (job->request->snapshot != NULL) {
        return lac_fail(err, LAC_EINPUT, "--snapshot: %s is a case; only files have snapshots",
                        name);
    }
    return cli_case_read(job->request, LAC_FOR_RG, &job->source, NULL, err);
}

static lac_status follow(rg_job *job, lac_error *err)
{
    watching w = {job->request};
    const lac_rg_watch watch = {&w, go_on};
    const lac_rg_cells cells = {job->cells.domain, job->cells.shear, job->cells.time};
    cli_say(job->request, "following the cascade of %s", job->request->argument[0]);
    cli_signals_hold();
    return job->stored ? lac_scene_rg_cells(job->source, &cells, &job->rg, err)
                       : lac_scene_rg_run(job->source, &watch, &job->rg, err);
}

lac_status cli_rg(const cli_request *request, lac_error *err)
{
    rg_job job = {.request = request};
    lac_rg_outcome outcome;
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(read_source(&job, err));
    LAC_TRY(cli_output_path(request, job.source, NULL, "-rg.nc", &job.path, err));
    LAC_TRY(cli_blame(job.source, follow(&job, err), err));
    outcome = outcome_of(&job);
    LAC_TRY(lac_scene_rg_describe(&outcome, &dataset, err));
    LAC_TRY(cli_store_dataset(request, job.source, INT64_MIN, job.path, dataset, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        print_json(&job, dataset);
    } else {
        print_result(&job);
    }
out:
    lac_dataset_free(dataset);
    lac_scene_rg_clear(&job.rg);
    lac_stored_cells_clear(&job.cells);
    lac_case_free(job.source);
    free(job.path);
    return status;
}
