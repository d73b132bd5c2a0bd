// SPDX-License-Identifier: GPL-3.0-or-later
#include <float.h>

#include "base/clones.h"
#include "hierarchy/blocks.h"

// The elimination of docs/theory/transfer.md, equations 5 to 8. A block stands for its cells as
// one cell would: t is its D, y its right-hand side, m its x (the mean over its cells) and mu the
// stress that the levels above put on each of its cells. So cells and blocks share the code.

static bool good(double g) { return g > 0 && g <= DBL_MAX; }

// g_c = 1/(t_c + k); returns how many are not finite and positive.
LAC_CLONES static uint32_t lac_solve_invert_pivots(uint32_t count, double k, const double *t,
                                                   double *g)
{
    uint32_t bad = 0;
    LAC_INDEPENDENT
    for (uint32_t c = 0; c < count; c++) {
        g[c] = 1 / (t[c] + k);
        bad += !good(g[c]);
    }
    return bad;
}

// t_B = sum w_c t_c / sum w_c, y_B = sum w_c y_c / sum w_c over the children of B.
// Four are always read, as in apply.c. The partition of the parents follows that of the children.
LAC_CLONES static void lac_solve_average_children(const lac_partition *fine, const double *w,
                                                  const double *t, const double *y, double *t_b,
                                                  double *y_b)
{
    const uint32_t *child = fine->child;
    LAC_INDEPENDENT
    for (uint32_t b = 0; b < fine->whole; b++) {
        size_t c = child[b];
        const double *is = lac_is_child[child[b + 1] - child[b]];
        double w0 = w[c] * is[0], w1 = w[c + 1] * is[1];
        double w2 = w[c + 2] * is[2], w3 = w[c + 3] * is[3];
        double share = 1 / ((w0 + w1) + (w2 + w3));
        t_b[b] = ((w0 * t[c] + w1 * t[c + 1]) + (w2 * t[c + 2] + w3 * t[c + 3])) * share;
        y_b[b] = ((w0 * y[c] + w1 * y[c + 1]) + (w2 * y[c + 2] + w3 * y[c + 3])) * share;
    }
    for (uint32_t b = fine->whole; b < fine[1].count; b++) {
        double sum = 0, sum_t = 0, sum_y = 0;
        for (uint32_t c = child[b]; c < child[b + 1]; c++) {
            sum += w[c];
            sum_t += w[c] * t[c];
            sum_y += w[c] * y[c];
        }
        t_b[b] = sum_t / sum;
        y_b[b] = sum_y / sum;
    }
}

// A single child is its parent: nothing ties it, so its pivot does not count.
// Returns how many of the bad pivots were such.
static uint32_t adopt_singles(const lac_partition *fine, const double *t, const double *y,
                              double *g, double *t_b, double *y_b)
{
    uint32_t pardoned = 0;
    for (uint32_t i = 0; i < fine->singles; i++) {
        uint32_t b = fine->single[i];
        uint32_t c = fine->child[b];
        pardoned += !good(g[c]);
        g[c] = 0;
        t_b[b] = t[c];
        y_b[b] = y[c];
    }
    return pardoned;
}

// w_c = n_c g_c
LAC_CLONES static void lac_solve_weigh(const lac_partition *part, const double *g, double *w)
{
    LAC_INDEPENDENT
    for (uint32_t c = 0; c < part->count; c++) {
        w[c] = (part->first[c + 1] - part->first[c]) * g[c];
    }
}

// b_B = mu_B + k m_B: all that the children of B need to know.
LAC_CLONES static void lac_solve_offer(const lac_partition *part, double k, const double *m,
                                       const double *mu, double *b)
{
    LAC_INDEPENDENT
    for (uint32_t c = 0; c < part->count; c++) {
        b[c] = mu[c] + k * m[c];
    }
}

// m_c = g_c (y_c + b_B), mu_c = g_c (t_c b_B - k y_c); a single child has its parent's.
// m replaces t and mu replaces y.
LAC_CLONES static void lac_solve_pass_down(const lac_partition *part, double k, const double *g,
                                           const double *b, const double *m_b, const double *mu_b,
                                           double *t, double *y)
{
    LAC_INDEPENDENT
    for (uint32_t c = 0; c < part->count; c++) {
        double from_above = b[part->parent[c]];
        double m = g[c] * (y[c] + from_above);
        y[c] = g[c] * (t[c] * from_above - k * y[c]);
        t[c] = m;
    }
    for (uint32_t i = 0; i < part->singles; i++) {
        uint32_t parent = part->single[i];
        t[part->child[parent]] = m_b[parent];
        y[part->child[parent]] = mu_b[parent];
    }
}

// The same for the cells: x_i = g_i (y_i + b_B).
LAC_CLONES static void lac_solve_finish(const lac_partition *cells, const double *g,
                                        const double *b, const double *m_b, const double *y,
                                        double *x)
{
    LAC_INDEPENDENT
    for (uint32_t i = 0; i < cells->count; i++) {
        x[i] = g[i] * (y[i] + b[cells->parent[i]]);
    }
    for (uint32_t i = 0; i < cells->singles; i++) {
        uint32_t parent = cells->single[i];
        x[cells->child[parent]] = m_b[parent];
    }
}

// One partition up: from (t, y) to (t_b, y_b). False where a pivot is not finite and positive.
static bool eliminate(const lac_partition *fine, double k, const double *t, const double *y,
                      double *g, double *w, double *t_b, double *y_b)
{
    uint32_t bad = lac_solve_invert_pivots(fine->count, k, t, g);
    if (w != NULL) {
        lac_solve_weigh(fine, g, w);
    }
    lac_solve_average_children(fine, w != NULL ? w : g, t, y, t_b, y_b);
    return bad == adopt_singles(fine, t, y, g, t_b, y_b);
}

size_t lac_hierarchy_work(const lac_hierarchy *h) { return h->cells + 4 * h->blocks; }

bool lac_hierarchy_solve(const lac_hierarchy *h, const double *k, double k_mean,
                         const double *diagonal, const double *y, double *x, double *work)
{
    const lac_partition *part = h->part;
    size_t root = h->partitions - 1;
    if (root == 0) {
        double g = 1 / (diagonal[0] + k_mean);
        x[0] = y[0] * g;
        return good(g);
    }
    // Of the blocks of every partition but the cells, finest first: t (then m), y (then mu), g.
    double *g_cell = work, *w = work + h->cells;
    double *t = w + h->blocks, *r = t + h->blocks, *g = r + h->blocks;
    if (!eliminate(&part[0], k[part[0].level], diagonal, y, g_cell, NULL, t, r)) {
        return false;
    }
    for (size_t j = 1; j < root; j++) {
        uint32_t count = part[j].count;
        if (!eliminate(&part[j], k[part[j].level], t, r, g, w, t + count, r + count)) {
            return false;
        }
        t += count, r += count, g += count;
    }
    // At the root m = y/(t + k_mean), mu = -k_mean m.
    double g_root = 1 / (*t + k_mean);
    if (!good(g_root)) {
        return false;
    }
    *t = *r * g_root;
    *r = -k_mean * *t;
    for (size_t j = root - 1; j > 0; j--) {
        uint32_t count = part[j].count;
        g -= count;
        lac_solve_offer(&part[j + 1], k[part[j].level], t, r, w);
        lac_solve_pass_down(&part[j], k[part[j].level], g, w, t, r, t - count, r - count);
        t -= count, r -= count;
    }
    lac_solve_offer(&part[1], k[part[0].level], t, r, w);
    lac_solve_finish(&part[0], g_cell, w, t, y, x);
    return true;
}
