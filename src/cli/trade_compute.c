// SPDX-License-Identifier: GPL-3.0-or-later
// One run of a trade, as `lacuna run`, `lacuna rg` or `lacuna contact` makes it.
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/libraries.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/trade.h"

enum { RECORDS_BETWEEN_SYNCS = 64 };

typedef struct run_state {
    lac_case *source;
    lac_scene *scene;
    lac_analysis *analysis;
    lac_store *store;
    char *text;
} run_state;

static lac_status open_store(const cli_trade_job *job, run_state *s, const char *file,
                             lac_error *err)
{
    const lac_case *c = s->source;
    char libraries[256];
    s->text = lac_case_text(c);
    if (s->text == NULL) {
        return lac_fail_memory(err);
    }
    lac_store_def def = {.path = file,
                         .force = true,
                         .provenance = cli_provenance(job->request, c, s->text,
                                                      cli_libraries(libraries, sizeof libraries)),
                         .dated = c->dated,
                         .start_date = c->start_date,
                         .domain = s->scene->contact.domain,
                         .hierarchy = s->scene->hierarchy,
                         .transfer = &s->scene->transfer,
                         .fields = c->fields,
                         .compression = c->compression,
                         .single = c->single != 0,
                         .sync_every = RECORDS_BETWEEN_SYNCS,
                         .events = lac_analysis_has_events(s->analysis)};
    const double *once = NULL;
    if (s->analysis != NULL) {
        def.extras = lac_analysis_extras(s->analysis, &def.extra, &once);
    }
    lac_status status = lac_store_create(&def, &s->store, err);
    return status == LAC_OK && once != NULL ? lac_store_once(s->store, once, err) : status;
}

static void keep_numbers(const run_state *s, const lac_run_result *result, lac_trade_measure *m)
{
    m->steps = result->steps;
    m->evaluations = result->rhs_evaluations;
    m->cells = (int64_t)s->scene->contact.domain->n;
    // Times stay doubles in the file, the rest is what a reader of it finds.
    for (int q = LAC_QUANTITY_SLIP; s->source->single && q < LAC_QUANTITIES; q++) {
        m->value[q] = (double)(float)m->value[q];
    }
}

static lac_status integrate(const cli_trade_job *job, run_state *s, const char *file,
                            lac_trade_measure *m, lac_error *err)
{
    lac_run_result result = {0};
    lac_status status = LAC_OK;
    s->source->run.beyond = 0; // done here, or refused
    LAC_TRY(lac_scene_create(s->source, &s->scene, err));
    LAC_TRY(lac_scene_analysis_create(s->scene, NULL, &s->analysis, err));
    LAC_TRY(open_store(job, s, file, err));
    lac_sink sink = lac_store_sink(s->store);
    sink.checkpoint = NULL;
    lac_trade_probe probe = lac_trade_probe_create(s->source, &sink);
    sink = lac_trade_probe_sink(&probe);
    if (s->analysis != NULL) {
        sink = lac_analysis_sink(s->analysis, &sink);
    }
    LAC_TRY(lac_run(s->scene->problem, &s->source->run, &sink, &result, err));
    if (s->analysis != NULL) {
        LAC_TRY(lac_analysis_finish(s->analysis, &result, err));
    }
    LAC_TRY(lac_store_finish(s->store, "complete", &result, 0.0, err));
    lac_trade_probe_values(&probe, &result, lac_analysis_has_events(s->analysis), m->value);
    keep_numbers(s, &result, m);
out:
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

static lac_status compute(const cli_trade_job *job, size_t run, run_state *s, const char *file,
                          lac_trade_measure *m, lac_error *err)
{
    switch (lac_trade_of_run(&job->plan, run)) {
    case LAC_OF_CASCADE:
        return follow(s->source, m, err);
    case LAC_OF_CONTACT:
        return press(s->source, m, err);
    default:
        return integrate(job, s, file, m, err);
    }
}

static void run_clear(run_state *s)
{
    lac_store_free(s->store);
    lac_analysis_free(s->analysis);
    lac_scene_free(s->scene);
    lac_case_free(s->source);
    free(s->text);
}

lac_status cli_trade_compute(const cli_trade_job *job, size_t run, const char *file,
                             lac_trade_measure *measure)
{
    const double started = cli_clock();
    lac_error err = {""};
    run_state s = {0};
    struct stat about;
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        measure->value[q] = NAN;
    }
    lac_status status = cli_trade_case(job, run, &s.source, &err);
    if (status == LAC_OK) {
        status = compute(job, run, &s, file, measure, &err);
    }
    run_clear(&s);
    measure->output = stat(file, &about) == 0 ? (int64_t)about.st_size : 0;
    (void)unlink(file);
    measure->end = status == LAC_OK ? LAC_TRADE_DONE : LAC_TRADE_BROKEN;
    measure->wall_time = cli_clock() - started;
    (void)snprintf(measure->message, sizeof measure->message, "%s", err.message);
    return status;
}
