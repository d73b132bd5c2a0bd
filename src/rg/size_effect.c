// SPDX-License-Identifier: GPL-3.0-or-later
// The strength of blocks by their size: when each slips by itself, and what it carries then.

#include <math.h>
#include <stdlib.h>

#include "rg/path.h"
#include "rg/tree.h"

lac_status lac_rg_states_create(const lac_rg_tree *tree, lac_rg_block_state **states,
                                lac_error *err)
{
    size_t total = 0;
    for (size_t k = 0; k < tree->layers; k++) {
        total += tree->layer[k].count;
    }
    *states = calloc(total + 1, sizeof **states);
    for (size_t i = 0; *states != NULL && i < total; i++) {
        (*states)[i].gap = INFINITY; // nothing is known before the first load
        (*states)[i].fall = NAN;
    }
    return *states != NULL ? LAC_OK : lac_fail_memory(err);
}

// Part of the step to `gap` after which the block slipped. Under `elastic` a threshold ends at 0,
// that of its cells that have slipped long before, and does not tell how far beyond it the load is.
static double part_of_step(const lac_rg_block_state *s, double gap, double step, double tolerance)
{
    if (!isfinite(s->gap) || step <= 0.0) {
        return step > 0.0 && isinf(gap - s->gap) ? 0.5 : 1.0;
    }
    double fall = gap < -tolerance || !(s->fall > 0.0) ? s->gap - gap : s->fall * step;
    double x = fall > 0.0 ? s->gap / fall : 1.0;
    return fmin(fmax(x, 0.0), 1.0);
}

void lac_rg_states_note(const lac_rg_tree *tree, double before, double load, lac_rg_block_state *s)
{
    for (size_t k = 0; k < tree->layers; k++) {
        const lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++, s++) {
            double gap = layer->gap[b];
            if (!s->slipped && gap <= tree->tolerance) {
                s->slipped = true;
                double x = part_of_step(s, gap, load - before, tree->tolerance);
                s->load = before + x * (load - before);
                s->carried = k == 0 && isfinite(s->gap)
                                 ? s->force + s->gap // a cell: its strength
                                 : s->force + x * (layer->shear[b] - s->force);
            }
            s->fall = (s->gap - gap) / (load - before);
            s->gap = gap;
            s->force = layer->shear[b];
        }
    }
}

static void summarise(size_t count, const lac_rg_block_state *s, double cells, lac_rg_sizes *out)
{
    double load = 0.0;
    double sum = 0.0;
    double square = 0.0;
    *out = (lac_rg_sizes){0};
    for (size_t b = 0; b < count; b++) {
        if (s[b].slipped) {
            double q = s[b].carried / cells;
            out->blocks++;
            load += s[b].load;
            sum += q;
            square += q * q;
        }
    }
    double n = (double)out->blocks;
    out->load = load / n;
    out->strength = sum / n;
    out->spread = sqrt(fmax(0.0, square / n - out->strength * out->strength));
}

void lac_rg_states_summarise(const lac_rg_tree *tree, const lac_rg_block_state *s, bool line,
                             lac_rg_sizes *sizes)
{
    for (size_t level = 0; level <= tree->levels; level++) {
        size_t k = tree->of_level[level];
        const lac_rg_block_state *of_layer = s;
        for (size_t below = 0; below < k; below++) {
            of_layer += tree->layer[below].count;
        }
        double cells = pow(line ? 2.0 : 4.0, (double)level);
        summarise(tree->layer[k].count, of_layer, cells, &sizes[level]);
    }
}

void lac_rg_sizes_close(const lac_rg_tree *tree, bool line, double critical, lac_rg_sizes *sizes)
{
    const size_t top = tree->layers - 1;
    for (size_t level = 0; level <= tree->levels; level++) {
        if (tree->of_level[level] == top && sizes[level].blocks > 0) {
            sizes[level].load = critical;
            sizes[level].strength =
                critical * tree->layer[top].strength[0] / pow(line ? 2.0 : 4.0, (double)level);
        }
    }
}
