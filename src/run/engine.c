// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/engine.h"

#include <math.h>
#include <stdlib.h>

lac_status lac_engine_create(const lac_problem *problem, const lac_run_def *def, lac_engine **out,
                             lac_error *err)
{
    lac_status status = LAC_OK;
    *out = NULL;
    lac_engine *engine = calloc(1, sizeof *engine);
    if (engine == NULL) {
        return lac_fail_memory(err);
    }
    engine->kind = def->fidelity == LAC_FIDELITY_EVENTS ? &lac_engine_events
                   : def->method == LAC_ERK             ? &lac_engine_erk
                                                        : &lac_engine_cvode;
    engine->problem = problem;
    engine->def = def;
    engine->limit = INFINITY;
    engine->n = lac_problem_cells(problem);
    engine->unknowns = lac_problem_unknowns(problem);
    engine->work = calloc(lac_problem_work(problem), sizeof *engine->work);
    if (engine->work == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    if (LAC_SUN_CONTEXT_CREATE(&engine->sun) != 0) {
        status = lac_fail_memory(err);
        goto out;
    }
    LAC_SUN_SILENCE_CONTEXT(engine->sun);
    LAC_TRY(engine->kind->create(engine, err));
    *out = engine;
    engine = NULL;
out:
    lac_engine_free(engine);
    return status;
}

void lac_engine_free(lac_engine *engine)
{
    if (engine == NULL) {
        return;
    }
    engine->kind->free(engine);
    if (engine->sun != NULL) {
        SUNContext_Free(&engine->sun);
    }
    free(engine->work);
    free(engine);
}

double lac_engine_longest_step(const lac_engine *engine)
{
    return lac_problem_longest_step(engine->problem, lac_engine_time(engine));
}

lac_status lac_engine_restart(lac_engine *engine, double h, lac_error *err)
{
    lac_problem_forget(engine->problem, engine->work);
    return engine->kind->restart(engine, h, err);
}

const char *lac_engine_unknown(const lac_engine *engine, size_t component)
{
    const char *names[] = {lac_problem_unknown(engine->problem), "ln theta", "slip"};
    return names[component / engine->n];
}

double lac_engine_mean_slip(const lac_engine *engine, const double *slip)
{
    double sum = 0.0;
    for (size_t i = 0; i < engine->n; i++) {
        sum += slip[i];
    }
    return sum / (double)engine->n;
}
