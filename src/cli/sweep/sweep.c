// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna sweep: many runs of a case, each in a process of the pool, and what they say together.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/pool.h"
#include "cli/common/words.h"
#include "cli/report/report.h"
#include "cli/sweep/answers.h"
#include "sweep/ensemble.h"

typedef struct job {
    const cli_request *request;
    const lac_sweep *sweep;
    lac_member *member;
    size_t next;
} job;

static size_t next_member(void *context)
{
    job *j = context;
    return j->next < j->sweep->members ? j->next++ : CLI_POOL_NONE;
}

static lac_status make(void *context, size_t task, void *result, lac_error *err)
{
    const job *j = context;
    return lac_member_run(j->sweep, task, j->request->argument[0], j->request->overrides,
                          j->request->set_count, result, err);
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    const job *j = context;
    lac_member *m = &j->member[task];
    (void)err;
    if (result != NULL) {
        memcpy(m, result, sizeof *m);
    } else {
        *m = (lac_member){.failure_time = NAN, .time = NAN};
        cli_pool_reason(end, m->message, sizeof m->message);
    }
    return LAC_OK;
}

static lac_status read_number(const char *option, const char *text, uint64_t most, uint64_t *out,
                              lac_error *err)
{
    char *end = NULL;
    if (text != NULL) {
        *out = strtoull(text, &end, 10);
        LAC_FAIL_IF(*end != '\0' || *text == '-' || end == text || *out > most, err, LAC_EINPUT,
                    "%s: \"%s\" must be a whole number", option, text);
    }
    return LAC_OK;
}

// Splits --over KEY=VALUES.
static lac_status read_over(const cli_words *words, lac_override *over, lac_error *err)
{
    for (size_t i = 0; i < words->n; i++) {
        const char *equal = strchr(words->word[i], '=');
        LAC_FAIL_IF(equal == NULL || equal == words->word[i], err, LAC_EINPUT,
                    "--over: \"%s\" must be KEY=VALUES", words->word[i]);
        over[i] =
            (lac_override){strndup(words->word[i], (size_t)(equal - words->word[i])), equal + 1};
        LAC_FAIL_MEMORY_IF(over[i].key == NULL, err);
    }
    return LAC_OK;
}

static lac_status plan(const cli_request *request, const lac_case *c, lac_sweep **out,
                       lac_error *err)
{
    const size_t n = request->over.n;
    uint64_t members = 0, seed = 1;
    lac_override *over = calloc(n + 1, sizeof *over);
    lac_status status;
    LAC_TRY(over != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(read_number("--members", request->sweep.members, 1000000, &members, err));
    LAC_TRY(read_number("--seed", request->sweep.seed, INT32_MAX, &seed, err));
    LAC_TRY(read_over(&request->over, over, err));
    const lac_sweep_def def = {over, n, request->sweep.design, (size_t)members, seed};
    LAC_TRY(lac_sweep_create(c, &def, out, err));
out:
    for (size_t i = 0; over != NULL && i < n; i++) {
        free((char *)over[i].key);
    }
    free(over);
    return status;
}

static lac_status compute(const cli_request *request, const lac_sweep *sweep, lac_member *member,
                          lac_error *err)
{
    job j = {.request = request, .sweep = sweep, .member = member};
    cli_progress progress = {0};
    cli_pool pool = {.what = "members",
                     .total = sweep->members,
                     .size = sizeof *member,
                     .journal = -1,
                     .context = &j,
                     .next = next_member,
                     .work = make,
                     .take = take};
    lac_status status = cli_pool_jobs(request->trade.jobs, &pool.jobs, err);
    if (status == LAC_OK) {
        cli_progress_start(&progress, request);
        pool.progress = &progress;
        status = cli_pool_run(&pool, err);
    }
    cli_progress_clear(&progress);
    return status;
}

lac_status cli_sweep_by(const cli_request *request, const lac_case *c, double *by, lac_error *err)
{
    *by = NAN;
    if (request->sweep.by == NULL) {
        return LAC_OK;
    }
    const lac_status status = cli_parse_time(request->sweep.by, c, by, err);
    return status == LAC_EINPUT ? lac_fail_within(err, status, "--by: \"%s\"", request->sweep.by)
                                : status;
}

static lac_status put_out(const cli_request *request, const lac_case *c, const lac_ensemble *e,
                          const char *path, lac_error *err)
{
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(lac_ensemble_describe(e, &dataset, err));
    LAC_TRY(cli_store_dataset(request, c, (int64_t)e->sweep->seed, path, dataset, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        cli_print_json(dataset, path);
    } else {
        cli_answers_print(e->answers);
        cli_row("file", "%s", path);
    }
out:
    lac_dataset_free(dataset);
    return status;
}

lac_status cli_sweep(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_sweep *sweep = NULL;
    lac_member *member = NULL;
    lac_ensemble *ensemble = NULL;
    char *path = NULL;
    double by;
    lac_status status;
    LAC_TRY(cli_case_read(request, LAC_FOR_RUN, &c, NULL, err));
    LAC_TRY(cli_sweep_by(request, c, &by, err));
    LAC_TRY(cli_output_path(request, c, NULL, "-sweep.nc", &path, err));
    LAC_TRY(plan(request, c, &sweep, err));
    member = calloc(sweep->members, sizeof *member);
    LAC_TRY(member != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(compute(request, sweep, member, err));
    LAC_TRY(lac_ensemble_create(sweep, member, c->run.end, by, &ensemble, err));
    LAC_TRY(put_out(request, c, ensemble, path, err));
out:
    lac_ensemble_free(ensemble);
    free(member);
    lac_sweep_free(sweep);
    free(path);
    lac_case_free(c);
    return status;
}
