// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest load at which the whole joint slides: a scan of the path, then a closing bracket.
#include "rg/path.h"

#include <float.h>
#include <math.h>

double lac_rg_root(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double load,
                   double *work)
{
    double *shear = work;
    double *gap = work + lac_rg_blocks_at(tree, 0);
    lac_rg_path_at(path, load, shear, gap);
    return lac_rg_pass(tree, rule, shear, gap);
}

// Twice a little beyond the chord through the thresholds, on the side that was not seen last, then
// in the middle. LUMP has no thresholds to draw a chord through.
double lac_rg_next_load(const lac_rg_bracket *b, int step, bool stuck, double within)
{
    const double width = b->high - b->low;
    double x = b->low + width * b->at_low / (b->at_low - b->at_high);
    if (step > 0) {
        double beyond = fmax(0.4 * within, 0.02 * width);
        x += stuck ? beyond : -beyond;
    }
    return step % 3 < 2 && x > b->low && x < b->high ? x : 0.5 * (b->low + b->high);
}

double lac_rg_close(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, lac_rg_bracket b,
                    double *work)
{
    // a joint far from 0, by tractions beside small strengths, has no loads so close together
    const double within = fmax(1e-9, 4 * DBL_EPSILON * fmax(fabs(b.low), fabs(b.high)));
    bool stuck = false;
    for (int step = 0; b.high - b.low > within; step++) {
        double load = lac_rg_next_load(&b, step, stuck, within);
        double at = lac_rg_root(tree, rule, path, load, work);
        stuck = !lac_rg_slips(tree, at);
        if (stuck) {
            b.low = load;
            b.at_low = at;
        } else {
            b.high = load;
            b.at_high = at;
        }
    }
    return b.high;
}

double lac_rg_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double *work)
{
    // a joint may slide, stick and slide again as its tractions rearrange
    lac_rg_bracket b = {.low = lac_rg_path_load(path, 0.0), .at_low = INFINITY};
    if (lac_rg_path_is_laden(path)) {
        b.at_low = lac_rg_root(tree, rule, path, b.low, work);
        if (lac_rg_slips(tree, b.at_low)) {
            return b.low;
        }
    }
    for (int i = 1; i <= LAC_RG_SCAN; i++) {
        b.high = lac_rg_path_load(path, (double)i / LAC_RG_SCAN);
        b.at_high = lac_rg_root(tree, rule, path, b.high, work);
        if (lac_rg_slips(tree, b.at_high)) {
            break;
        }
        b.low = b.high;
        b.at_low = b.at_high;
    }
    return lac_rg_close(tree, rule, path, b, work);
}
