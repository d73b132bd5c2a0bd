// SPDX-License-Identifier: GPL-3.0-or-later
// Linear equations of the hierarchy solved exactly, by elimination from the cells to the root.
#include "base/clones.h"
#include "base/parallel_for.h"
#include "hierarchy/split.h"

// The elimination of docs/theory/transfer.md, equations 5 to 8. A block stands for its cells as
// one cell would: t is its D, y its right-hand side, m its x (the mean over its cells) and mu the
// stress that the levels above put on each of its cells. So cells and blocks share the code.

static bool good(double g) { return g > 0 && g <= DBL_MAX; }

// One pass over a partition: what is known of its blocks and of the next partition's.
typedef struct pass {
    const lac_partition *part;
    double k;
    double *g, *w;
    const double *t, *y, *b;
    double *t_b, *y_b; // or m and mu of the partition's own
    double *out;
    uint32_t bad[LAC_PARTS];
} pass;

// g_c = 1/(t_c + k), w_c = n_c g_c where blocks have several cells; counts the g that are not
// finite and positive.
LAC_CLONES static void lac_solve_invert_pivots(void *context, size_t part, size_t first, size_t end)
{
    pass *p = context;
    const double *t = p->t;
    double *g = p->g;
    double k = p->k;
    uint32_t bad = 0;
    LAC_INDEPENDENT
    for (size_t c = first; c < end; c++) {
        g[c] = 1 / (t[c] + k);
        bad += good(g[c]) ? 0 : 1;
    }
    p->bad[part] = bad;
    const uint32_t *begin = p->part->first;
    double *w = p->w;
    if (w == g) {
        return;
    }
    LAC_INDEPENDENT
    for (size_t c = first; c < end; c++) {
        w[c] = (begin[c + 1] - begin[c]) * g[c];
    }
}

// t_B = sum w_c t_c / sum w_c, y_B = sum w_c y_c / sum w_c over the children of B.
// Four are always read, as in apply.c. The partition of the parents follows that of the children.
LAC_CLONES static void lac_solve_average(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const uint32_t *child = p->part->child;
    const double *w = p->w, *t = p->t, *y = p->y;
    double *t_b = p->t_b, *y_b = p->y_b;
    size_t whole = end < p->part->whole ? end : p->part->whole;
    (void)part;
    LAC_INDEPENDENT
    for (size_t b = first; b < whole; b++) {
        size_t c = child[b];
        const double *is = lac_is_child[child[b + 1] - child[b]];
        double w0 = w[c] * is[0], w1 = w[c + 1] * is[1];
        double w2 = w[c + 2] * is[2], w3 = w[c + 3] * is[3];
        double share = 1 / ((w0 + w1) + (w2 + w3));
        t_b[b] = ((w0 * t[c] + w1 * t[c + 1]) + (w2 * t[c + 2] + w3 * t[c + 3])) * share;
        y_b[b] = ((w0 * y[c] + w1 * y[c + 1]) + (w2 * y[c + 2] + w3 * y[c + 3])) * share;
    }
    for (size_t b = first > whole ? first : whole; b < end; b++) { // three at most: the same sums
        double sum = 0, sum_t = 0, sum_y = 0;
        for (uint32_t c = child[b]; c < child[b + 1]; c++) {
            sum += w[c];
            sum_t += w[c] * t[c];
            sum_y += w[c] * y[c];
        }
        bool last = p->part[1].first[b] >= p->part->last;
        t_b[b] = last ? sum_t / sum : sum_t * (1 / sum);
        y_b[b] = last ? sum_y / sum : sum_y * (1 / sum);
    }
}

// A single child is its parent: nothing ties it, so its pivot does not count.
// Returns how many of the bad pivots were such.
static uint32_t adopt_singles(const lac_partition *fine, const double *t, const double *y,
                              double *g, double *t_b, double *y_b)
{
    uint32_t pardoned = 0;
    for (uint32_t i = 0; i < fine->singles; i++) {
        uint32_t b = fine->single[i], c = fine->child[b];
        pardoned += !good(g[c]);
        g[c] = 0;
        t_b[b] = t[c];
        y_b[b] = y[c];
    }
    return pardoned;
}

// b_B = mu_B + k m_B: all that the children of B need to know.
LAC_CLONES static void lac_solve_offer(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const double *m = p->t, *mu = p->y;
    double *b = p->out;
    double k = p->k;
    (void)part;
    LAC_INDEPENDENT
    for (size_t c = first; c < end; c++) {
        b[c] = mu[c] + k * m[c];
    }
}

// m_c = g_c (y_c + b_B), mu_c = g_c (t_c b_B - k y_c). m replaces t and mu replaces y.
LAC_CLONES static void lac_solve_pass_down(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const uint32_t *parent = p->part->parent;
    const double *g = p->g, *b = p->b;
    double *t = p->t_b, *y = p->y_b;
    double k = p->k;
    (void)part;
    LAC_INDEPENDENT
    for (size_t c = first; c < end; c++) {
        double from_above = b[parent[c]];
        double m = g[c] * (y[c] + from_above);
        y[c] = g[c] * (t[c] * from_above - k * y[c]);
        t[c] = m;
    }
}

// The same for the cells: x_i = g_i (y_i + b_B).
LAC_CLONES static void lac_solve_finish(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const uint32_t *parent = p->part->parent;
    const double *g = p->g, *b = p->b, *y = p->y;
    double *x = p->out;
    (void)part;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        x[i] = g[i] * (y[i] + b[parent[i]]);
    }
}

// A single child has its parent's.
static void copy_to_singles(const lac_partition *part, const double *parents, double *x)
{
    for (uint32_t i = 0; i < part->singles; i++) {
        uint32_t parent = part->single[i];
        x[part->child[parent]] = parents[parent];
    }
}

// One partition up: from (t, y) to (t_b, y_b). False where a pivot is not finite and positive.
static bool eliminate(const lac_partition *fine, double k, const double *t, const double *y,
                      double *g, double *w, double *t_b, double *y_b)
{
    pass p = {.part = fine, .k = k, .g = g, .w = w, .t = t, .y = y, .t_b = t_b, .y_b = y_b};
    size_t parts = lac_parallel_for(fine->count, lac_solve_invert_pivots, &p);
    uint32_t bad = 0;
    for (size_t i = 0; i < parts; i++) {
        bad += p.bad[i];
    }
    (void)lac_parallel_for(fine[1].count, lac_solve_average, &p);
    return bad == adopt_singles(fine, t, y, g, t_b, y_b);
}

// b of the blocks of a partition, over which k ties their children
static void offer(const lac_partition *part, double k, const double *m, const double *mu, double *b)
{
    pass p = {.part = part, .k = k, .t = m, .y = mu, .out = b};
    (void)lac_parallel_for(part->count, lac_solve_offer, &p);
}

size_t lac_hierarchy_work(const lac_hierarchy *h)
{
    return h->cells + h->room + 3 * h->blocks + (h->split != NULL ? lac_split_work(h->split) : 0);
}

// The parts of the work: of the cells; the weights of one partition; t (then m), y (then mu) and g
// of the blocks of every partition but the cells, finest first.
typedef struct places {
    double *g_cell, *w, *t, *r, *g;
} places;

static places places_in(const lac_hierarchy *h, double *work)
{
    double *w = work + h->cells, *t = w + h->room;
    return (places){work, w, t, t + h->blocks, t + 2 * h->blocks};
}

// From the cells to the root, whose t and r `at` comes to. False where a pivot is not finite and
// positive; a part goes on all the same, as the others do.
static bool climb(const lac_hierarchy *h, const double *k, const double *diagonal, const double *y,
                  places *at)
{
    const lac_partition *part = h->part;
    const size_t root = h->partitions - 1;
    bool good = eliminate(&part[0], k[part[0].level], diagonal, y, at->g_cell,
                          h->heaped ? at->w : at->g_cell, at->t, at->r);
    for (size_t j = 1; j < root && (good || lac_split_is_topped(h)); j++) {
        const uint32_t count = part[j].count;
        lac_split_calm(h, j, at->t, at->r);
        good = eliminate(&part[j], k[part[j].level], at->t, at->r, at->g, at->w, at->t + count,
                         at->r + count) &&
               good;
        at->t += count, at->r += count, at->g += count;
    }
    return good;
}

// From the root, whose m and mu are known, to the blocks over the cells.
static void descend(const lac_hierarchy *h, const double *k, const double *const top[2], places *at)
{
    const lac_partition *part = h->part;
    const size_t root = h->partitions - 1;
    lac_split_patch(h, root, top, at->t, at->r);
    for (size_t j = root - 1; j > 0; j--) {
        const uint32_t count = part[j].count;
        at->g -= count;
        offer(&part[j + 1], k[part[j].level], at->t, at->r, at->w);
        pass p = {.part = &part[j],
                  .k = k[part[j].level],
                  .g = at->g,
                  .b = at->w,
                  .t_b = at->t - count,
                  .y_b = at->r - count};
        (void)lac_parallel_for(count, lac_solve_pass_down, &p);
        copy_to_singles(&part[j], at->t, p.t_b);
        copy_to_singles(&part[j], at->r, p.y_b);
        lac_split_patch(h, j, top, p.t_b, p.y_b);
        at->t -= count, at->r -= count;
    }
}

// What the top over a part comes to: m and mu of its blocks.
static bool solve_top(const lac_hierarchy *h, const double *k, double k_mean, bool good,
                      const lac_split_values *from, double *leaves, const double *top[2])
{
    const lac_hierarchy *over = h->split->top;
    const size_t n = over->cells;
    double *x = leaves + 2 * n + 1, *work = x + n;
    good = lac_split_join(h, good, from, leaves);
    const places at = places_in(over, work);
    top[0] = at.t;
    top[1] = at.r;
    return good && lac_hierarchy_solve(over, k, k_mean, leaves, leaves + n, x, work);
}

// At the root m = y/(t + k_mean), mu = -k_mean m.
static bool solve_root(double k_mean, double *t, double *r)
{
    double g_root = 1 / (*t + k_mean);
    if (!good(g_root)) {
        return false;
    }
    *t = *r * g_root;
    *r = -k_mean * *t;
    return true;
}

static bool solve(const lac_hierarchy *h, const double *k, double k_mean, const double *diagonal,
                  const double *y, double *x, double *work)
{
    const lac_partition *part = h->part;
    const double *top[2] = {NULL, NULL};
    if (h->partitions == 1) {
        double g = 1 / (diagonal[0] + k_mean);
        x[0] = y[0] * g;
        return good(g);
    }
    const places begin = places_in(h, work);
    places at = begin;
    const bool climbed = climb(h, k, diagonal, y, &at);
    if (lac_split_is_topped(h)) {
        double *leaves = work + lac_hierarchy_work(h) - lac_split_work(h->split);
        const lac_split_values from = {{diagonal, y}, {begin.t, begin.r}};
        if (!solve_top(h, k, k_mean, climbed, &from, leaves, top)) {
            return false;
        }
    } else if (!climbed || !solve_root(k_mean, at.t, at.r)) {
        return false;
    }
    descend(h, k, top, &at);
    offer(&part[1], k[part[0].level], at.t, at.r, at.w);
    pass p = {.part = &part[0], .g = at.g_cell, .b = at.w, .y = y, .out = x};
    (void)lac_parallel_for(part[0].count, lac_solve_finish, &p);
    copy_to_singles(&part[0], at.t, x);
    return true;
}

bool lac_hierarchy_solve(const lac_hierarchy *h, const double *k, double k_mean,
                         const double *diagonal, const double *y, double *x, double *work)
{
    if (h->split == NULL || lac_split_is_topped(h)) {
        return solve(h, k, k_mean, diagonal, y, x, work);
    }
    const bool good = h->cells == 0 || solve(h, k, k_mean, diagonal, y, x, work);
    return lac_team_all(h->split->team, good); // one of them has all
}
