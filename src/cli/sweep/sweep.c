// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna sweep: many runs of a case in processes of the pool, all or a part of them, and what they
// say together; lacuna gather: the parts put together.
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/keep.h"
#include "cli/common/output.h"
#include "cli/common/pool.h"
#include "cli/common/words.h"
#include "cli/report/report.h"
#include "cli/sweep/answers.h"
#include "cli/sweep/kept_runs.h"
#include "lacuna/version.h"
#include "sweep/ensemble.h"

// Members from `first` on, every so many.
typedef struct part {
    size_t first, stride, n;
} part;

typedef struct job {
    const cli_request *request;
    lac_sweep *sweep;
    part of;
    lac_member **member; // [n]; taken over by the ensemble
    size_t next;
    bool resume;
    cli_keep keep;
    char *path;
    cli_kept_runs runs;
} job;

static size_t next_member(void *context)
{
    job *j = context;
    while (j->next < j->of.n && j->member[j->next]->state != LAC_MEMBER_PENDING) {
        j->next++;
    }
    return j->next < j->of.n ? j->next++ : CLI_POOL_NONE;
}

static lac_status make(void *context, size_t task, void *result, lac_error *err)
{
    const job *j = context;
    const size_t member = j->of.first + task * j->of.stride;
    lac_member *m = result;
    LAC_TRY_RETURN(lac_member_run(j->sweep, member, NULL, m, err));
    return m->state == LAC_MEMBER_DONE ? cli_kept_runs_write(&j->runs, j->sweep, task, err)
                                       : LAC_OK;
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    job *j = context;
    lac_member *m = j->member[task];
    if (result != NULL) {
        memcpy(m, result, lac_member_size(j->sweep));
        return cli_keep_add(&j->keep, (uint64_t)m->index, m, err);
    }
    // --resume makes it again: what killed its process need not be its own doing
    lac_member_break(j->sweep, j->of.first + task * j->of.stride, m);
    cli_pool_reason(end, m->message, sizeof m->message);
    return LAC_OK;
}

static void take_over(void *context, uint64_t key, const void *content)
{
    job *j = context;
    const size_t task = ((size_t)key - j->of.first) / j->of.stride;
    const bool own = key >= j->of.first && (key - j->of.first) % j->of.stride == 0;
    if (own && task < j->of.n && !cli_kept_runs_lacks(&j->runs, task)) {
        memcpy(j->member[task], content, lac_member_size(j->sweep));
    }
}

static lac_status read_number(const char *option, const char *text, uint64_t most, uint64_t *out,
                              lac_error *err)
{
    char *end = NULL;
    if (text != NULL) {
        *out = strtoull(text, &end, 10);
        LAC_FAIL_IF(*end != '\0' || text[strspn(text, "0123456789")] != '\0' || end == text ||
                        *out > most,
                    err, LAC_EINPUT, "%s: \"%.40s\" must be a whole number from 0 to %llu", option,
                    text, (unsigned long long)most);
    }
    return LAC_OK;
}

static lac_status plan(const cli_request *request, lac_sweep **out, lac_error *err)
{
    lac_case *c = NULL;
    uint64_t members = 0, seed = 1;
    double end = NAN;
    lac_status status;
    LAC_TRY(read_number("--members", request->sweep.members, 1000000000, &members, err));
    LAC_FAIL_IF(request->sweep.members != NULL && members == 0, err, LAC_EINPUT,
                "--members: \"0\" must be 1 or more");
    LAC_TRY(read_number("--seed", request->sweep.seed, UINT64_MAX - 1, &seed, err));
    LAC_TRY(cli_case_read(request, LAC_FOR_RUN, &c, NULL, err)); // says what it warns of
    LAC_TRY(cli_until(request, c, &end, err));
    const lac_sweep_request ask = {.path = request->argument[0],
                                   .overrides = request->overrides,
                                   .count = request->set_count,
                                   .over = request->over.word,
                                   .varied = request->over.n,
                                   .table = request->sweep.table,
                                   .design = request->sweep.design,
                                   .series = request->sweep.series,
                                   .members = (int64_t)members,
                                   .seed = seed,
                                   .until = request->until != NULL ? end : NAN,
                                   .files = cli_inputs_sums};
    LAC_TRY(lac_sweep_create(&ask, out, err));
out:
    lac_case_free(c);
    return status;
}

// "--shard 3/8": every eighth member from the third on; "--member 5": that one.
static lac_status pick(const cli_request *request, size_t members, part *out, lac_error *err)
{
    const char *shard = request->sweep.shard, *slash = shard != NULL ? strchr(shard, '/') : NULL;
    uint64_t index = 0, of = 1;
    *out = (part){0, 1, members};
    LAC_FAIL_IF(shard != NULL && request->sweep.member != NULL, err, LAC_EINPUT,
                "--member: is one run, and --shard many: give one of them");
    LAC_FAIL_IF(
        shard != NULL && (request->sweep.by != NULL || request->sweep.of != NULL), err, LAC_EINPUT,
        "--shard: makes a part of the members; give --by and --of to lacuna gather, which has all");
    if (request->sweep.member != NULL) {
        LAC_TRY_RETURN(read_number("--member", request->sweep.member, members - 1, &index, err));
        *out = (part){(size_t)index, 1, 1};
    }
    if (shard == NULL) {
        return LAC_OK;
    }
    char *end = NULL;
    index = strtoull(shard, &end, 10);
    const bool first = slash != NULL && end == slash && shard[0] >= '0' && shard[0] <= '9';
    of = first ? strtoull(slash + 1, &end, 10) : 0;
    LAC_FAIL_IF(!first || slash[1] < '0' || slash[1] > '9' || *end != '\0' || index >= of ||
                    of > 1000000,
                err, LAC_EINPUT,
                "--shard: \"%.40s\" must be I/N, part I of N, counted from 0: 0/4 to 3/4", shard);
    *out = (part){(size_t)index, (size_t)of, members > index ? (members - index - 1) / of + 1 : 0};
    return LAC_OK;
}

static lac_status compute(job *j, lac_error *err)
{
    cli_progress progress = {0};
    cli_pool pool = {.what = "members",
                     .total = j->of.n,
                     .size = lac_member_size(j->sweep),
                     .journal = lac_kept_file(j->keep.done),
                     .context = j,
                     .next = next_member,
                     .work = make,
                     .take = take};
    lac_status status = cli_pool_jobs(j->request->trade.jobs, &pool.jobs, err);
    for (size_t i = 0; i < j->of.n; i++) {
        pool.done += j->member[i]->state != LAC_MEMBER_PENDING ? 1 : 0;
    }
    if (status == LAC_OK) {
        cli_progress_start(&progress, j->request);
        pool.progress = &progress;
        status = cli_pool_run(&pool, err);
    }
    cli_progress_clear(&progress);
    return status;
}

// What an ensemble says, as a dataset with the members; of a part of a sweep it says nothing.
static lac_status answer(lac_ensemble *e, const cli_question *question, lac_answers **answers,
                         lac_dataset **out, lac_error *err)
{
    lac_sample sample;
    lac_dataset_free(*out);
    lac_answers_free(*answers);
    *out = NULL;
    *answers = NULL;
    if (e->n == e->members) {
        LAC_TRY_RETURN(lac_ensemble_sample(e, &question->of, question->by, &sample, err));
        LAC_TRY_RETURN(lac_answers_create(&sample, answers, err));
    }
    return lac_ensemble_describe(e, *answers, out, err);
}

// As lacuna run warns of its own.
static void warn_of_balance(const lac_ensemble *e)
{
    size_t off = 0;
    for (size_t i = 0; i < e->n; i++) {
        off += e->member[i]->balance_residual > 0.01 ? 1 : 0;
    }
    if (off > 0) {
        cli_note("warning: the traction balance of %zu of %zu members is off by more than 0.01 of "
                 "the strength (balance_residual in the file); tighten solver.rtol",
                 off, e->n);
    }
}

static void print(const lac_ensemble *e, const lac_answers *answers)
{
    size_t broken = 0;
    if (answers != NULL) {
        cli_answers_print(answers);
    } else {
        cli_row("members", "%zu of %zu: lacuna gather puts the parts together", e->n, e->members);
    }
    while (broken < e->n && e->member[broken]->state != LAC_MEMBER_BROKEN) {
        broken++;
    }
    if (broken < e->n) { // the first one; the file has the message of each
        const lac_member *m = e->member[broken];
        cli_row_wrap("broken", cli_format("member %lld: %s", (long long)m->index, m->message).s);
    }
}

// Writes an ensemble and says what is asked of it. The file holds what is said of the time of
// failure, whatever that is.
// @param path  NULL: it is not written
static lac_status put_out(const cli_request *request, lac_ensemble *e, const cli_question *question,
                          const char *path, lac_error *err)
{
    cli_question usual = {.by = question->of.time ? question->by : NAN};
    lac_dataset *dataset = NULL;
    lac_answers *answers = NULL;
    lac_provenance made = {.title = e->title, .case_text = e->case_text, .seed = INT64_MIN};
    lac_status status;
    cli_sign(request, &made);
    made.now = NAN; // another day's has the same bytes
    LAC_TRY(lac_ensemble_result_find(NULL, 0, NULL, &usual.of, err));
    const bool held = path != NULL || request->pipe != 0;
    if (held || question->of.time) {
        LAC_TRY(answer(e, &usual, &answers, &dataset, err));
    }
    if (held) {
        LAC_TRY(cli_put_dataset(request, cli_given(request, CLI_OPT_FORCE | CLI_OPT_RESUME), &made,
                                path, dataset, err));
    }
    if (!question->of.time) {
        LAC_TRY(answer(e, question, &answers, &dataset, err));
    }
    if (!cli_given(request, CLI_OPT_QUIET)) {
        warn_of_balance(e);
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        cli_print_json(dataset, path);
        goto out;
    }
    print(e, answers);
    if (path != NULL) {
        cli_row("file", "%s", path);
    }
out:
    lac_dataset_free(dataset);
    lac_answers_free(answers);
    return status;
}

// So that a script can be begun again whatever it had done, --resume begins where nothing is kept,
// and leaves a file that has all members as it is.
static lac_status name_file(job *j, bool *whole, lac_error *err)
{
    lac_ensemble *e = NULL;
    char mark[sizeof e->mark];
    const cli_request plain = cli_request_anew(j->request, true);
    LAC_TRY_RETURN(cli_output_path(&plain, j->sweep->base, NULL, "-sweep.nc", &j->path, err));
    j->runs = (cli_kept_runs){&plain, j->path, j->of.first, j->of.stride, j->of.n, NULL};
    LAC_TRY_RETURN(cli_kept_runs_read(j->sweep, &j->runs, err));
    LAC_TRY_RETURN(cli_kept_runs_check(&j->runs, j->sweep, err));
    j->runs.request = j->request;
    (void)snprintf(j->keep.folder, sizeof j->keep.folder, "%s.runs", j->path);
    // a folder without it is what is left where a kill fell into its making or taking away
    char done[sizeof j->keep.folder + sizeof "/done"];
    (void)snprintf(done, sizeof done, "%s/done", j->keep.folder);
    const bool kept = access(done, F_OK) == 0;
    if (j->resume && !kept && access(j->path, F_OK) == 0) {
        LAC_TRY_RETURN(lac_ensemble_read(j->path, &e, err));
        (void)snprintf(mark, sizeof mark, "%016" PRIx64, j->sweep->mark);
        *whole = strcmp(mark, e->mark) == 0 && e->n == j->of.n &&
                 (e->n == 0 || (size_t)e->member[0]->index == j->of.first);
        for (size_t i = 0; *whole && i < e->n && j->runs.wanted != NULL; i++) {
            j->runs.wanted[i] = j->runs.wanted[i] && e->member[i]->state == LAC_MEMBER_DONE;
        }
        int length;
        const char *changed = lac_sweep_changed_file(e->files, j->sweep->files, &length);
        lac_status status = LAC_OK;
        if (!*whole) {
            status = lac_fail(
                err, LAC_EINPUT,
                "--resume: %s: is of another sweep, or of another part of it%s%.*s%s; "
                "--force replaces it, -o names another file",
                j->path, changed != NULL ? ": " : "", length, changed != NULL ? changed : "",
                changed != NULL ? " was changed since" : "");
        }
        lac_ensemble_free(e);
        LAC_TRY_RETURN(status);
    }
    j->resume = j->resume && kept;
    return LAC_OK;
}

lac_status cli_sweep(const cli_request *request, lac_error *err)
{
    job j = {.request = request, .resume = cli_given(request, CLI_OPT_RESUME)};
    lac_ensemble *ensemble = NULL;
    bool whole = false;
    cli_question question;
    lac_status status;
    LAC_TRY(plan(request, &j.sweep, err));
    LAC_TRY(
        cli_question_read(request, j.sweep->base, j.sweep->extras, j.sweep->extra, &question, err));
    LAC_TRY(pick(request, j.sweep->members, &j.of, err));
    LAC_TRY(name_file(&j, &whole, err));
    if (whole) {
        cli_say(request, "%s has all its members", j.path);
        for (size_t k = 0; k < j.of.n; k++) { // that are to be kept
            LAC_TRY(cli_kept_runs_lacks(&j.runs, k) ? cli_kept_runs_write(&j.runs, j.sweep, k, err)
                                                    : LAC_OK);
        }
        goto out;
    }
    j.member = calloc(j.of.n + 1, sizeof *j.member);
    LAC_TRY(j.member != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t i = 0; i < j.of.n; i++) {
        j.member[i] = calloc(1, lac_member_size(j.sweep));
        LAC_TRY(j.member[i] != NULL ? LAC_OK : lac_fail_memory(err));
    }
    j.keep = (cli_keep){.command = "sweep", .size = lac_member_size(j.sweep), .every = 1.0};
    j.keep.mark = lac_sum_bytes(j.sweep->mark, LACUNA_VERSION, strlen(LACUNA_VERSION));
    LAC_TRY(cli_keep_open(&j.keep, j.path, j.resume, take_over, &j, err));
    cli_say(request, "%zu members of %zu, by %s", j.of.n, j.sweep->members, j.sweep->design->name);
    cli_signals_hold();
    LAC_TRY(compute(&j, err));
    LAC_TRY(lac_sweep_check_files(j.sweep, cli_inputs_sums, err));
    lac_member **member = j.member;
    j.member = NULL;
    LAC_TRY(lac_ensemble_create(j.sweep, j.of.n, member, &ensemble, err));
    LAC_TRY(put_out(request, ensemble, &question, j.path, err));
out:
    cli_keep_close(&j.keep, status == LAC_OK);
    lac_ensemble_free(ensemble);
    for (size_t i = 0; j.member != NULL && i < j.of.n; i++) {
        free(j.member[i]);
    }
    free(j.member);
    free(j.runs.wanted);
    lac_sweep_free(j.sweep);
    free(j.path);
    return status;
}

// A date of --by is on the clock of the sweep's case.
static lac_status ask(const cli_request *request, const lac_ensemble *e, cli_question *out,
                      lac_error *err)
{
    lac_case *c = NULL;
    lac_status status = lac_case_read_text("the sweep's case", e->case_text, strlen(e->case_text),
                                           NULL, &c, NULL, err);
    if (status == LAC_OK) {
        status = cli_question_read(request, c, e->extras, e->extra, out, err);
    }
    lac_case_free(c);
    return status;
}

lac_status cli_gather(const cli_request *request, lac_error *err)
{
    const size_t n = request->files.n;
    lac_ensemble **shard = calloc(n + 1, sizeof *shard), *all = NULL;
    cli_question question;
    lac_status status;
    LAC_TRY(shard == NULL ? lac_fail_memory(err) : LAC_OK);
    LAC_TRY(request->output != NULL ? cli_output_check(request, NULL, request->output, err)
                                    : LAC_OK);
    for (size_t k = 0; k < n; k++) {
        LAC_TRY(lac_ensemble_read(request->files.word[k], &shard[k], err));
    }
    LAC_TRY(lac_ensemble_gather(n, shard, request->files.word, &all, err));
    LAC_TRY(ask(request, all, &question, err));
    LAC_TRY(put_out(request, all, &question, request->output, err));
out:
    for (size_t k = 0; shard != NULL && k < n; k++) {
        lac_ensemble_free(shard[k]);
    }
    free(shard);
    lac_ensemble_free(all);
    return status;
}
