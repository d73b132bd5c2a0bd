// SPDX-License-Identifier: GPL-3.0-or-later
// A lumped run beside the cells that it stands for: what taking them together may have cost, and
// what is put out written back to them. docs/theory/lumped.md.
#include "simulation/lumped.h"

// What an error is held to: a time where one is known, else the mean slip.
static double result_of(const lac_run_result *run)
{
    return run->failed                ? run->failure_origin + run->failure_local
           : run->end == LAC_END_STOP ? run->time
                                      : run->mean_slip;
}

// What comes out where the cells of a block follow their traction less far; NaN: it ends otherwise
// than the run.
static lac_status pilot(lac_lump *lump, const lac_run_def *def, const lac_run_result *run,
                        double *out, lac_error *err)
{
    lac_status status = LAC_ENUMERIC;
    lac_run_result result = {.failed = false};
    lac_run_def own = *def;
    own.snapshots = false;
    own.points = NULL;
    own.resume = NULL;
    own.reached = NULL;
    own.checkpoint = (lac_cadence){.time = NAN, .per_decade = NAN};
    lac_lump_soften(lump, LAC_LUMP_STIFF);
    for (double rtol = fmax(def->rtol, 1e-5); status == LAC_ENUMERIC && rtol > 0.0;) {
        own.rtol = rtol;
        status = lac_run(lump->problem, &own, NULL, &result, err);
        rtol = rtol > def->rtol ? def->rtol : 0.0; // once more where the first was too rough
    }
    lac_lump_soften(lump, 1.0);
    const bool alike = result.failed == run->failed && result.end == run->end;
    *out = status == LAC_OK && alike ? result_of(&result) : (double)NAN;
    return status == LAC_ENUMERIC ? LAC_OK : status;
}

lac_status lac_lumped_judge(lac_lump *lump, const lac_run_def *def, const lac_run_result *run,
                            double *error, lac_error *err)
{
    const bool driven = run->failed || (run->end == LAC_END_STOP && !isnan(def->stop_rate));
    double stiff;
    LAC_TRY_RETURN(pilot(lump, def, run, &stiff, err));
    *error = lac_lump_bound(lump, result_of(run), stiff, driven);
    return LAC_OK;
}

enum { FIELDS = 9 };

struct lac_lumped_sink {
    lac_sink next; // first: lac_sink_before
    const lac_lump *lump;
    const lac_domain *cells;
    double *field; // [FIELDS][cells]
};

static lac_status on_snapshot(void *context, const lac_snapshot *of, lac_error *err)
{
    const lac_lumped_sink *s = context;
    const size_t n = s->cells->n;
    lac_snapshot all = *of;
    const double **const to[FIELDS] = {&all.slip,        &all.slip_rate,        &all.state,
                                       &all.traction,    &all.factor_of_safety, &all.pore,
                                       &all.excess_pore, &all.temperature,      &all.broken};
    all.n = n;
    for (size_t k = 0; k < FIELDS; k++) {
        const double *leaves = *to[k];
        double *field = s->field + k * n;
        for (size_t i = 0; leaves != NULL && i < n; i++) {
            const uint32_t leaf = s->lump->leaf[i];
            const double pressed = s->cells->pressure[i] / s->lump->domain->pressure[leaf];
            field[i] = leaves[leaf] * (to[k] == &all.traction ? pressed : 1.0);
        }
        *to[k] = leaves != NULL ? field : NULL;
    }
    return s->next.snapshot(s->next.context, &all, err);
}

lac_status lac_lumped_sink_create(const lac_lump *lump, const lac_domain *cells,
                                  const lac_sink *next, lac_lumped_sink **out, lac_error *err)
{
    lac_lumped_sink *s = malloc(sizeof *s);
    *out = s;
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    *s = (lac_lumped_sink){.next = *next, .lump = lump, .cells = cells};
    s->field = next->snapshot != NULL ? malloc(FIELDS * cells->n * sizeof *s->field) : NULL;
    LAC_FAIL_MEMORY_IF(next->snapshot != NULL && s->field == NULL, err);
    return LAC_OK;
}

void lac_lumped_sink_free(lac_lumped_sink *sink)
{
    if (sink != NULL) {
        free(sink->field);
        free(sink);
    }
}

lac_sink lac_lumped_sink_of(lac_lumped_sink *sink)
{
    lac_sink own = lac_sink_before(&sink->next);
    own.snapshot = own.snapshot != NULL ? on_snapshot : NULL;
    return own;
}
