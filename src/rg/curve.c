// SPDX-License-Identifier: GPL-3.0-or-later
// The slipped fraction of every level at many loads, from one pass over the tree where that can be.
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_sort.h>

#include "rg/path.h"

// How many of the ascending values count as reached at stress tau.
static size_t reached(const lac_rg_tree *tree, size_t n, const double *sorted, double tau)
{
    size_t low = 0;
    size_t high = n;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (lac_rg_slips(tree, sorted[middle] - tau)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

// Under the same stress everywhere FIX lowers every threshold by that stress: one pass tells all.
static lac_status by_thresholds(lac_rg_tree *tree, const lac_rg_path *path, size_t n,
                                const double *load, double *fraction, double *work, lac_error *err)
{
    const size_t levels = lac_rg_levels(tree);
    double *sorted = malloc(lac_rg_blocks_at(tree, 0) * sizeof *sorted);
    if (sorted == NULL) {
        return lac_fail_memory(err);
    }
    lac_rg_path_at(path, 0.0, work, work + lac_rg_blocks_at(tree, 0));
    (void)lac_rg_pass(tree, LAC_RG_FIX, work, work + lac_rg_blocks_at(tree, 0));
    for (size_t level = 0; level <= levels; level++) {
        size_t blocks = lac_rg_blocks_at(tree, level);
        memcpy(sorted, lac_rg_thresholds(tree, level), blocks * sizeof *sorted);
        gsl_sort(sorted, 1, blocks);
        for (size_t i = 0; i < n; i++) {
            size_t slips = reached(tree, blocks, sorted, lac_rg_path_stress(path, load[i]));
            fraction[i * (levels + 1) + level] = (double)slips / (double)blocks;
        }
    }
    free(sorted);
    return LAC_OK;
}

lac_status lac_rg_curve(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, size_t n,
                        const double *load, double *fraction, double *work, lac_error *err)
{
    const size_t levels = lac_rg_levels(tree);
    if (rule == LAC_RG_FIX && lac_rg_path_is_equal(path)) {
        return by_thresholds(tree, path, n, load, fraction, work, err);
    }
    double *shear = work;
    double *gap = work + lac_rg_blocks_at(tree, 0);
    for (size_t i = 0; i < n; i++) {
        lac_rg_path_at(path, load[i], shear, gap);
        (void)lac_rg_pass(tree, rule, shear, gap);
        for (size_t level = 0; level <= levels; level++) {
            fraction[i * (levels + 1) + level] =
                (double)lac_rg_slipping(tree, level) / (double)lac_rg_blocks_at(tree, level);
        }
    }
    return LAC_OK;
}
