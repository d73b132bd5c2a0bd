// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of a trade, each in a process of its own: its memory and time are then its own, and a
// run that breaks down takes nothing with it.
#include <errno.h>
#include <inttypes.h>
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

static void keep_numbers(const lac_outcome *of, lac_trade_measure *m)
{
    m->steps = of->run.steps;
    m->evaluations = of->run.rhs_evaluations;
    m->cells = (int64_t)of->scene->contact.domain->n;
    // Times stay doubles in the file, the rest is what a reader of it finds.
    for (int q = LAC_QUANTITY_SLIP; of->source->single && q < LAC_QUANTITIES; q++) {
        m->value[q] = (double)(float)m->value[q];
    }
}

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
    lac_trade_probe probe = lac_trade_probe_create(c, &stored);
    const lac_sink sink = lac_trade_probe_sink(&probe);
    LAC_TRY(lac_simulation_run(simulation, &sink, err));
    LAC_TRY(lac_store_finish(store, of->status, &of->run, 0.0, err));
    lac_trade_probe_values(&probe, &of->run, def.of.events, m->value);
    keep_numbers(of, m);
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
        m->cells = (int64_t)rg.domain->n;
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
    LAC_TRY(lac_scene_contact_solve(c, true, &contact, err));
    m->cells = (int64_t)contact.domain->n;
    m->value[LAC_QUANTITY_FRACTION] = (double)m->cells / (double)lac_grid_cells(&contact.grid);
    m->value[LAC_QUANTITY_PRESSURE] = contact.mean_pressure;
    m->value[LAC_QUANTITY_DIMENSION] = contact.counted ? contact.boxes.dimension : NAN;
    m->steps = contact.solved ? contact.report.iterations : 0;
    m->evaluations = contact.solved ? contact.report.products : 0;
    if (c->history.count > 0) {
        LAC_TRY(lac_scene_history_run(c, &contact, &sink, &result, err));
        m->value[LAC_QUANTITY_WORK] = work;
    }
out:
    lac_scene_contact_clear(&contact);
    return status;
}

static lac_status compute(const cli_trade_job *job, size_t run, const lac_case *c, const char *file,
                          lac_trade_measure *m, lac_error *err)
{
    switch (lac_trade_of_run(&job->plan, run)) {
    case LAC_OF_CASCADE:
        return follow(c, m, err);
    case LAC_OF_CONTACT:
        return press(c, m, err);
    default:
        return integrate(job, c, file, m, err);
    }
}

// One run in this process; its output is written to `file`, measured and removed.
// @return of the run, as lac_run: LAC_EIO is the disk's doing, not the settings'
static lac_status compute_run(const cli_trade_job *job, size_t run, const char *file,
                              lac_trade_measure *measure)
{
    const double started = cli_clock();
    lac_error err = {""};
    lac_case *c = NULL;
    struct stat info;
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        measure->value[q] = NAN;
    }
    lac_status status = cli_trade_case(job, run, &c, &err);
    if (status == LAC_OK) {
        status = compute(job, run, c, file, measure, &err);
    }
    lac_case_free(c);
    measure->output = stat(file, &info) == 0 ? (int64_t)info.st_size : 0;
    (void)unlink(file);
    measure->end = status == LAC_OK ? LAC_TRADE_DONE : LAC_TRADE_BROKEN;
    measure->wall_time = cli_clock() - started;
    (void)snprintf(measure->message, sizeof measure->message, "%s", err.message);
    return status;
}

enum { MOST_JOBS = 64 };

typedef struct worker {
    pid_t pid;
    int from; // what it says in the end
    size_t run;
} worker;

typedef struct pool {
    cli_trade_job *job;
    worker at[MOST_JOBS]; // [busy]
    size_t busy, done, total;
    bool *started;   // [runs]
    double cap;      // CPU time that a run may take [s]; INFINITY: any
    int64_t memory;  // peak of the largest run so far [bytes]; 0: none is done
    double computed; // wall time of all runs that were made here [s]
    size_t made;
} pool;

static bool is_first(const lac_trade_plan *plan, size_t run)
{
    return (plan->run[run].why & (LAC_TRADE_REFERENCE | LAC_TRADE_CHECK)) != 0;
}

// In the child, until it ends.
static void work(const pool *p, size_t run, int to)
{
    char file[4096];
    lac_trade_measure m;
    memset(&m, 0, sizeof m);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL); // dies with the trade
    (void)signal(SIGINT, SIG_DFL);
    (void)signal(SIGTERM, SIG_DFL);
    if (isfinite(p->cap)) {
        const rlim_t seconds = (rlim_t)ceil(p->cap);
        const struct rlimit limit = {seconds, seconds + 1};
        (void)setrlimit(RLIMIT_CPU, &limit);
    }
    (void)snprintf(file, sizeof file, "%s/run-%zu.nc", p->job->folder, run);
    const lac_status status = compute_run(p->job, run, file, &m);
    const ssize_t written = write(to, &m, sizeof m);
    _exit(written != (ssize_t)sizeof m ? CLI_EXIT_FAILED
          : status == LAC_EIO          ? CLI_EXIT_FILE
                                       : CLI_EXIT_DONE);
}

static lac_status launch(pool *p, size_t run, lac_error *err)
{
    int ends[2];
    LAC_FAIL_IF(pipe(ends) != 0, err, LAC_EIO, "a run cannot be started: %s", strerror(errno));
    (void)fflush(NULL);
    const pid_t pid = fork();
    if (pid == 0) {
        (void)close(ends[0]);
        work(p, run, ends[1]);
    }
    (void)close(ends[1]);
    if (pid < 0) {
        (void)close(ends[0]);
        return lac_fail(err, LAC_EIO, "a run cannot be started: %s", strerror(errno));
    }
    p->at[p->busy++] = (worker){.pid = pid, .from = ends[0], .run = run};
    p->started[run] = true;
    return LAC_OK;
}

static double seconds(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

static void no_answer(lac_trade_measure *m, int status)
{
    *m = (lac_trade_measure){.end = LAC_TRADE_BROKEN};
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        m->value[q] = NAN;
    }
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU)) {
        m->end = LAC_TRADE_GIVEN_UP;
        (void)snprintf(m->message, sizeof m->message, "took more than three times the reference");
    } else if (WIFSIGNALED(status)) {
        (void)snprintf(m->message, sizeof m->message, "ended by signal %d: %s", WTERMSIG(status),
                       strsignal(WTERMSIG(status)));
    } else {
        (void)snprintf(m->message, sizeof m->message, "ended without an answer");
    }
}

// Takes over what a worker measured, and what the kernel did.
static lac_status finish(pool *p, size_t model, lac_error *err)
{
    int status = 0;
    struct rusage usage;
    const worker w = p->at[model];
    lac_trade_measure *m = &p->job->measure[w.run];
    const bool answered = read(w.from, m, sizeof *m) == (ssize_t)sizeof *m;
    (void)close(w.from);
    while (wait4(w.pid, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    p->at[model] = p->at[--p->busy];
    if (!answered) {
        no_answer(m, status);
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == CLI_EXIT_FILE) {
        // a full disk says nothing of the settings: none of it is kept
        return lac_fail(err, LAC_EIO, "%s; --resume goes on", m->message);
    }
    m->cpu_time = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    m->memory = (int64_t)usage.ru_maxrss * 1024; // Linux counts in KiB
    p->memory = m->memory > p->memory ? m->memory : p->memory;
    p->computed += m->wall_time;
    p->made++;
    p->done++;
    return answered || m->end == LAC_TRADE_GIVEN_UP ? cli_trade_keep(p->job, w.run, err) : LAC_OK;
}

// The first run is alone: it tells how much memory one takes.
static bool has_room(const pool *p)
{
    int64_t resident[MOST_JOBS];
    if (p->busy == 0) {
        return true;
    }
    if (p->busy >= (size_t)p->job->jobs || p->memory <= 0) {
        return false;
    }
    for (size_t k = 0; k < p->busy; k++) {
        resident[k] = cli_memory_resident("", p->at[k].pid);
    }
    return cli_memory_allows(cli_memory_free(""), p->memory, resident, p->busy);
}

// A run three times as dear as the reference, which is the tightest, is never worth it.
static void set_cap(pool *p)
{
    const lac_trade_plan *plan = &p->job->plan;
    double dearest = 0.0;
    for (size_t i = 0; i < plan->runs; i++) {
        const lac_trade_measure *m = &p->job->measure[i];
        if (is_first(plan, i) && m->end != LAC_TRADE_PENDING) {
            dearest = fmax(dearest, m->cpu_time);
        }
    }
    p->cap = 3.0 * dearest + 1.0;
}

// Whether a coarser rung of the same settings took too long already.
static bool is_hopeless(const pool *p, size_t run)
{
    const lac_trade_plan *plan = &p->job->plan;
    for (size_t i = 0; i < plan->runs; i++) {
        if (p->job->measure[i].end == LAC_TRADE_GIVEN_UP && lac_trade_is_coarser(plan, i, run)) {
            return true;
        }
    }
    return false;
}

static bool is_waiting(const pool *p, size_t run)
{
    return p->job->measure[run].end == LAC_TRADE_PENDING && !p->started[run];
}

// The next run; SIZE_MAX: none, or none before others are done.
static size_t next_run(pool *p)
{
    const lac_trade_plan *plan = &p->job->plan;
    bool first_left = false;
    for (size_t i = 0; i < plan->runs; i++) {
        if (is_first(plan, i) && is_waiting(p, i)) {
            return i;
        }
        first_left = first_left || (is_first(plan, i) && p->started[i] &&
                                    p->job->measure[i].end == LAC_TRADE_PENDING);
    }
    if (first_left) {
        return SIZE_MAX;
    }
    set_cap(p);
    for (size_t i = 0; i < plan->runs; i++) {
        if (is_waiting(p, i) && is_hopeless(p, i)) {
            lac_trade_measure *m = &p->job->measure[i];
            no_answer(m, SIGXCPU);
            (void)snprintf(m->message, sizeof m->message, "a coarser one took too long already");
            p->done++;
        } else if (is_waiting(p, i)) {
            return i;
        }
    }
    return SIZE_MAX;
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
        if (ends[k].revents != 0 && !cli_signals_stop(NULL)) {
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
    for (size_t run = next_run(p); status == LAC_OK; run = next_run(p)) {
        while (run != SIZE_MAX && has_room(p) && status == LAC_OK) {
            status = launch(p, run, err);
            run = next_run(p);
        }
        if (status == LAC_OK && p->busy == 0) {
            return LAC_OK;
        }
        show(p);
        status = status == LAC_OK ? await(p, err) : status;
        if (cli_signals_stop(NULL)) {
            return LAC_EINTERRUPT;
        }
    }
    return status;
}

lac_status cli_trade_run(cli_trade_job *job, lac_error *err)
{
    pool p = {.job = job, .cap = INFINITY};
    p.started = calloc(job->plan.runs, sizeof *p.started);
    LAC_FAIL_MEMORY_IF(p.started == NULL, err);
    for (size_t i = 0; i < job->plan.runs; i++) {
        const lac_trade_measure *m = &job->measure[i];
        p.total += m->end != LAC_TRADE_REFUSED && m->end != LAC_TRADE_TWIN ? 1 : 0;
        p.done += m->end >= LAC_TRADE_DONE && m->end <= LAC_TRADE_GIVEN_UP ? 1 : 0;
        p.memory = m->memory > p.memory ? m->memory : p.memory;
    }
    lac_status status = run_all(&p, err);
    if (status == LAC_EINTERRUPT) {
        (void)lac_fail(err, status, "interrupted after %zu of %zu runs; --resume goes on", p.done,
                       p.total);
    }
    end_all(&p);
    free(p.started);
    return status;
}
