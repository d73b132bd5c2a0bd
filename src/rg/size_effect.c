// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>

#include "rg/tree.h"

enum { SCAN = 128 };

// What is known of a block before it slips.
typedef struct state {
    double gap, force; // at the load before
    bool slipped;
    double load;    // at which it did
    double carried; // force on its cells then
} state;

static lac_status create_states(const lac_rg_tree *tree, state **out, lac_error *err)
{
    size_t total = 0;
    for (size_t k = 0; k < tree->layers; k++) {
        total += tree->layer[k].count;
    }
    state *s = calloc(total + 1, sizeof *s);
    if (s == NULL) {
        return lac_fail_memory(err);
    }
    *out = s;
    return LAC_OK;
}

// Takes note of the blocks that slip between two loads, by interpolation where thresholds tell.
static void note(const lac_rg_tree *tree, double before, double load, state *s)
{
    for (size_t k = 0; k < tree->layers; k++) {
        const lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++, s++) {
            double gap = layer->gap[b];
            if (!s->slipped && gap <= tree->tolerance) {
                s->slipped = true;
                double x = s->gap > gap && isfinite(s->gap) ? s->gap / (s->gap - gap) : 1.0;
                x = fmin(fmax(x, 0.0), 1.0);
                s->load = before + x * (load - before);
                s->carried = s->force + x * (layer->shear[b] - s->force);
            }
            s->gap = gap;
            s->force = layer->shear[b];
        }
    }
}

static void summarise(size_t count, const state *s, double cells, lac_rg_sizes *out)
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

lac_status lac_rg_size_effect(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path,
                              bool line, lac_rg_sizes *sizes, double *work, lac_error *err)
{
    double *shear = work;
    double *gap = work + tree->layer[0].count;
    state *s = NULL;
    lac_status status = create_states(tree, &s, err);
    if (status != LAC_OK) {
        return status;
    }
    for (int i = 0; i <= SCAN; i++) {
        double load = (double)i / SCAN;
        lac_rg_path_at(path, load, shear, gap);
        (void)lac_rg_pass(tree, rule, shear, gap);
        note(tree, (double)(i - 1) / SCAN, load, s);
    }
    for (size_t level = 0; level <= tree->levels; level++) {
        size_t k = tree->of_level[level];
        const state *of_layer = s;
        for (size_t below = 0; below < k; below++) {
            of_layer += tree->layer[below].count;
        }
        double cells = pow(line ? 2.0 : 4.0, (double)level);
        summarise(tree->layer[k].count, of_layer, cells, &sizes[level]);
    }
    free(s);
    return LAC_OK;
}
