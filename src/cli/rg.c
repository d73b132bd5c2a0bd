// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/rg.h"

#include <stdio.h>
#include <stdlib.h>

#include "cli/command.h"
#include "cli/libraries.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/run_outcome.h"
#include "cli/signals.h"
#include "cli/words.h"
#include "lacuna/store_rg.h"

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

static lac_status write_file(const rg_job *job, lac_error *err)
{
    char libraries[256];
    const lac_case *c = job->source;
    const lac_scene_rg *rg = &job->rg;
    char *text = lac_case_text(c);
    if (text == NULL) {
        return lac_fail_memory(err);
    }
    const lac_rg_origin origin = {.file = job->request->argument[0],
                                  .status = job->cells.status,
                                  .snapshot = job->cells.index,
                                  .time = job->cells.time,
                                  .load = rg->now.load,
                                  .share = rg->now.share,
                                  .weakest_gap = rg->now.weakest_gap,
                                  .weakest = {rg->now.weakest[0], rg->now.weakest[1]}};
    const lac_rg_view view = {.rule = cli_rg_rule(c),
                              .field = cli_rg_field(c),
                              .grid = &rg->grid,
                              .domain = rg->domain,
                              .betas = rg->betas,
                              .beta = rg->beta,
                              .result = rg->result,
                              .interface = rg->interface,
                              .strength = rg->strength,
                              .origin = job->stored ? &origin : NULL};
    lac_provenance provenance =
        cli_provenance(job->request, c, text, cli_libraries(libraries, sizeof libraries));
    lac_status status =
        lac_store_rg(job->path, cli_given(job->request, CLI_OPT_FORCE), &provenance, &view, err);
    free(text);
    return status;
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

static void write_result(const rg_job *job)
{
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    cli_rg_json(&json, job->source, &job->rg);
    if (job->stored) {
        cli_rg_file_json(&json, job->request->argument[0], &job->cells, &job->rg);
    }
    cli_json_number(&json, "cpu_time_s", cli_cpu_time());
    cli_json_text(&json, "output", job->path);
    cli_json_close(&json, '}');
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
    lac_status status;
    LAC_TRY(read_source(&job, err));
    LAC_TRY(cli_output_path(request, job.source, NULL, "-rg.nc", &job.path, err));
    LAC_TRY(cli_blame(job.source, follow(&job, err), err));
    LAC_TRY(write_file(&job, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        write_result(&job);
    } else {
        print_result(&job);
    }
out:
    lac_scene_rg_clear(&job.rg);
    lac_stored_cells_clear(&job.cells);
    lac_case_free(job.source);
    free(job.path);
    return status;
}
