// SPDX-License-Identifier: GPL-3.0-or-later
// Rule LUMP has a pass of its own: a block slips whole or not at all, and has no threshold.
#include <math.h>

#include "rg/tree.h"

// Rule LUMP: the blocks of a layer are points with the summed strength and load of their cells. A
// point slips where its own points all have, or where its load reaches its strength; it then sheds
// its drop in equal parts onto its siblings that stick. The block above starts afresh with the
// sums.

// The sticking child that is nearest to slipping; sets how near: >= 1, or infinity where its own
// points have all slipped.
static size_t nearest(const lac_rg_tree *tree, const lac_rg_layer *below, size_t n, double received,
                      double *ratio)
{
    size_t at = 0;
    *ratio = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        uint32_t c = tree->order[i].block;
        double r = below->gap[c] <= tree->tolerance
                       ? INFINITY
                       : (below->shear[c] + received) / below->strength[c];
        if (r > *ratio) {
            *ratio = r;
            at = i;
        }
    }
    return at;
}

// Whether all children slip, one after the other.
static bool all_slip(lac_rg_tree *tree, const lac_rg_layer *below, size_t n)
{
    double received = 0.0; // force on each child that sticks: equal shares
    while (n > 0) {
        double ratio;
        size_t at = nearest(tree, below, n, received, &ratio);
        if (!(ratio >= 1.0 - 1e-12)) {
            return false;
        }
        double drop = below->drop[tree->order[at].block];
        for (size_t i = at; i + 1 < n; i++) {
            tree->order[i] = tree->order[i + 1]; // keeps the order of ties: by place
        }
        n--;
        received += n > 0 ? drop / (double)n : 0.0;
    }
    return true;
}

void lac_rg_lump(lac_rg_tree *tree)
{
    for (size_t k = 1; k < tree->layers; k++) {
        const lac_rg_layer *below = &tree->layer[k - 1];
        lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++) {
            size_t n = 0;
            for (uint32_t c = layer->child[b]; c < layer->child[b + 1]; c++) {
                tree->order[n++].block = c;
            }
            layer->gap[b] = all_slip(tree, below, n) ? 0.0 : INFINITY;
        }
    }
}
