// SPDX-License-Identifier: GPL-3.0-or-later
// The interfaces of an ensemble in processes of the pool, each kept as soon as it is done.
#include "cli/rg/parts.h"

#include "cli/common/output.h"
#include "cli/common/words.h"

// Of a process. An interface that cannot be followed is the case's doing: --resume would not help.
typedef struct answer {
    lac_status status;
    lac_error why;
    max_align_t part[];
} answer;

static lac_status work(void *context, size_t task, void *result, lac_error *err)
{
    const cli_rg_parts *p = context;
    answer *said = result;
    (void)err;
    said->status = lac_scene_rg_part(p->source, task, said->part, &said->why);
    return LAC_OK;
}

static size_t next(void *context)
{
    cli_rg_parts *p = context;
    while (p->next < p->n && p->part[p->next] != NULL) {
        p->next++;
    }
    return p->next < p->n ? p->next++ : CLI_POOL_NONE;
}

static void take_over(void *context, uint64_t key, const void *content)
{
    cli_rg_parts *p = context;
    if (key < p->n && p->part[key] == NULL && (p->part[key] = malloc(p->keep.size)) != NULL) {
        memcpy(p->part[key], content, p->keep.size);
        p->pool.done++;
    }
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    cli_rg_parts *p = context;
    const answer *said = result;
    char reason[200];
    if (said == NULL) {
        cli_pool_reason(end, reason, sizeof reason);
        return lac_fail(err, LAC_ENUMERIC, "interface %zu of %zu: %s; --resume goes on", task + 1,
                        p->n + 1, reason);
    }
    LAC_FAIL_IF(said->status != LAC_OK, err, said->status, "%s", said->why.message);
    p->part[task] = malloc(p->keep.size);
    LAC_FAIL_MEMORY_IF(p->part[task] == NULL, err);
    memcpy(p->part[task], said->part, p->keep.size);
    return cli_keep_add(&p->keep, task, said->part, err);
}

lac_status cli_rg_parts_open(cli_rg_parts *p, const char *path, lac_error *err)
{
    const bool resume = cli_given(p->request, CLI_OPT_RESUME);
    p->n = (size_t)p->source->rg.seeds - 1;
    LAC_FAIL_IF(resume && p->n == 0, err, LAC_EINPUT,
                "--resume: of one interface nothing is kept that it could go on from");
    p->keep = (cli_keep){.command = "rg", .size = lac_scene_rg_part_size(p->source)};
    p->pool = (cli_pool){.what = "interfaces",
                         .total = p->n + 1,
                         .size = sizeof(answer) + p->keep.size,
                         .context = p,
                         .next = next,
                         .work = work,
                         .take = take};
    LAC_TRY_RETURN(cli_pool_jobs(p->request->trade.jobs, &p->pool.jobs, err));
    p->part = calloc(p->n + 1, sizeof *p->part);
    LAC_FAIL_MEMORY_IF(p->part == NULL, err);
    if (p->n == 0) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(cli_case_sum(p->request, p->source, &p->keep.mark, err));
    LAC_TRY_RETURN(cli_keep_open(&p->keep, path, resume, take_over, p, err));
    p->pool.journal = lac_kept_file(p->keep.done);
    return LAC_OK;
}

static bool go_on(void *context, size_t done, size_t seeds)
{
    if (seeds > 1) {
        cli_say(((const cli_rg_parts *)context)->request, "interface %zu of %zu", done + 1, seeds);
    }
    return !cli_signals_stop(NULL);
}

static const void *made(void *context, size_t seed)
{
    return ((const cli_rg_parts *)context)->part[seed];
}

lac_status cli_rg_parts_run(cli_rg_parts *p, lac_scene_rg *out, lac_error *err)
{
    const lac_rg_watch watch = {p, go_on, made};
    cli_progress progress = {0};
    lac_error why = {""};
    lac_status status = LAC_OK;
    if (p->n > 0) {
        cli_progress_start(&progress, p->request);
        p->pool.progress = &progress;
        status = cli_pool_run(&p->pool, err);
        cli_progress_clear(&progress);
    }
    LAC_TRY_RETURN(status);
    status = lac_scene_rg_run(p->source, &watch, out, &why);
    LAC_FAIL_IF(status != LAC_OK, err, status, "%s%s", why.message,
                status == LAC_EINTERRUPT && p->n > 0 ? "; --resume goes on" : "");
    return LAC_OK;
}

void cli_rg_parts_close(cli_rg_parts *p, lac_status status)
{
    for (size_t i = 0; p->part != NULL && i < p->n; i++) {
        free(p->part[i]);
    }
    free(p->part);
    cli_keep_close(&p->keep, status == LAC_OK || status == LAC_EINPUT);
}
