// SPDX-License-Identifier: GPL-3.0-or-later
// The operator of weighted classes and its exact solve: that of the hierarchy, where a leaf counts
// as often as its weight says, and blocks may differ in what ties their parts.
#include "hierarchy/classes.h"

#include <float.h>

lac_status lac_classes_create(size_t leaves, size_t nodes, lac_classes **out, lac_error *err)
{
    lac_classes *classes = *out = calloc(1, sizeof *classes);
    LAC_FAIL_MEMORY_IF(classes == NULL, err);
    *classes = (lac_classes){.leaves = leaves,
                             .nodes = nodes,
                             .parent = calloc(nodes, sizeof *classes->parent),
                             .weight = calloc(2 * nodes, sizeof *classes->weight)};
    const bool room = classes->parent != NULL && classes->weight != NULL;
    classes->k = room ? classes->weight + nodes : NULL;
    const lac_status status = room ? LAC_OK : lac_fail_memory(err);
    LAC_MADE(status, out, lac_classes_free);
}

void lac_classes_free(void *state)
{
    lac_classes *classes = state;
    if (classes != NULL) {
        free(classes->parent);
        free(classes->weight);
        free(classes);
    }
}

size_t lac_classes_work(const void *state) { return 4 * ((const lac_classes *)state)->nodes; }

void lac_classes_apply(const void *state, const double *x, double *y, double *work)
{
    const lac_classes *classes = state;
    const size_t nodes = classes->nodes, root = nodes - 1;
    const uint32_t *parent = classes->parent;
    double *mean = work, *force = work + nodes;
    for (size_t c = 0; c < nodes; c++) {
        mean[c] = c < classes->leaves ? x[c] : 0.0;
    }
    for (size_t c = 0; c < root; c++) { // what lies in a block has come before it
        mean[c] /= c < classes->leaves ? 1.0 : classes->weight[c];
        mean[parent[c]] += classes->weight[c] * mean[c];
    }
    mean[root] /= root < classes->leaves ? 1.0 : classes->weight[root];
    force[root] = 0.0;
    for (size_t c = root; c-- > 0;) {
        force[c] = force[parent[c]] + classes->k[parent[c]] * (mean[c] - mean[parent[c]]);
    }
    memcpy(y, force, classes->leaves * sizeof *y);
}

// As in solve.c: a block stands for its cells as one would, t its D, y its right-hand side.
bool lac_classes_solve(const void *state, double k_mean, const double *diagonal, const double *y,
                       double *x, double *work)
{
    const lac_classes *classes = state;
    const size_t nodes = classes->nodes, root = nodes - 1;
    const uint32_t *parent = classes->parent;
    double *t = work, *r = t + nodes, *g = r + nodes, *share = g + nodes;
    memset(t, 0, 4 * nodes * sizeof *t);
    memcpy(t, diagonal, classes->leaves * sizeof *t);
    memcpy(r, y, classes->leaves * sizeof *r);
    for (size_t c = 0; c < nodes; c++) {
        const size_t b = parent[c];
        t[c] /= c < classes->leaves ? 1.0 : share[c];
        r[c] /= c < classes->leaves ? 1.0 : share[c];
        g[c] = 1.0 / (t[c] + (c < root ? classes->k[b] : k_mean));
        if (!(g[c] > 0.0 && g[c] <= DBL_MAX)) {
            return false;
        }
        const double w = classes->weight[c] * g[c];
        if (c < root) {
            share[b] += w;
            t[b] += w * t[c];
            r[b] += w * r[c];
        }
    }
    // Down: the mean of a block in the place of t, what is put on each of its cells in that of r.
    t[root] = r[root] * g[root];
    r[root] = -k_mean * t[root];
    for (size_t c = root; c-- > 0;) {
        const double k = classes->k[parent[c]];
        const double offered = r[parent[c]] + k * t[parent[c]];
        const double mean = g[c] * (r[c] + offered);
        r[c] = g[c] * (t[c] * offered - k * r[c]);
        t[c] = mean;
    }
    memcpy(x, t, classes->leaves * sizeof *x);
    return true;
}
