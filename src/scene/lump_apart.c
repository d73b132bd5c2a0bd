// SPDX-License-Identifier: GPL-3.0-or-later
// How far friction may leave cells apart, level by level of their blocks.
#include "scene/lump_parts.h"

// Sums over the cells from `first` on of p times each pattern that drives them apart, less its mean
// by p.
static void sum_forces(const lac_lump_source *s, lac_lump_cells *f, size_t first, size_t end)
{
    const double *p = s->whole.domain->pressure;
    for (size_t a = LAC_LUMP_ANSWER + 1; a < LAC_LUMP_PATTERNS; a++) {
        const double *pattern = f->pattern + a * f->n;
        double *force = f->force + a * (f->n + 1);
        double sum = 0.0, mean = 0.0;
        for (size_t i = first; i < end; i++) {
            sum += p[i];
            mean += p[i] * pattern[i];
        }
        mean /= sum > 0.0 ? sum : 1.0;
        force[first] = 0.0;
        for (size_t i = first; i < end; i++) {
            force[i + 1] = force[i] + p[i] * (pattern[i] - mean);
        }
    }
}

static int compare(const void *left, const void *right)
{
    const uint32_t *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

// Sums over the blocks of a level in [first, end) of squares of their sums, over their cells.
static double squares_of(const lac_lump_source *s, const lac_lump_cells *f, size_t level,
                         size_t first, size_t end)
{
    const uint32_t from = (uint32_t)first, *begin = lac_hierarchy_offsets(s->blocks, level);
    double out = 0.0;
    for (begin =
             bsearch(&from, begin, lac_hierarchy_blocks(s->blocks, level), sizeof *begin, compare);
         begin[0] < end; begin++) {
        for (size_t which = LAC_LUMP_ANSWER + 1; which < LAC_LUMP_PATTERNS; which++) {
            const double *force = f->force + which * (f->n + 1);
            const double sum = force[begin[1]] - force[begin[0]];
            out += sum * sum / (double)(begin[1] - begin[0]);
        }
    }
    return out;
}

void lac_lump_add_levels(const lac_lump_source *s, lac_lump_cells *f, size_t top, size_t first,
                         size_t end, double *out)
{
    sum_forces(s, f, first, end);
    double finer = squares_of(s, f, 0, first, end);
    for (size_t l = 0; l < top; l++) {
        const double coarser = squares_of(s, f, l + 1, first, end);
        out[l] += fmax(0.0, finer - coarser);
        finer = coarser;
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
    double apart[LAC_LUMP_LEVELS] = {0.0}; // squares of slip over dc by which each may come apart
    lac_lump_add_levels(s, f, levels, 0, f->n, apart);
    for (size_t l = 0; l < levels; l++) {
        const double by = f->direct * f->per_dc / lac_lump_stiffness(s, l);
        apart[l] *= by * by / (double)f->n;
    }
    size_t level = levels;
    for (size_t l = levels; l-- > 1;) {
        level = apart[l] > fmax(0.1 * error, 2.0 * apart[0]) ? l : level;
    }
    return level;
}
