// SPDX-License-Identifier: GPL-3.0-or-later
// A lumped run beside the cells that it stands for: what taking them together may have cost, and
// what is put out written back to them. docs/theory/lumped.md.
#include "simulation/lumped.h"

struct lac_lumped_sink {
    lac_sink next; // first: lac_sink_before
    const lac_lump *lump;
    const lac_domain *cells;
    double *field; // [LAC_SNAPSHOT_FIELDS][cells]
};

static lac_status on_snapshot(void *context, const lac_snapshot *of, lac_error *err)
{
    const lac_lumped_sink *s = context;
    const size_t n = s->cells->n;
    lac_snapshot all = *of;
    const double **to[LAC_SNAPSHOT_FIELDS];
    lac_snapshot_fields(&all, to);
    all.n = n;
    for (size_t k = 0; k < LAC_SNAPSHOT_FIELDS; k++) {
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
    s->field =
        next->snapshot != NULL ? malloc(LAC_SNAPSHOT_FIELDS * cells->n * sizeof *s->field) : NULL;
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
