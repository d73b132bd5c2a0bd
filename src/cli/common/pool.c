// SPDX-License-Identifier: GPL-3.0-or-later
// Tasks in processes: begun as memory allows, heard by a pipe each, taken over as they answer.
#include "cli/common/pool.h"

#include <omp.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/memory.h"
#include "cli/common/words.h"

// Of tasks that take less than this a worker has one more waiting, so that it never waits itself.
static const double cheap = 0.05; // [s]
enum { AHEAD = 2 };

typedef struct worker {
    pid_t pid;
    int from, to;       // pipes of its answers and its tasks
    size_t count;       // tasks it has to answer
    size_t task[AHEAD]; // [count] in order
} worker;

// Before a result, or before the error where the status is not LAC_OK.
typedef struct answer {
    lac_status status;
    double memory; // [bytes]
} answer;

typedef struct pool {
    cli_pool *ask;
    worker at[CLI_POOL_JOBS];          // [busy]
    size_t busy, before;               // before: tasks that were done when it began
    size_t left[CLI_POOL_JOBS], lefts; // tasks that waited behind one that broke down
    double started;
    size_t room; // of what follows an answer [bytes]
    answer *heard;
} pool;

static bool get_all(int from, void *bytes, size_t size)
{
    char *at = bytes;
    ssize_t n = 0;
    for (; size > 0 && ((n = read(from, at, size)) > 0 || (n < 0 && errno == EINTR));
         at += n > 0 ? n : 0) {
        size -= n > 0 ? (size_t)n : 0;
    }
    return size == 0;
}

static double peak(const struct rusage *usage)
{
    return (double)usage->ru_maxrss * 1024; // Linux counts in KiB
}

// Signals end the parent, which ends its children.
static void settle(const pool *p, size_t task, pid_t parent)
{
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
        _exit(CLI_EXIT_FAILED);
    }
    (void)signal(SIGINT, SIG_IGN);
    (void)signal(SIGTERM, SIG_IGN);
    for (size_t k = 0; k < p->busy; k++) {
        (void)close(p->at[k].from);
        (void)close(p->at[k].to);
    }
    if (p->ask->journal >= 0) {
        (void)close(p->ask->journal);
    }
    const double most = p->ask->limit != NULL ? p->ask->limit(p->ask->context, task) : INFINITY;
    if (isfinite(most)) {
        const struct rlimit limit = {(rlim_t)ceil(most), (rlim_t)ceil(most) + 1};
        (void)setrlimit(RLIMIT_CPU, &limit);
    }
}

// In the child, until it ends.
static void work(const pool *p, size_t task, int from, int to)
{
    const cli_pool *ask = p->ask;
    answer *said = calloc(1, sizeof *said + p->room);
    bool good = said != NULL;
    while (good) {
        struct rusage usage;
        lac_error err = {""};
        said->status = ask->work(ask->context, task, said + 1, &err);
        (void)getrusage(RUSAGE_SELF, &usage);
        said->memory = peak(&usage);
        if (said->status != LAC_OK) {
            memcpy(said + 1, &err, sizeof err);
        }
        good = lac_temp_file_write(to, said, sizeof *said + p->room) && !ask->fresh &&
               get_all(from, &task, sizeof task);
    }
    _exit(CLI_EXIT_DONE);
}

static size_t next_task(pool *p)
{
    return p->lefts > 0 ? p->left[--p->lefts] : p->ask->next(p->ask->context);
}

static lac_status launch(pool *p, size_t task, lac_error *err)
{
    int answers[2] = {-1, -1}, tasks[2] = {-1, -1};
    const pid_t parent = getpid();
    (void)fflush(NULL);
    const pid_t pid = pipe(answers) == 0 && pipe(tasks) == 0 ? fork() : -1;
    const int why = errno;
    if (pid == 0) {
        (void)close(answers[0]);
        (void)close(tasks[1]);
        settle(p, task, parent);
        work(p, task, tasks[0], answers[1]);
    }
    (void)close(answers[1]);
    (void)close(tasks[0]);
    if (pid < 0) {
        (void)close(answers[0]);
        (void)close(tasks[1]);
        return lac_fail(err, LAC_EIO, "a process cannot be begun: %s", strerror(why));
    }
    p->at[p->busy++] =
        (worker){.pid = pid, .from = answers[0], .to = tasks[1], .count = 1, .task = {task}};
    return LAC_OK;
}

// Gives a worker what it is to do next. That it broke down is seen where its answer is missing.
static void feed(pool *p, worker *w)
{
    const cli_pool *ask = p->ask;
    const double each = (cli_clock() - p->started) / (double)(ask->done - p->before + 1);
    const size_t most = ask->fresh ? 0 : each < cheap ? AHEAD : 1;
    size_t task = 0;
    while (w->count < most && (task = next_task(p)) != CLI_POOL_NONE) {
        w->task[w->count++] = task;
        (void)lac_temp_file_write(w->to, &task, sizeof task);
    }
}

static double seconds(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

// Waits for a worker that has no more to do, or broke down.
static void retire(pool *p, size_t k, cli_pool_end *end)
{
    int status = 0;
    struct rusage usage = {0};
    worker *w = &p->at[k];
    (void)close(w->to);
    (void)close(w->from);
    while (wait4(w->pid, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    end->signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    end->cpu_time = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    end->memory = peak(&usage);
    while (w->count > 0) {
        p->left[p->lefts++] = w->task[--w->count];
    }
    *w = p->at[--p->busy];
}

// Takes over what a worker made, and what the kernel did.
static lac_status finish(pool *p, size_t k, lac_error *err)
{
    cli_pool *ask = p->ask;
    worker *w = &p->at[k];
    const answer *said = p->heard;
    cli_pool_end end = {.cpu_time = NAN};
    const size_t task = w->task[0];
    end.answered = get_all(w->from, p->heard, sizeof *said + p->room);
    end.memory = said->memory;
    memmove(w->task, w->task + 1, --w->count * sizeof *w->task);
    if (end.answered) {
        feed(p, w); // what it did is taken over while it goes on
    }
    if (!end.answered || w->count == 0) {
        retire(p, k, &end);
    }
    if (end.answered && said->status != LAC_OK) {
        return lac_fail(err, said->status, "%s%s", ((const lac_error *)(said + 1))->message,
                        ask->journal >= 0 ? "; --resume goes on" : "");
    }
    ask->memory = fmax(ask->memory, end.memory);
    ask->done++;
    return ask->take(ask->context, task, end.answered ? said + 1 : NULL, &end, err);
}

// The first process is alone for a second at most: it tells how much memory one takes.
static bool has_room(const pool *p)
{
    int64_t resident[CLI_POOL_JOBS], most = (int64_t)p->ask->memory;
    if (p->busy == 0) {
        return true;
    }
    if (p->busy >= (size_t)p->ask->jobs || (most == 0 && cli_clock() - p->started < 1.0)) {
        return false;
    }
    for (size_t k = 0; k < p->busy; k++) {
        resident[k] = cli_memory_resident("", p->at[k].pid);
        most = resident[k] > most ? resident[k] : most;
    }
    return cli_memory_allows(cli_memory_free(""), most, resident, p->busy);
}

static void show(const pool *p)
{
    const cli_pool *ask = p->ask;
    cli_text what = cli_format("%s", ask->what);
    if (ask->done > p->before) {
        const double left = (cli_clock() - p->started) / (double)(ask->done - p->before) *
                            (double)(ask->total - ask->done);
        what = cli_format("%s, some %.0f %s left", ask->what,
                          left < 90     ? left
                          : left < 5400 ? left / 60
                                        : left / 3600,
                          left < 90     ? "s"
                          : left < 5400 ? "min"
                                        : "h");
    }
    cli_progress_stage(ask->progress, what.s, ask->done, ask->total);
}

// Waits until a worker answers, half a second at most.
static lac_status await(pool *p, lac_error *err)
{
    struct pollfd ends[CLI_POOL_JOBS];
    for (size_t k = 0; k < p->busy; k++) {
        ends[k] = (struct pollfd){.fd = p->at[k].from, .events = POLLIN};
    }
    lac_status status = LAC_OK;
    const int ready = poll(ends, p->busy, 500);
    for (size_t k = p->busy;
         ready > 0 && k-- > 0 && status == LAC_OK;) { // the last takes its place
        if (ends[k].revents != 0 && !cli_signals_stop(NULL)) {
            status = finish(p, k, err);
        }
    }
    return status;
}

static lac_status run_all(pool *p, lac_error *err)
{
    for (;;) {
        size_t task = 0;
        while (has_room(p) && (task = next_task(p)) != CLI_POOL_NONE) {
            LAC_TRY_RETURN(launch(p, task, err));
        }
        if (p->busy == 0) {
            return LAC_OK;
        }
        show(p);
        LAC_TRY_RETURN(await(p, err));
        LAC_FAIL_IF(cli_signals_stop(NULL), err, LAC_EINTERRUPT,
                    "interrupted after %zu of %zu %s%s", p->ask->done, p->ask->total, p->ask->what,
                    p->ask->journal >= 0 ? "; --resume goes on" : "");
    }
}

lac_status cli_pool_run(cli_pool *ask, lac_error *err)
{
    pool p = {.ask = ask, .before = ask->done, .started = cli_clock()};
    p.room = ask->size > sizeof(lac_error) ? ask->size : sizeof(lac_error);
    p.heard = malloc(sizeof *p.heard + p.room);
    lac_status status = p.heard != NULL ? run_all(&p, err) : lac_fail_memory(err);
    while (p.busy > 0) {
        cli_pool_end end;
        (void)kill(p.at[p.busy - 1].pid, SIGKILL);
        p.at[p.busy - 1].count = 0;
        retire(&p, p.busy - 1, &end);
    }
    free(p.heard);
    return status;
}

void cli_pool_reason(const cli_pool_end *end, char *text, size_t room)
{
    if (end->signal != 0) {
        (void)snprintf(text, room, "ended by signal %d: %s", end->signal, strsignal(end->signal));
    } else {
        (void)snprintf(text, room, "ended without an answer");
    }
}

lac_status cli_pool_jobs(const char *text, int *jobs, lac_error *err)
{
    const int n = omp_get_num_procs(); // that a scheduler leaves of the machine
    *jobs = n < 1 ? 1 : n > CLI_POOL_JOBS ? CLI_POOL_JOBS : n;
    return text != NULL ? cli_count("--jobs", text, CLI_POOL_JOBS, jobs, err) : LAC_OK;
}

lac_status cli_pool_threads(const cli_request *request, int *threads, lac_error *err)
{
    const char *jobs = request->trade.jobs;
    LAC_FAIL_IF(jobs != NULL && request->threads > 0, err, LAC_EINPUT,
                "--jobs: is the same as --threads here: give one of them");
    *threads = request->threads > 0 ? request->threads : 1;
    return jobs != NULL ? cli_pool_jobs(jobs, threads, err) : LAC_OK;
}
