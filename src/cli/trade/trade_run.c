// SPDX-License-Identifier: GPL-3.0-or-later
// The runs of a trade: what each measures, in a process of its own, and which is next.
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/common/output.h"
#include "cli/trade/trade.h"
#include "scene/scene_rg.h"
#include "simulation/simulation.h"
#include "trade/probe.h"

void cli_trade_settle(cli_trade_job *job)
{
    // settings that only all cells at every step have
    static const char *const of_ode[] = {"method", "formulation", "transfer", "planning"};
    lac_case *c = job->source;
    const char *settings = job->request->trade.settings;
    lac_simulation *simulation = NULL;
    bool turns_ode = false;
    for (size_t i = 0; settings != NULL && i < sizeof of_ode / sizeof *of_ode; i++) {
        turns_ode = turns_ode || strstr(settings, of_ode[i]) != NULL;
    }
    if (c->run.fidelity != LAC_FIDELITY_AUTO) {
        return;
    }
    c->run.fidelity = LAC_FIDELITY_ODE;
    if (!turns_ode && isnan(c->accuracy)) {
        c->run.fidelity = LAC_FIDELITY_AUTO;
        if (lac_simulation_create(c, NULL, &simulation, NULL) == LAC_OK) {
            const lac_outcome *of = lac_simulation_outcome(simulation);
            c->run.fidelity = of->source->run.fidelity;
            cli_say(job->request, "fidelity %s: %s", lac_fidelity_name(c->run.fidelity),
                    of->fidelity_why);
        }
        lac_simulation_free(simulation);
    }
    job->fidelity = lac_fidelity_name(c->run.fidelity == LAC_FIDELITY_ASYNC ? c->run.fidelity
                                                                            : LAC_FIDELITY_ODE);
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

static bool is_first(const lac_trade_run *run)
{
    return (run->why & (LAC_TRADE_REFERENCE | LAC_TRADE_CHECK)) != 0;
}

// CPU time that a run may take [s]: one three times as dear as the reference, which is the
// tightest, is never worth it.
static double limit(void *context, size_t task)
{
    const lac_trade *trade = &((const cli_trade_job *)context)->trade;
    double dearest = 0.0;
    for (const lac_trade_run *run = trade->run; run < trade->run + trade->runs; run++) {
        if (is_first(run) && run->end != LAC_TRADE_PENDING) {
            dearest = fmax(dearest, run->m.cpu_time);
        }
    }
    return is_first(&trade->run[task]) ? INFINITY : 3.0 * dearest + 1.0;
}

// In the process of a run.
static lac_status work(void *context, size_t task, void *result, lac_error *err)
{
    const cli_trade_job *job = context;
    lac_trade_run *run = result;
    char file[sizeof job->keep.folder + 32];
    *run = job->trade.run[task];
    (void)snprintf(file, sizeof file, "%s/run-%zu.nc", job->keep.folder, task);
    // a full disk says nothing of the settings: none of it is kept
    return compute_run(job, file, run) != LAC_EIO ? LAC_OK
                                                  : lac_fail(err, LAC_EIO, "%s", run->message);
}

// Takes over what was measured, and what the kernel did.
static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    cli_trade_job *job = context;
    lac_trade_run *run = &job->trade.run[task];
    if (result != NULL) {
        *run = *(const lac_trade_run *)result;
    } else {
        clear(run);
        cli_pool_reason(end, run->message, sizeof run->message);
    }
    if (end->signal == SIGXCPU) {
        run->end = LAC_TRADE_GIVEN_UP;
        (void)snprintf(run->message, sizeof run->message,
                       "took more than three times the reference");
    }
    run->m.cpu_time = end->cpu_time;
    run->m.memory = end->memory;
    return result != NULL || run->end == LAC_TRADE_GIVEN_UP
               ? cli_keep_add(&job->keep, run->key, run, err)
               : LAC_OK;
}

void cli_trade_take_over(void *context, uint64_t key, const void *content)
{
    const lac_trade *trade = &((const cli_trade_job *)context)->trade;
    const lac_trade_run *kept = content;
    for (lac_trade_run *run = trade->run; run < trade->run + trade->runs; run++) {
        if (run->end == LAC_TRADE_PENDING && run->key == key) {
            run->end = kept->end;
            run->m = kept->m;
            memcpy(run->message, kept->message, sizeof run->message);
        }
    }
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

static size_t begin(const lac_trade *trade, lac_trade_run *run)
{
    run->end = LAC_TRADE_RUNNING;
    return (size_t)(run - trade->run);
}

// The next run: none of the others before the reference and its checks are done.
static size_t next(void *context)
{
    cli_trade_job *job = context;
    const lac_trade *trade = &job->trade;
    lac_trade_run *const end = trade->run + trade->runs;
    bool first_left = false;
    for (lac_trade_run *run = trade->run; run < end; run++) {
        if (is_first(run) && run->end == LAC_TRADE_PENDING) {
            return begin(trade, run);
        }
        first_left = first_left || (is_first(run) && run->end == LAC_TRADE_RUNNING);
    }
    for (lac_trade_run *run = trade->run; run < end && !first_left; run++) {
        if (run->end == LAC_TRADE_PENDING && !is_hopeless(trade, run)) {
            return begin(trade, run);
        }
        if (run->end == LAC_TRADE_PENDING) {
            clear(run);
            run->end = LAC_TRADE_GIVEN_UP;
            (void)snprintf(run->message, sizeof run->message,
                           "a coarser one took too long already");
            job->pool.done++;
        }
    }
    return CLI_POOL_NONE;
}

lac_status cli_trade_run(cli_trade_job *job, lac_error *err)
{
    job->pool = (cli_pool){.what = "runs",
                           .size = sizeof(lac_trade_run),
                           .jobs = job->pool.jobs,
                           .fresh = true,
                           .journal = lac_kept_file(job->keep.done),
                           .progress = &job->progress,
                           .context = job,
                           .next = next,
                           .work = work,
                           .take = take,
                           .limit = limit};
    for (size_t i = 0; i < job->trade.runs; i++) {
        const lac_trade_run *run = &job->trade.run[i];
        job->pool.total += run->end != LAC_TRADE_REFUSED && run->end != LAC_TRADE_TWIN ? 1 : 0;
        job->pool.done += run->end >= LAC_TRADE_DONE && run->end <= LAC_TRADE_GIVEN_UP ? 1 : 0;
        job->pool.memory = fmax(job->pool.memory, run->m.memory);
    }
    return cli_pool_run(&job->pool, err);
}
