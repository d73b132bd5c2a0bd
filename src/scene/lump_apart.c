// SPDX-License-Identifier: GPL-3.0-or-later
// How far friction may leave cells apart, level by level of their blocks.
#include "base/vsum.h"
#include "scene/lump_parts.h"

void lac_lump_apart(const lac_lump_source *s, lac_lump_cells *f, size_t top, const double *by)
{
    const uint32_t *begin = lac_hierarchy_offsets(s->blocks, top);
    const double *p = s->whole.domain->pressure;
    double *force = f->scratch, *moved = force + f->n, *work = moved + f->n;
    memset(f->apart, 0, f->n * sizeof *f->apart);
    for (size_t a = LAC_LUMP_ANSWER + 1; a < LAC_LUMP_PATTERNS; a++) {
        const double *pattern = f->pattern + a * f->n;
        for (size_t b = 0; b < lac_hierarchy_blocks(s->blocks, top); b++) {
            double sum = 0.0, mean = 0.0;
            for (size_t i = begin[b]; i < begin[b + 1]; i++) {
                sum += p[i];
                mean += p[i] * pattern[i];
            }
            for (size_t i = begin[b]; i < begin[b + 1]; i++) {
                force[i] = p[i] * (pattern[i] - mean / sum);
            }
        }
        lac_hierarchy_apply(s->blocks, by, force, moved, work);
        for (size_t i = 0; i < f->n; i++) {
            f->apart[i] += force[i] * moved[i];
        }
    }
}

double lac_lump_stiffness(const lac_lump_source *s, size_t level)
{
    const lac_transfer *transfer = s->whole.transfer;
    return transfer->kind->stiffness(transfer->state, level);
}

size_t lac_lump_choose_level(const lac_lump_source *s, lac_lump_cells *f, double error)
{
    const size_t levels = lac_hierarchy_levels(s->blocks);
    double apart[LAC_LUMP_LEVELS]; // squares of slip over dc by which each may come apart
    for (size_t l = 0; l < levels; l++) {
        const double by = f->direct * f->per_dc / lac_lump_stiffness(s, l);
        double alone[LAC_LUMP_LEVELS] = {0.0};
        alone[l] = by * by / (double)f->n;
        lac_lump_apart(s, f, levels, alone);
        apart[l] = lac_vsum(f->n, f->apart);
    }
    const double least = 0.01; // what a smaller error asks is left to the ties
    size_t level = levels;
    for (size_t l = levels; l-- > 1;) {
        level = apart[l] > fmax(0.1 * fmax(error, least), 2.0 * apart[0]) ? l : level;
    }
    return level;
}
