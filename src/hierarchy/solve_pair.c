// SPDX-License-Identifier: GPL-3.0-or-later
// The elimination of solve.c where each cell has two unknowns: numbers become 2 x 2 blocks.
#include "hierarchy/blocks.h"

// A symmetric 2 x 2 matrix: xx, xy, yy.
typedef struct matrix {
    double xx, xy, yy;
} matrix;

// What is known of a cell or block; as it goes down m comes in the place of t.xx, t.xy and mu in
// that of y.
typedef struct block {
    matrix t, g;
    double y[2];
} block;

enum { BLOCK = sizeof(block) / sizeof(double) };

// (T + k)^-1. Scaled, as numbers up to 1e250 have no product. False where it is not positive
// definite.
static bool invert(const matrix *t, const double k[2], matrix *g)
{
    const double a = t->xx + k[0], d = t->yy + k[1];
    const double size = fmax(fabs(a), fabs(d));
    const double b = t->xy / size;
    const double det = (a / size) * (d / size) - b * b;
    *g = (matrix){d / size / det / size, -b / det / size, a / size / det / size};
    return a > 0.0 && det > 0.0 && det <= DBL_MAX && size <= DBL_MAX;
}

// T_B = W^-1 sum w T, y_B = W^-1 sum w y over the children, w = n_c g and W their sum; equations
// 5 and 6 of docs/theory/transfer.md with matrices for numbers.
static bool average(const lac_partition *fine, const block *child, uint32_t first, uint32_t end,
                    block *out)
{
    matrix sum = {0.0, 0.0, 0.0};
    double xx = 0.0, xy = 0.0, yx = 0.0, yy = 0.0, x = 0.0, y = 0.0;
    for (uint32_t c = first; c < end; c++) {
        const double n = fine->first[c + 1] - fine->first[c];
        const matrix g = child[c].g, t = child[c].t;
        sum.xx += n * g.xx;
        sum.xy += n * g.xy;
        sum.yy += n * g.yy;
        xx += n * (g.xx * t.xx + g.xy * t.xy);
        xy += n * (g.xx * t.xy + g.xy * t.yy);
        yx += n * (g.xy * t.xx + g.yy * t.xy);
        yy += n * (g.xy * t.xy + g.yy * t.yy);
        x += n * (g.xx * child[c].y[0] + g.xy * child[c].y[1]);
        y += n * (g.xy * child[c].y[0] + g.yy * child[c].y[1]);
    }
    const double none[2] = {0.0, 0.0};
    matrix w;
    const bool good = invert(&sum, none, &w);
    const double across = (w.xx * xy + w.xy * yy) + (w.xy * xx + w.yy * yx);
    out->t = (matrix){w.xx * xx + w.xy * yx, 0.5 * across, w.xy * xy + w.yy * yy};
    out->y[0] = w.xx * x + w.xy * y;
    out->y[1] = w.xy * x + w.yy * y;
    return good;
}

// One partition up. A single child is its parent: nothing ties it, and its pivot does not count.
static bool eliminate(const lac_partition *fine, const double k[2], block *child, block *parent)
{
    bool good = true;
    for (uint32_t b = 0; b < fine[1].count; b++) {
        const uint32_t first = fine->child[b], end = fine->child[b + 1];
        if (end - first == 1) {
            parent[b] = child[first];
            continue;
        }
        for (uint32_t c = first; c < end; c++) {
            good = invert(&child[c].t, k, &child[c].g) && good;
        }
        good = average(fine, child, first, end, &parent[b]) && good;
    }
    return good;
}

// m = g (y + b), mu = t g b - k g y, with b = mu + k m of the parent.
static void take_down(const double k[2], const block *parent, block *c)
{
    const double b[2] = {parent->y[0] + k[0] * parent->t.xx, parent->y[1] + k[1] * parent->t.xy};
    const matrix g = c->g, t = c->t;
    const double gb[2] = {g.xx * b[0] + g.xy * b[1], g.xy * b[0] + g.yy * b[1]};
    const double gy[2] = {g.xx * c->y[0] + g.xy * c->y[1], g.xy * c->y[0] + g.yy * c->y[1]};
    c->y[0] = t.xx * gb[0] + t.xy * gb[1] - k[0] * gy[0];
    c->y[1] = t.xy * gb[0] + t.yy * gb[1] - k[1] * gy[1];
    c->t.xx = gy[0] + gb[0];
    c->t.xy = gy[1] + gb[1];
}

static void pass_down(const lac_partition *fine, const double k[2], const block *parent,
                      block *child)
{
    for (uint32_t b = 0; b < fine[1].count; b++) {
        const uint32_t first = fine->child[b], end = fine->child[b + 1];
        if (end - first == 1) {
            child[first] = parent[b];
            continue;
        }
        for (uint32_t c = first; c < end; c++) {
            take_down(k, &parent[b], &child[c]);
        }
    }
}

size_t lac_hierarchy_pair_work(const lac_hierarchy *h) { return BLOCK * (h->cells + h->blocks); }

bool lac_hierarchy_solve_pair(const lac_hierarchy *h, const double *const k[2], double k_mean,
                              const double *const diagonal[3], double *const x[2], double *work)
{
    const lac_partition *part = h->part;
    const size_t root = h->partitions - 1;
    block *of[LAC_MAX_LEVELS + 1];
    of[0] = (block *)(void *)work;
    for (size_t i = 0; i < h->cells; i++) {
        of[0][i] =
            (block){.t = {diagonal[0][i], diagonal[1][i], diagonal[2][i]}, .y = {x[0][i], x[1][i]}};
    }
    for (size_t j = 0; j < root; j++) {
        const double ties[2] = {k[0][part[j].level], k[1][part[j].level]};
        of[j + 1] = of[j] + part[j].count;
        if (!eliminate(&part[j], ties, of[j], of[j + 1])) {
            return false;
        }
    }
    // At the root m = (T + k_mean)^-1 y, mu = -k_mean m.
    const double mean[2] = {k_mean, k_mean};
    block *top = of[root];
    if (!invert(&top->t, mean, &top->g)) {
        return false;
    }
    const double m[2] = {top->g.xx * top->y[0] + top->g.xy * top->y[1],
                         top->g.xy * top->y[0] + top->g.yy * top->y[1]};
    top->t.xx = m[0];
    top->t.xy = m[1];
    top->y[0] = -k_mean * m[0];
    top->y[1] = -k_mean * m[1];
    for (size_t j = root; j-- > 0;) {
        const double ties[2] = {k[0][part[j].level], k[1][part[j].level]};
        pass_down(&part[j], ties, of[j + 1], of[j]);
    }
    for (size_t i = 0; i < h->cells; i++) {
        x[0][i] = of[0][i].t.xx;
        x[1][i] = of[0][i].t.xy;
    }
    return true;
}
