// SPDX-License-Identifier: GPL-3.0-or-later
// A lumped run beside the cells that it stands for: what taking them together may have cost, and
// what is put out written back to them. docs/theory/lumped.md.
#include "simulation/lumped.h"

typedef struct back {
    lac_sink next; // first: lac_sink_before
    const lac_scene *scene;
    double *field; // [LAC_SNAPSHOT_FIELDS][cells]
} back;

static lac_status on_snapshot(void *context, const lac_snapshot *of, lac_error *err)
{
    const back *s = context;
    const lac_domain *cells = s->scene->contact.domain;
    const lac_lump *lump = s->scene->lump;
    const size_t n = cells->n;
    lac_snapshot all = *of;
    const double **to[LAC_SNAPSHOT_FIELDS];
    lac_snapshot_fields(&all, to);
    all.n = n;
    for (size_t k = 0; k < LAC_SNAPSHOT_FIELDS; k++) {
        const double *leaves = *to[k];
        double *field = s->field + k * n;
        for (size_t i = 0; leaves != NULL && i < n; i++) {
            const uint32_t leaf = lump->leaf[i];
            const double pressed = cells->pressure[i] / lump->domain->pressure[leaf];
            field[i] = leaves[leaf] * (to[k] == &all.traction ? pressed : 1.0);
        }
        *to[k] = leaves != NULL ? field : NULL;
    }
    return s->next.snapshot(s->next.context, &all, err);
}

// What taking cells together may have cost.
static lac_status judge(const lac_scene *scene, lac_run_result *run, lac_error *err)
{
    const bool by_time = run->end == LAC_END_TIME, over = run->end != LAC_END_INTERRUPT;
    const double value = by_time ? run->mean_slip : over ? run->time : (double)NAN;
    run->lump_error_estimated = lac_lump_error(scene->lump, by_time, value);
    const lac_status status =
        lac_lump_judge(scene->lump, run->lump_error_estimated, scene->source->lump.error, err);
    if (status != LAC_OK) {
        run->failed = false;
        run->failure_origin = run->failure_local = NAN;
        run->end = LAC_END_ERROR;
    }
    return status;
}

lac_status lac_lumped_run(const lac_scene *scene, const lac_run_def *def, const lac_sink *sink,
                          lac_run_result *out, lac_error *err)
{
    back b = {.scene = scene};
    lac_sink own;
    if (sink != NULL) {
        b.next = *sink;
        own = lac_sink_before(&b.next);
    }
    if (sink != NULL && sink->snapshot != NULL) {
        b.field = malloc(LAC_SNAPSHOT_FIELDS * scene->contact.domain->n * sizeof *b.field);
        LAC_FAIL_MEMORY_IF(b.field == NULL, err);
        own.snapshot = on_snapshot;
    }
    const lac_status status =
        lac_run(scene->lump->problem, def, sink != NULL ? &own : NULL, out, err);
    free(b.field);
    return status == LAC_OK ? judge(scene, out, err) : status;
}
