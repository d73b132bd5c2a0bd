// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/rg.h"

static bool slides(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double load,
                   double *work)
{
    double *shear = work;
    double *gap = work + lac_rg_blocks_at(tree, 0);
    lac_rg_path_at(path, load, shear, gap);
    return lac_rg_slips(tree, lac_rg_pass(tree, rule, shear, gap));
}

double lac_rg_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double *work)
{
    const int scan = 60; // a joint may slide, stick and slide again as its tractions rearrange
    double high = 1.0;
    double low = 0.0;
    for (int i = 1; i <= scan; i++) {
        high = (double)i / scan;
        if (slides(tree, rule, path, high, work)) {
            break;
        }
        low = high;
    }
    while (high - low > 1e-9) {
        double middle = 0.5 * (low + high);
        if (slides(tree, rule, path, middle, work)) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
