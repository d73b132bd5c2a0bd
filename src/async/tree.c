// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks that keep a change of stress to themselves until a cell in them has to hear of it.
#include "async/tree.h"

// Each block keeps half of what the one below it has left.
#define KEEPS 0.5

// The builder's state: items that are not yet children, and the first cell of each.
typedef struct forest {
    uint32_t *item, *first;
    uint32_t count, children;
} forest;

static lac_async_node *node_of(const lac_async_tree *tree, uint32_t item)
{
    return &tree->node[item - tree->n];
}

// Ties an item to its parent by k.
static void tie(lac_async_tree *tree, uint32_t item, uint32_t parent, double k)
{
    if (item < tree->n) {
        tree->cell[item].parent = parent;
        tree->cell[item].stiffness = k;
    } else {
        node_of(tree, item)->parent = parent;
        node_of(tree, item)->weight = node_of(tree, item)->below - k;
    }
}

// A new block over the items from..to.
static uint32_t join(lac_async_tree *tree, forest *f, uint32_t from, uint32_t to, double k)
{
    uint32_t made = tree->n + tree->nodes;
    lac_async_node *node = &tree->node[tree->nodes++];
    double cells = 0.0;
    *node = (lac_async_node){
        .below = k, .parent = LAC_ASYNC_NONE, .first = f->children, .children = to - from};
    for (uint32_t i = from; i < to; i++) {
        uint32_t item = f->item[i];
        tie(tree, item, made - tree->n, k);
        tree->child[f->children++] = item;
        cells += item < tree->n ? 1.0 : 1.0 / node_of(tree, item)->share;
    }
    node->share = 1.0 / cells;
    return made;
}

// Joins the items of each block of a level.
static void climb(lac_async_tree *tree, forest *f, const uint32_t *offset, size_t blocks, double k)
{
    uint32_t kept = 0, next = 0;
    for (size_t b = 0; b < blocks; b++) {
        uint32_t from = next;
        while (next < f->count && f->first[next] < offset[b + 1]) {
            next++;
        }
        f->item[kept] = next - from == 1 ? f->item[from] : join(tree, f, from, next, k);
        f->first[kept++] = offset[b];
    }
    f->count = kept;
}

lac_status lac_async_tree_create(const lac_hierarchy *h, const double *k, lac_async_tree *out,
                                 lac_error *err)
{
    size_t n = lac_hierarchy_cells(h);
    *out = (lac_async_tree){.n = (uint32_t)n};
    out->cell = calloc(n, sizeof *out->cell);
    out->node = calloc(n, sizeof *out->node); // n - 1 at most, but for a single cell
    out->child = calloc(2 * n, sizeof *out->child);
    forest f = {.item = calloc(n, sizeof *f.item),
                .first = calloc(n, sizeof *f.first),
                .count = (uint32_t)n};
    bool made = out->cell != NULL && out->node != NULL && out->child != NULL && f.item != NULL &&
                f.first != NULL;
    if (made) {
        for (uint32_t i = 0; i < n; i++) {
            f.item[i] = f.first[i] = i;
        }
        for (size_t l = 1; l <= lac_hierarchy_levels(h); l++) {
            climb(out, &f, lac_hierarchy_offsets(h, l), lac_hierarchy_blocks(h, l), k[l - 1]);
        }
        if (out->nodes == 0) {
            (void)join(out, &f, 0, f.count, 0.0);
        }
        lac_async_node *fitted = realloc(out->node, out->nodes * sizeof *fitted);
        out->node = fitted != NULL ? fitted : out->node;
    }
    free(f.item);
    free(f.first);
    if (!made) {
        lac_async_tree_clear(out);
        return lac_fail_memory(err);
    }
    return LAC_OK;
}

void lac_async_tree_clear(lac_async_tree *tree)
{
    free(tree->cell);
    free(tree->node);
    free(tree->child);
    *tree = (lac_async_tree){0};
}

void lac_async_tree_anchor(lac_async_tree *tree, double k_mean, double damping)
{
    lac_async_node *root = &tree->node[tree->nodes - 1];
    root->weight = root->below - k_mean;
    root->damping = damping;
    for (uint32_t j = tree->nodes; j-- > 0;) {
        lac_async_node *node = &tree->node[j];
        double above = node->parent == LAC_ASYNC_NONE ? 0.0 : tree->node[node->parent].self;
        node->self = above + node->weight * node->share;
    }
}

static double mean_at(const lac_async_node *node, double t)
{
    return (node->sum + node->rate * (t - node->t)) * node->share;
}

static double area_at(const lac_async_node *node, double t)
{
    double h = t - node->t;
    return node->area + (node->sum + 0.5 * node->rate * h) * h * node->share;
}

// Mean rate, as told.
static double rate_of(const lac_async_node *node) { return node->rate * node->share; }

// Change of a block's part of E, and of what was handed down to it, since it was last opened.
static double pending_at(const lac_async_node *node, double t)
{
    double damped = node->damping * (rate_of(node) - node->heard);
    return node->received + node->weight * (mean_at(node, t) - node->opened) - damped;
}

lac_async_view lac_async_tree_view(const lac_async_tree *tree, uint32_t parent, double t)
{
    lac_async_view view = {0};
    for (uint32_t j = parent; j != LAC_ASYNC_NONE; j = tree->node[j].parent) {
        const lac_async_node *node = &tree->node[j];
        view.outer += node->weight * mean_at(node, t);
        view.area += node->weight * area_at(node, t);
        view.rate += node->weight * node->rate * node->share;
        view.mean = rate_of(node); // the root comes last
        view.gone = node->gone + view.mean * (t - node->t);
    }
    return view;
}

// Renews a block's bounds from its children. The block keeps half of the change of E that the
// neediest child can do with; the other half is left to the blocks above.
static void renew(lac_async_tree *tree, lac_async_node *node)
{
    double low = -INFINITY, high = INFINITY;
    node->next = INFINITY;
    node->next_who = LAC_ASYNC_NONE;
    for (uint32_t k = node->first; k < node->first + node->children; k++) {
        uint32_t item = tree->child[k];
        uint32_t who = item;
        double due;
        if (item < tree->n) {
            const lac_async_cell *cell = &tree->cell[item];
            low = fmax(low, cell->low - cell->pending);
            high = fmin(high, cell->high - cell->pending);
            due = cell->due;
        } else {
            const lac_async_node *child = node_of(tree, item);
            low = fmax(low, child->cap_low);
            high = fmin(high, child->cap_high);
            due = child->due;
            who = child->who;
        }
        if (due < node->next) {
            node->next = due;
            node->next_who = who;
        }
    }
    node->low = KEEPS * low;
    node->high = KEEPS * high;
    node->cap_low = (1.0 - KEEPS) * low;
    node->cap_high = (1.0 - KEEPS) * high;
}

// When a block opens as things move now.
static void foresee(const lac_async_tree *tree, lac_async_node *node, double t)
{
    double pending = pending_at(node, t);
    double rate = node->weight * node->share * node->rate;
    double exit = INFINITY;
    if (pending > node->high || pending < node->low) {
        exit = t;
    } else if (rate != 0.0) {
        exit = t + ((rate > 0.0 ? node->high : node->low) - pending) / rate;
    }
    bool opens = exit < node->next;
    node->due = opens ? exit : node->next;
    node->who = opens ? tree->n + (uint32_t)(node - tree->node) : node->next_who;
}

// Hands down what a block has pending to its children; cells that this wakes are due at t.
static void hand_down(lac_async_tree *tree, lac_async_node *node, double t)
{
    double pending = pending_at(node, t);
    node->opened = mean_at(node, t);
    node->heard = rate_of(node);
    node->received = 0.0;
    for (uint32_t k = node->first; k < node->first + node->children; k++) {
        uint32_t item = tree->child[k];
        if (item >= tree->n) {
            lac_async_node *child = node_of(tree, item);
            child->received += pending;
            foresee(tree, child, t);
            continue;
        }
        lac_async_cell *cell = &tree->cell[item];
        cell->pending += pending;
        if (cell->pending > LAC_ASYNC_WAKES * cell->high ||
            cell->pending < LAC_ASYNC_WAKES * cell->low) {
            cell->due = fmin(cell->due, t);
        }
    }
}

static void renew_up(lac_async_tree *tree, uint32_t from, double t)
{
    for (uint32_t j = from; j != LAC_ASYNC_NONE; j = tree->node[j].parent) {
        renew(tree, &tree->node[j]);
        foresee(tree, &tree->node[j], t);
    }
}

void lac_async_tree_add(lac_async_tree *tree, uint32_t cell, double t, double slip, double rate)
{
    lac_async_node *path[LAC_ASYNC_LEVELS];
    int depth = 0;
    for (uint32_t j = tree->cell[cell].parent; j != LAC_ASYNC_NONE; j = tree->node[j].parent) {
        lac_async_node *node = &tree->node[j];
        node->area = area_at(node, t);
        node->gone += rate_of(node) * (t - node->t);
        node->sum += node->rate * (t - node->t) + slip;
        node->t = t;
        path[depth++] = node;
    }
    double due = tree->cell[cell].due;
    for (int l = depth; l-- > 0;) {
        hand_down(tree, path[l], t);
    }
    tree->cell[cell].pending = 0.0;
    tree->cell[cell].due = due;
    for (int l = 0; l < depth; l++) {
        path[l]->rate += rate;
        renew(tree, path[l]);
        foresee(tree, path[l], t);
    }
}

void lac_async_tree_open(lac_async_tree *tree, uint32_t j, double t)
{
    tree->openings++;
    hand_down(tree, &tree->node[j], t);
    renew_up(tree, j, t);
}

void lac_async_tree_fill(lac_async_tree *tree)
{
    for (uint32_t j = 0; j < tree->nodes; j++) {
        lac_async_node *node = &tree->node[j];
        node->sum = node->rate = node->t = node->area = node->received = node->gone = 0.0;
        for (uint32_t k = node->first; k < node->first + node->children; k++) {
            uint32_t item = tree->child[k];
            bool leaf = item < tree->n;
            node->sum +=
                leaf ? tree->cell[item].slip + tree->cell[item].ahead : node_of(tree, item)->sum;
            node->rate += leaf ? tree->cell[item].told : node_of(tree, item)->rate;
        }
        node->opened = mean_at(node, 0.0);
        node->heard = rate_of(node);
    }
}

void lac_async_tree_propagate(lac_async_tree *tree, double t)
{
    for (uint32_t j = 0; j < tree->nodes; j++) {
        renew(tree, &tree->node[j]);
        foresee(tree, &tree->node[j], t);
    }
}

void lac_async_tree_shift(lac_async_tree *tree, double by)
{
    for (uint32_t i = 0; i < tree->n; i++) {
        tree->cell[i].t -= by;
        tree->cell[i].due -= by;
    }
    for (uint32_t j = 0; j < tree->nodes; j++) {
        tree->node[j].t -= by;
        tree->node[j].next -= by;
        tree->node[j].due -= by;
    }
}
