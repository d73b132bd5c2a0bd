// SPDX-License-Identifier: GPL-3.0-or-later
// The members of a sweep, in workers that make many each: what is kept of them, and which is next.
#include "cli/sweep/members.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/archive.h"
#include "cli/common/output.h"
#include "lacuna/version.h"

static size_t next(void *context)
{
    cli_members *m = context;
    while (m->next < m->n && m->member[m->next] != NULL) {
        m->next++;
    }
    return m->next < m->n ? m->next++ : CLI_POOL_NONE;
}

static lac_status work(void *context, size_t task, void *result, lac_error *err)
{
    const cli_members *m = context;
    return lac_member_run(m->sweep, m->index[task], NULL, result, err);
}

static lac_status put(cli_members *m, size_t place, const void *content, lac_error *err)
{
    free(m->member[place]);
    m->member[place] = malloc(m->keep.size);
    LAC_FAIL_MEMORY_IF(m->member[place] == NULL, err);
    memcpy(m->member[place], content, m->keep.size);
    return LAC_OK;
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    cli_members *m = context;
    if (result != NULL) {
        LAC_TRY_RETURN(put(m, task, result, err));
        return cli_keep_add(&m->keep, m->index[task], result, err);
    }
    m->member[task] = malloc(m->keep.size);
    LAC_FAIL_MEMORY_IF(m->member[task] == NULL, err);
    lac_member_clear(m->sweep, m->index[task], m->member[task]);
    cli_pool_reason(end, m->member[task]->message, sizeof m->member[task]->message);
    return LAC_OK;
}

static int by_value(const void *a, const void *b)
{
    const size_t x = *(const size_t *)a, y = *(const size_t *)b;
    return (x > y) - (x < y);
}

// One that was kept before. Where memory is short it is made again.
static void take_over(void *context, uint64_t key, const void *content)
{
    cli_members *m = context;
    const size_t index = (size_t)key;
    const size_t *found = bsearch(&index, m->index, m->n, sizeof index, by_value);
    if (found != NULL && m->member[found - m->index] == NULL &&
        put(m, (size_t)(found - m->index), content, NULL) == LAC_OK) {
        m->pool.done++;
    }
}

// What members follow from: the plan, the files that the case reads, and who computes.
static lac_status find_mark(cli_members *m, const char *libraries, lac_error *err)
{
    char *sums = cli_inputs_sums(m->sweep->base);
    LAC_FAIL_MEMORY_IF(sums == NULL, err);
    const char *const texts[] = {sums, LACUNA_VERSION, libraries};
    m->keep.mark = m->sweep->mark;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        m->keep.mark = lac_sum_bytes(m->keep.mark, texts[i], strlen(texts[i]));
    }
    free(sums);
    return LAC_OK;
}

lac_status cli_members_make(cli_members *m, const cli_request *request, const char *path,
                            lac_error *err)
{
    const int jobs = m->pool.jobs;
    m->keep = (cli_keep){"sweep", .size = lac_member_size(m->sweep), .every = 1.0};
    m->pool = (cli_pool){.what = "members",
                         .total = m->n,
                         .size = m->keep.size,
                         .jobs = jobs,
                         .journal = -1,
                         .progress = &m->progress,
                         .context = m,
                         .next = next,
                         .work = work,
                         .take = take};
    m->member = calloc(m->n + 1, sizeof(lac_member *));
    LAC_FAIL_MEMORY_IF(m->member == NULL, err);
    LAC_TRY_RETURN(find_mark(m, request->libraries, err));
    (void)snprintf(m->keep.folder, sizeof m->keep.folder, "%s.runs", path);
    // a script that is begun again need not know whether it had begun
    const bool resume = cli_given(request, CLI_OPT_RESUME) && access(m->keep.folder, F_OK) == 0;
    LAC_TRY_RETURN(cli_keep_open(&m->keep, path, resume, take_over, m, err));
    m->pool.journal = lac_kept_file(m->keep.done);
    cli_signals_hold();
    cli_progress_start(&m->progress, request);
    const lac_status status = cli_pool_run(&m->pool, err);
    cli_progress_clear(&m->progress);
    return status;
}

void cli_members_clear(cli_members *m, bool written)
{
    for (size_t i = 0; m->member != NULL && i < m->n; i++) {
        free(m->member[i]);
    }
    free(m->member);
    cli_keep_close(&m->keep, written);
}
