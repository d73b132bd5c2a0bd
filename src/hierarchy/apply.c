// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/clones.h"
#include "hierarchy/blocks.h"

// sum_B = sum of x over the children of B. Blocks have 1 to 4 children in no order a processor
// could foresee, so four are always read and those that are not children are multiplied by 0.
// The partition of the parents follows that of the children.
LAC_CLONES static void lac_apply_sum_children(const lac_partition *fine, const double *x,
                                              double *sum)
{
    const uint32_t *child = fine->child;
    LAC_INDEPENDENT
    for (uint32_t b = 0; b < fine->whole; b++) {
        const double *c = x + child[b];
        const double *is = lac_is_child[child[b + 1] - child[b]];
        sum[b] = (c[0] * is[0] + c[1] * is[1]) + (c[2] * is[2] + c[3] * is[3]);
    }
    for (uint32_t b = fine->whole; b < fine[1].count; b++) {
        double c[4] = {0};
        for (uint32_t i = child[b]; i < child[b + 1]; i++) {
            c[i - child[b]] = x[i];
        }
        sum[b] = (c[0] + c[1]) + (c[2] + c[3]);
    }
}

// force_c = force_B + k (mean_c - mean_B)
LAC_CLONES static void lac_apply_pass_down(const lac_partition *fine, double k, const double *mean,
                                           const double *mean_b, const double *force_b,
                                           double *force)
{
    LAC_INDEPENDENT
    for (uint32_t c = 0; c < fine->count; c++) {
        uint32_t b = fine->parent[c];
        force[c] = force_b[b] + k * (mean[c] - mean_b[b]);
    }
}

LAC_CLONES static void lac_apply_take_means(const lac_partition *part, double *mean)
{
    LAC_INDEPENDENT
    for (uint32_t b = 0; b < part->count; b++) {
        mean[b] /= part->first[b + 1] - part->first[b];
    }
}

void lac_hierarchy_apply(const lac_hierarchy *h, const double *k, const double *x, double *y,
                         double *work)
{
    const lac_partition *part = h->part;
    size_t root = h->partitions - 1;
    if (root == 0) {
        y[0] = 0;
        return;
    }
    // Means and forces of every partition but the cells, finest first.
    double *mean = work, *force = work + h->blocks;
    const double *below = x;
    for (size_t j = 0; j < root; j++) {
        lac_apply_sum_children(&part[j], below, mean);
        below = mean;
        mean += part[j + 1].count;
    }
    mean = work + h->blocks - 1;
    force += h->blocks - 1;
    lac_apply_take_means(&part[root], mean);
    *force = 0;
    for (size_t j = root - 1; j > 0; j--) {
        double *mean_b = mean, *force_b = force;
        mean -= part[j].count;
        force -= part[j].count;
        lac_apply_take_means(&part[j], mean);
        lac_apply_pass_down(&part[j], k[part[j].level], mean, mean_b, force_b, force);
    }
    lac_apply_pass_down(&part[0], k[part[0].level], x, mean, force, y);
}
