// SPDX-License-Identifier: GPL-3.0-or-later
// One run of a trade, as `lacuna run`, `lacuna rg` or `lacuna contact` makes it.
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/common/libraries.h"
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
    char libraries[256];
    lac_status status = LAC_OK;
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, err));
    LAC_TRY(lac_simulation_file(simulation, &def, err));
    cli_sign(job->request, cli_libraries(libraries, sizeof libraries), &def.provenance);
    def.path = file;
    def.force = true;
    LAC_TRY(lac_store_create(&def, &store, err));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    const lac_sink stored = lac_store_sink(store);
    lac_trade_probe probe = lac_trade_probe_create(c, &stored);
    const lac_sink sink = lac_trade_probe_sink(&probe);
    LAC_TRY(lac_simulation_run(simulation, &sink, err));
    LAC_TRY(lac_store_finish(store, of->status, &of->run, 0.0, err));
    lac_trade_probe_values(&probe, &of->run, def.events, m->value);
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

lac_status cli_trade_compute(const cli_trade_job *job, size_t run, const char *file,
                             lac_trade_measure *measure)
{
    const double started = cli_clock();
    lac_error err = {""};
    lac_case *c = NULL;
    struct stat about;
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        measure->value[q] = NAN;
    }
    lac_status status = cli_trade_case(job, run, &c, &err);
    if (status == LAC_OK) {
        status = compute(job, run, c, file, measure, &err);
    }
    lac_case_free(c);
    measure->output = stat(file, &about) == 0 ? (int64_t)about.st_size : 0;
    (void)unlink(file);
    measure->end = status == LAC_OK ? LAC_TRADE_DONE : LAC_TRADE_BROKEN;
    measure->wall_time = cli_clock() - started;
    (void)snprintf(measure->message, sizeof measure->message, "%s", err.message);
    return status;
}
