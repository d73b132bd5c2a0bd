// SPDX-License-Identifier: GPL-3.0-or-later
// One load on the tree: which blocks slip, from the cells up; what stress is left them, down again.
#include "rg/tree.h"

// A block's children slip in the order of their thresholds. Each that has slipped hands stress to
// the cells of those that have not: `acc`, the stress received, under FIX; under CONS `E`, the
// force that the W cells left must take over. docs/theory/rg.md, "Pass".

static bool before(const lac_rg_child *a, const lac_rg_child *b)
{
    if (a->gap != b->gap) {
        return a->gap < b->gap;
    }
    return a->strength != b->strength ? a->strength < b->strength : a->block < b->block;
}

// The children of a block, which are few, in the order in which they slip; gives back how many.
static size_t sort(const lac_rg_layer *below, uint32_t begin, uint32_t end, lac_rg_child *order)
{
    const size_t n = end - begin;
    for (size_t i = 0; i < n; i++) {
        uint32_t c = begin + (uint32_t)i;
        lac_rg_child child = {below->gap[c], below->strength[c], c};
        size_t at = i;
        while (at > 0 && before(&child, &order[at - 1])) {
            order[at] = order[at - 1];
            at--;
        }
        order[at] = child;
    }
    return n;
}

// What has slipped among the children of a block, and what that does to the others.
typedef struct slide {
    double left;     // W: cells that still stick
    double received; // acc: stress on each of them, FIX
    double excess;   // E: force that they share, CONS
} slide;

static void slip(slide *s, const lac_rg_layer *below, uint32_t c)
{
    s->left -= below->cells[c];
    s->excess += below->shear[c] - (below->strength[c] - below->drop[c]);
    if (s->left > 0.0) {
        s->received += below->drop[c] / s->left;
    }
}

// Of two children: the one that slips first, and what it leaves the other to bear.
static double threshold_of_two(const lac_rg_tree *tree, const lac_rg_layer *below, double all,
                               uint32_t c)
{
    const lac_rg_child one = {below->gap[c], below->strength[c], c};
    const lac_rg_child two = {below->gap[c + 1], below->strength[c + 1], c + 1};
    const uint32_t first = before(&two, &one) ? c + 1 : c;
    const uint32_t last = 2 * c + 1 - first;
    const double left = below->cells[last];
    double needed = below->gap[last];
    if (tree->rule == LAC_RG_FIX) {
        needed -= below->drop[first] / left;
    } else {
        double kept = below->strength[first] - below->drop[first];
        needed = (left * needed - (below->shear[first] - kept)) / all;
    }
    return fmax(needed, below->gap[first]);
}

// The smallest stress on all cells of a block that makes each child slip in turn.
static double threshold(lac_rg_tree *tree, const lac_rg_layer *below, const lac_rg_layer *layer,
                        size_t block)
{
    const uint32_t *child = &layer->child[block];
    if (child[1] - child[0] == 1) {
        return below->gap[child[0]];
    }
    const double all = layer->cells[block];
    if (child[1] - child[0] == 2) {
        return threshold_of_two(tree, below, all, child[0]);
    }
    size_t n = sort(below, child[0], child[1], tree->order);
    double best = -INFINITY;
    slide s = {.left = all};
    for (size_t i = 0; i < n; i++) {
        double gap = tree->order[i].gap;
        double needed =
            tree->rule == LAC_RG_FIX ? gap - s.received : (s.left * gap - s.excess) / all;
        best = needed > best ? needed : best;
        slip(&s, below, tree->order[i].block);
    }
    return best;
}

static void sum_shear(lac_rg_tree *tree)
{
    for (size_t k = 1; k < tree->layers; k++) {
        const double *below = tree->layer[k - 1].shear;
        const lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++) {
            double sum = 0.0;
            for (uint32_t c = layer->child[b]; c < layer->child[b + 1]; c++) {
                sum += below[c];
            }
            layer->shear[b] = sum;
        }
    }
}

// The caller's number of a cell.
static size_t cell_of(const lac_rg_tree *tree, size_t i)
{
    return tree->cell != NULL ? tree->cell[i] : i;
}

static void load_cells(const lac_rg_tree *tree, const double *shear, const double *gap)
{
    const lac_rg_layer *cells = &tree->layer[0];
    for (size_t i = 0; i < cells->count; i++) {
        size_t c = cell_of(tree, i);
        cells->shear[i] = shear[c];
        cells->gap[i] = gap != NULL ? gap[c] : cells->strength[i] - cells->shear[i];
    }
}

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

static void lump(lac_rg_tree *tree)
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

double lac_rg_pass(lac_rg_tree *tree, lac_rg_rule rule, const double *shear, const double *gap)
{
    tree->rule = rule;
    load_cells(tree, shear, gap);
    sum_shear(tree);
    if (rule == LAC_RG_LUMP) {
        lump(tree);
    }
    for (size_t k = 1; k < tree->layers && rule != LAC_RG_LUMP; k++) {
        lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++) {
            layer->gap[b] = threshold(tree, &tree->layer[k - 1], layer, b);
        }
    }
    return tree->layer[tree->layers - 1].gap[0];
}

// The children of a block that has received `received` in all: those that slip get infinity.
static void settle_block(lac_rg_tree *tree, size_t k, size_t block)
{
    lac_rg_layer *below = &tree->layer[k - 1];
    const lac_rg_layer *layer = &tree->layer[k];
    const uint32_t begin = layer->child[block], end = layer->child[block + 1];
    const double received = layer->received[block];
    const bool fix = tree->rule == LAC_RG_FIX;
    bool whole = received == INFINITY || layer->gap[block] <= received + tree->tolerance;
    slide s = {.left = layer->cells[block],
               .received = received,
               .excess = received * layer->cells[block]};
    double share = received;
    size_t n = whole ? 0 : sort(below, begin, end, tree->order);
    size_t i = 0;
    for (; i < n && s.left > 0.0 && tree->order[i].gap <= share + tree->tolerance; i++) {
        below->received[tree->order[i].block] = INFINITY;
        slip(&s, below, tree->order[i].block);
        share = fix ? s.received : s.excess / s.left;
    }
    for (; i < n; i++) {
        below->received[tree->order[i].block] = share;
    }
    for (uint32_t c = begin; c < end && whole; c++) {
        below->received[c] = INFINITY;
    }
}

// LUMP has no thresholds to hand stress to: a block that slips takes its cells along.
static void settle_lump(lac_rg_tree *tree, size_t k, size_t block)
{
    const lac_rg_layer *layer = &tree->layer[k];
    bool whole = layer->received[block] == INFINITY || layer->gap[block] <= tree->tolerance;
    for (uint32_t c = layer->child[block]; c < layer->child[block + 1]; c++) {
        tree->layer[k - 1].received[c] = whole ? INFINITY : 0.0;
    }
}

void lac_rg_resolve(lac_rg_tree *tree, uint8_t *slipped, double *stress)
{
    tree->layer[tree->layers - 1].received[0] = 0.0;
    for (size_t k = tree->layers; k-- > 1;) {
        for (size_t b = 0; b < tree->layer[k].count; b++) {
            if (tree->rule == LAC_RG_LUMP) {
                settle_lump(tree, k, b);
            } else {
                settle_block(tree, k, b);
            }
        }
    }
    const lac_rg_layer *cells = &tree->layer[0];
    for (size_t i = 0; i < cells->count; i++) {
        size_t c = cell_of(tree, i);
        slipped[c] = cells->gap[i] <= cells->received[i] + tree->tolerance ? 1 : 0;
        if (stress != NULL) {
            stress[c] = slipped[c] != 0 ? 0.0 : cells->received[i];
        }
    }
}

void lac_rg_own_levels(lac_rg_tree *tree, double *level)
{
    size_t above = tree->levels;
    for (size_t k = tree->layers; k-- > 0;) {
        lac_rg_layer *layer = &tree->layer[k];
        while (above > 0 && tree->of_level[above] > k) {
            above--; // the highest level of this layer
        }
        for (size_t b = 0; b < layer->count; b++) {
            double of_parent = k + 1 < tree->layers ? layer->received[b] : NAN;
            bool own = isnan(of_parent) && layer->gap[b] <= tree->tolerance;
            layer->received[b] = own ? (double)above : of_parent;
            for (uint32_t c = 0; k > 0 && c < layer->child[b + 1] - layer->child[b]; c++) {
                tree->layer[k - 1].received[layer->child[b] + c] = layer->received[b];
            }
        }
    }
    for (size_t i = 0; i < tree->layer[0].count; i++) {
        level[cell_of(tree, i)] = tree->layer[0].received[i];
    }
}
