// SPDX-License-Identifier: GPL-3.0-or-later
// Stress from slip over all levels of blocks: means on the way up, forces on the way down.
#include "base/clones.h"
#include "base/parallel_for.h"
#include "hierarchy/split.h"

// One pass over a partition.
typedef struct pass {
    const lac_partition *part;
    double k;
    const double *x, *mean_b, *force_b; // of the partition's blocks; of the next partition's
    double *out;
} pass;

// sum_B = sum of x over the children of B. Blocks have 1 to 4 children in no order a processor
// could foresee, so four are always read and those that are not children are multiplied by 0.
// The partition of the parents follows that of the children.
LAC_CLONES static void lac_apply_sum_children(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const uint32_t *child = p->part->child;
    const double *x = p->x;
    double *sum = p->out;
    size_t whole = end < p->part->whole ? end : p->part->whole;
    (void)part;
    LAC_INDEPENDENT
    for (size_t b = first; b < whole; b++) {
        const double *c = x + child[b];
        const double *is = lac_is_child[child[b + 1] - child[b]];
        sum[b] = (c[0] * is[0] + c[1] * is[1]) + (c[2] * is[2] + c[3] * is[3]);
    }
    for (size_t b = first > whole ? first : whole; b < end; b++) {
        double c[4] = {0};
        for (uint32_t i = child[b]; i < child[b + 1]; i++) {
            c[i - child[b]] = x[i];
        }
        sum[b] = (c[0] + c[1]) + (c[2] + c[3]);
    }
}

// force_c = force_B + k (mean_c - mean_B)
LAC_CLONES static void lac_apply_pass_down(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const uint32_t *parent = p->part->parent;
    const double *mean = p->x, *mean_b = p->mean_b, *force_b = p->force_b;
    double *force = p->out;
    double k = p->k;
    (void)part;
    LAC_INDEPENDENT
    for (size_t c = first; c < end; c++) {
        uint32_t b = parent[c];
        force[c] = force_b[b] + k * (mean[c] - mean_b[b]);
    }
}

LAC_CLONES static void lac_apply_take_means(void *context, size_t part, size_t first, size_t end)
{
    const pass *p = context;
    const uint32_t *begin = p->part->first;
    double *mean = p->out;
    (void)part;
    LAC_INDEPENDENT
    for (size_t b = first; b < end; b++) {
        mean[b] /= begin[b + 1] - begin[b];
    }
}

static void take_means(const lac_partition *part, double *mean)
{
    pass p = {.part = part, .out = mean};
    (void)lac_parallel_for(part->count, lac_apply_take_means, &p);
}

// The means and forces of the top over a part. @param sums  of the blocks here
static void apply_top(const lac_hierarchy *h, const double *k, const double *x, const double *sums,
                      double *work, const double *top[2])
{
    const lac_hierarchy *over = h->split->top;
    double *leaves = work + lac_hierarchy_work(h) - lac_split_work(h->split);
    const size_t n = over->cells;
    double *scratch = leaves + 3 * n + 1;
    (void)lac_split_join(h, true, &(lac_split_values){.cells = {x}, .blocks = {sums}}, leaves);
    lac_hierarchy_apply(over, k, leaves, leaves + 2 * n + 1, scratch);
    top[0] = scratch;
    top[1] = scratch + over->blocks;
}

void lac_hierarchy_apply(const lac_hierarchy *h, const double *k, const double *x, double *y,
                         double *work)
{
    const lac_partition *part = h->part;
    size_t root = h->partitions - 1;
    const double *top[2] = {NULL, NULL};
    if (h->cells == 0 && !lac_split_is_topped(h)) {
        return;
    }
    if (root == 0) {
        y[0] = 0;
        return;
    }
    // Means and forces of every partition but the cells, finest first.
    double *mean = work, *force = work + h->blocks;
    const double *below = x;
    for (size_t j = 0; j < root; j++) {
        pass p = {.part = &part[j], .x = below, .out = mean};
        (void)lac_parallel_for(part[j + 1].count, lac_apply_sum_children, &p);
        below = mean;
        mean += part[j + 1].count;
    }
    if (lac_split_is_topped(h)) {
        apply_top(h, k, x, work, work, top);
    }
    mean = work + h->blocks - part[root].count;
    force += h->blocks - part[root].count;
    take_means(&part[root], mean);
    if (part[root].count > 0) {
        *force = 0;
    }
    lac_split_patch(h, root, top, mean, force);
    for (size_t j = root - 1; j > 0; j--) {
        double *mean_b = mean, *force_b = force;
        mean -= part[j].count;
        force -= part[j].count;
        take_means(&part[j], mean);
        pass p = {&part[j], k[part[j].level], mean, mean_b, force_b, force};
        (void)lac_parallel_for(part[j].count, lac_apply_pass_down, &p);
        lac_split_patch(h, j, top, mean, force);
    }
    pass p = {&part[0], k[part[0].level], x, mean, force, y};
    (void)lac_parallel_for(part[0].count, lac_apply_pass_down, &p);
}
