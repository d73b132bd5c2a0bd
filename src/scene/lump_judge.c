// SPDX-License-Identifier: GPL-3.0-or-later
// How far off a result of few cells may be for all, and which of them a place has.
#include "scene/lump.h"

void lac_lump_soften(lac_lump *lump, double softness)
{
    for (size_t i = 0; i < lump->classes->nodes; i++) {
        const bool inner = i < lump->classes->leaves + lump->inner;
        lump->classes->k[i] = lump->bond[i] / (inner ? softness : 1.0);
    }
}

double lac_lump_bound(const lac_lump *lump, double value, double other, bool driven)
{
    const double least = 1.5e-5, undriven = 0.8; // slip answers to other things than failure
    const double first = fabs(value - other) / (1.0 - LAC_LUMP_STIFF) / fabs(value);
    const double off = driven ? lump->mismatch : fmax(lump->mismatch, undriven);
    const double weak = lump->weakness;
    const double sum =
        2.0 * first * (off + weak + 1.3 * weak * weak) + 2.0 * lump->gain * lump->rest;
    return isfinite(sum) ? fmax(sum, least) : (double)INFINITY;
}

void lac_lump_points(const lac_lump *lump, const lac_domain *cells, lac_points *points)
{
    for (size_t i = 0; i < points->n; i++) {
        lac_point *p = &points->point[i];
        double pressed = 0.0;
        for (size_t k = 0; k < p->cells; k++) {
            const size_t leaf = lump->leaf[p->cell[k]];
            pressed += cells->pressure[p->cell[k]] / lump->domain->pressure[leaf];
            p->cell[k] = leaf;
        }
        p->pressed = pressed / (double)p->cells;
    }
}
