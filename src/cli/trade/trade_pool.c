// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of a trade, each in a process of its own: its memory and time are then its own, and a
// run that breaks down takes nothing with it.
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/memory.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/trade/trade.h"
#include "scene/scene_rg.h"
#include "simulation/simulation.h"

static lac_status integrate(const cli_trade_job *job, const lac_case *c, const char *file,
                            lac_trade_measure *m, lac_error *err)
{
    lac_simulation *simulation = NULL;
    lac_store *store = NULL;
    lac_store_def def;
    lac_status status = LAC_OK;
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, err));
    LAC_TRY(lac_simulation_file(simulation, &def, err));
    cli_sign(job->request, &def.provenance);
    def.path = file;
    def.force = true;
    LAC_TRY(lac_store_create(&def, &store, err));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    const lac_sink stored = lac_store_sink(store);
    lac_trade_probe probe;
    const lac_sink sink = lac_trade_probe_start(&probe, c, &stored);
    LAC_TRY(lac_simulation_run(simulation, &sink, err));
    LAC_TRY(lac_store_finish(store, of->status, &of->run, 0.0, err));
    lac_trade_probe_values(&probe, &of->run, def.of.events, m->value);
    m->steps = (double)of->run.steps;
    m->evaluations = (double)of->run.rhs_evaluations;
    m->cells = (double)of->scene->contact.domain->n;
    // Times stay doubles in the file, the rest is what a reader of it finds.
    for (int q = LAC_QUANTITY_SLIP; c->single && q < LAC_QUANTITIES; q++) {
        m->value[q] = (double)(float)m->value[q];
    }
out:
    lac_store_free(store);
    lac_simulation_free(simulation);
    return status;
}

static lac_status follow(const lac_case *c, lac_trade_measure *m, lac_error *err)
{
    lac_scene_rg rg = {0};
    lac_status status = lac_scene_rg_run(c, NULL, &rg, err);
    if (status == LAC_OK) {
        m->value[LAC_QUANTITY_CRITICAL] = rg.result[0]->critical;
        m->cells = (double)rg.domain->n;
    }
    lac_scene_rg_clear(&rg);
    return status;
}

static lac_status add_work(void *context, const lac_history_record *record, lac_error *err)
{
    double *work = context;
    (void)err;
    *work += record->shear.dissipation;
    return LAC_OK;
}

// The contact, and the history that its case may have.
static lac_status press(const lac_case *c, lac_trade_measure *m, lac_error *err)
{
    lac_scene_contact contact = {0};
    lac_history_result result = {0};
    double work = 0.0;
    const lac_history_sink sink = {.context = &work, .step = add_work};
    lac_status status = LAC_OK;
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &contact, err));
    m->cells = (double)contact.domain->n;
    m->value[LAC_QUANTITY_FRACTION] = m->cells / (double)lac_grid_cells(&contact.grid);
    m->value[LAC_QUANTITY_PRESSURE] = contact.mean_pressure;
    m->value[LAC_QUANTITY_DIMENSION] = contact.counted ? contact.boxes.dimension : NAN;
    m->steps = contact.solved ? (double)contact.report.iterations : 0.0;
    m->evaluations = contact.solved ? (double)contact.report.products : 0.0;
    if (c->history.count > 0) {
        LAC_TRY(lac_scene_history_run(c, &contact, &sink, &result, err));
        m->value[LAC_QUANTITY_WORK] = work;
    }
out:
    lac_scene_contact_clear(&contact);
    return status;
}

// Of a run that was not measured.
static void clear(lac_trade_run *run)
{
    run->end = LAC_TRADE_BROKEN;
    run->m = (lac_trade_measure){0};
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        run->m.value[q] = NAN;
    }
}

// One run in this process; its output is written to `file`, measured and removed.
// @return of the run, as lac_run: LAC_EIO is the disk's doing, not the settings'
static lac_status compute_run(const cli_trade_job *job, const char *file, lac_trade_run *run)
{
    const double started = cli_clock();
    lac_error err = {""};
    lac_case *c = NULL;
    struct stat info;
    clear(run);
    lac_status status = cli_trade_case(job, run, &c, &err);
    if (status == LAC_OK) {
        const lac_trade_of of = lac_trade_of_run(&job->trade, run);
        status = of == LAC_OF_CASCADE   ? follow(c, &run->m, &err)
                 : of == LAC_OF_CONTACT ? press(c, &run->m, &err)
                                        : integrate(job, c, file, &run->m, &err);
    }
    lac_case_free(c);
    run->m.output = stat(file, &info) == 0 ? (double)info.st_size : 0.0;
    (void)unlink(file);
    run->end = status == LAC_OK ? LAC_TRADE_DONE : LAC_TRADE_BROKEN;
    run->m.wall_time = cli_clock() - started;
    (void)snprintf(run->message, sizeof run->message, "%s", err.message);
    return status;
}

enum { MOST_JOBS = 64 };

typedef struct worker {
    pid_t pid;
    int from; // what it says in the end
    lac_trade_run *run;
} worker;

typedef struct pool {
    cli_trade_job *job;
    worker at[MOST_JOBS]; // [busy]
    size_t busy, done, total, made;
    double memory;   // peak of the largest run so far [bytes]; 0: none is done
    double computed; // wall time of all runs that were made here [s]
} pool;

static bool is_first(const lac_trade_run *run)
{
    return (run->why & (LAC_TRADE_REFERENCE | LAC_TRADE_CHECK)) != 0;
}

// CPU time that a run may take [s]: one three times as dear as the reference, which is the
// tightest, is never worth it.
static double cap(const lac_trade *trade)
{
    double dearest = 0.0;
    for (const lac_trade_run *run = trade->run; run < trade->run + trade->runs; run++) {
        if (is_first(run) && run->end != LAC_TRADE_PENDING) {
            dearest = fmax(dearest, run->m.cpu_time);
        }
    }
    return 3.0 * dearest + 1.0;
}

// In the child, until it ends.
static void work(const cli_trade_job *job, lac_trade_run *run, int to)
{
    char file[4096];
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL); // dies with the trade
    (void)signal(SIGINT, SIG_DFL);
    (void)signal(SIGTERM, SIG_DFL);
    if (!is_first(run)) {
        const rlim_t most = (rlim_t)ceil(cap(&job->trade));
        const struct rlimit limit = {most, most + 1};
        (void)setrlimit(RLIMIT_CPU, &limit);
    }
    (void)snprintf(file, sizeof file, "%s/run-%zu.nc", job->folder, (size_t)(run - job->trade.run));
    const lac_status status = compute_run(job, file, run);
    const ssize_t written = write(to, run, sizeof *run);
    _exit(written != (ssize_t)sizeof *run ? CLI_EXIT_FAILED
          : status == LAC_EIO             ? CLI_EXIT_FILE
                                          : CLI_EXIT_DONE);
}

static lac_status launch(pool *p, lac_trade_run *run, lac_error *err)
{
    int ends[2] = {-1, -1};
    (void)fflush(NULL);
    const pid_t pid = pipe(ends) == 0 ? fork() : -1;
    const int why = errno;
    if (pid == 0) {
        (void)close(ends[0]);
        work(p->job, run, ends[1]);
    }
    (void)close(ends[1]);
    if (pid < 0) {
        (void)close(ends[0]);
        return lac_fail(err, LAC_EIO, "a run cannot be started: %s", strerror(why));
    }
    p->at[p->busy++] = (worker){.pid = pid, .from = ends[0], .run = run};
    run->end = LAC_TRADE_RUNNING;
    return LAC_OK;
}

static double seconds(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

// @param status  of its process, as wait has it
static void no_answer(lac_trade_run *run, int status)
{
    clear(run);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
        run->end = LAC_TRADE_GIVEN_UP;
        (void)snprintf(run->message, sizeof run->message,
                       "took more than three times the reference");
    } else if (WIFSIGNALED(status)) {
        (void)snprintf(run->message, sizeof run->message, "ended by signal %d: %s",
                       WTERMSIG(status), strsignal(WTERMSIG(status)));
    } else {
        (void)snprintf(run->message, sizeof run->message, "ended without an answer");
    }
}

// Takes over what a worker measured, and what the kernel did.
static lac_status finish(pool *p, size_t model, lac_error *err)
{
    int status = 0;
    struct rusage usage;
    const worker w = p->at[model];
    lac_trade_run *run = w.run;
    const bool answered = read(w.from, run, sizeof *run) == (ssize_t)sizeof *run;
    (void)close(w.from);
    while (wait4(w.pid, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    p->at[model] = p->at[--p->busy];
    if (!answered) {
        no_answer(run, status);
    }
    // a full disk says nothing of the settings: none of it is kept
    LAC_FAIL_IF(WIFEXITED(status) && WEXITSTATUS(status) == CLI_EXIT_FILE, err, LAC_EIO,
                "%s; --resume goes on", run->message);
    run->m.cpu_time = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    run->m.memory = (double)usage.ru_maxrss * 1024; // Linux counts in KiB
    p->memory = fmax(p->memory, run->m.memory);
    p->computed += run->m.wall_time;
    p->made++;
    p->done++;
    return answered || run->end == LAC_TRADE_GIVEN_UP ? cli_trade_keep(p->job, run, err) : LAC_OK;
}

// The first run is alone: it tells how much memory one takes.
static bool has_room(const pool *p)
{
    int64_t resident[MOST_JOBS];
    if (p->busy == 0) {
        return true;
    }
    if (p->busy >= (size_t)p->job->jobs || p->memory <= 0.0) {
        return false;
    }
    for (size_t k = 0; k < p->busy; k++) {
        resident[k] = cli_memory_resident("", p->at[k].pid);
    }
    return cli_memory_allows(cli_memory_free(""), (int64_t)p->memory, resident, p->busy);
}

// Whether a coarser rung of the same settings took too long already.
static bool is_hopeless(const lac_trade *trade, const lac_trade_run *run)
{
    const lac_trade_run *other = trade->run, *end = other + trade->runs;
    while (other < end &&
           (other->end != LAC_TRADE_GIVEN_UP || !lac_trade_is_coarser(trade, other, run))) {
        other++;
    }
    return other < end;
}

// The next run; NULL: none, or none before others are done.
static lac_trade_run *next_run(pool *p)
{
    const lac_trade *trade = &p->job->trade;
    lac_trade_run *const end = trade->run + trade->runs;
    bool first_left = false;
    for (lac_trade_run *run = trade->run; run < end; run++) {
        if (is_first(run) && run->end == LAC_TRADE_PENDING) {
            return run;
        }
        first_left = first_left || (is_first(run) && run->end == LAC_TRADE_RUNNING);
    }
    for (lac_trade_run *run = trade->run; run < end && !first_left; run++) {
        if (run->end == LAC_TRADE_PENDING && !is_hopeless(trade, run)) {
            return run;
        }
        if (run->end == LAC_TRADE_PENDING) {
            clear(run);
            run->end = LAC_TRADE_GIVEN_UP;
            (void)snprintf(run->message, sizeof run->message,
                           "a coarser one took too long already");
            p->done++;
        }
    }
    return NULL;
}

static void show(pool *p)
{
    char what[64] = "runs";
    if (p->made > 0) {
        const double left =
            (double)(p->total - p->done) * p->computed / (double)p->made / (double)p->job->jobs;
        (void)snprintf(what, sizeof what, "runs, some %.0f %s left", left < 90 ? left : left / 60,
                       left < 90 ? "s" : "min");
    }
    cli_progress_stage(&p->job->progress, what, p->done, p->total);
}

// Waits until a worker is done, half a second at most.
static lac_status await(pool *p, lac_error *err)
{
    struct pollfd ends[MOST_JOBS];
    for (size_t k = 0; k < p->busy; k++) {
        ends[k] = (struct pollfd){.fd = p->at[k].from, .events = POLLIN};
    }
    lac_status status = LAC_OK;
    const int ready = poll(ends, p->busy, 500);
    for (size_t k = p->busy;
         ready > 0 && k-- > 0 && status == LAC_OK;) { // the last takes its place
        if (ends[k].revents != 0 && !cli_signals_stop()) {
            status = finish(p, k, err);
        }
    }
    return status;
}

static void end_all(pool *p)
{
    for (; p->busy > 0; p->busy--) {
        const worker *w = &p->at[p->busy - 1];
        (void)kill(w->pid, SIGKILL);
        while (waitpid(w->pid, NULL, 0) < 0 && errno == EINTR) {
        }
        (void)close(w->from);
    }
}

static lac_status run_all(pool *p, lac_error *err)
{
    lac_status status = LAC_OK;
    for (lac_trade_run *run = next_run(p); status == LAC_OK; run = next_run(p)) {
        while (run != NULL && has_room(p) && status == LAC_OK) {
            status = launch(p, run, err);
            run = next_run(p);
        }
        if (status == LAC_OK && p->busy == 0) {
            return LAC_OK;
        }
        show(p);
        status = status == LAC_OK ? await(p, err) : status;
        if (cli_signals_stop()) {
            return LAC_EINTERRUPT;
        }
    }
    return status;
}

lac_status cli_trade_run(cli_trade_job *job, lac_error *err)
{
    pool p = {.job = job};
    for (size_t i = 0; i < job->trade.runs; i++) {
        const lac_trade_run *run = &job->trade.run[i];
        p.total += run->end != LAC_TRADE_REFUSED && run->end != LAC_TRADE_TWIN ? 1 : 0;
        p.done += run->end >= LAC_TRADE_DONE && run->end <= LAC_TRADE_GIVEN_UP ? 1 : 0;
        p.memory = fmax(p.memory, run->m.memory);
    }
    lac_status status = run_all(&p, err);
    if (status == LAC_EINTERRUPT) {
        (void)lac_fail(err, status, "interrupted after %zu of %zu runs; --resume goes on", p.done,
                       p.total);
    }
    end_all(&p);
    return status;
}
