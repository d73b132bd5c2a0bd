// SPDX-License-Identifier: GPL-3.0-or-later
// How far friction may leave cells apart, level by level of their blocks.
#include "scene/lump_parts.h"

// Sums over the cells from `first` on of p times each pattern, less its mean by p where it drives
// cells apart.
static void sum_forces(const lac_lump_source *s, lac_lump_cells *f, size_t first, size_t end)
{
    const double *p = s->whole.domain->pressure;
    for (size_t a = 0; a < LAC_LUMP_PATTERNS; a++) {
        const double *pattern = f->pattern + a * f->n;
        double *force = f->force + a * (f->n + 1);
        double sum = 0.0, mean = 0.0;
        for (size_t i = first; i < end && a != LAC_LUMP_ANSWER; i++) {
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

void lac_lump_add(const double *a, const double *b, double times, lac_lump_pairs *x)
{
    for (size_t i = 0; i < LAC_LUMP_PATTERNS; i++) {
        for (size_t j = 0; j < LAC_LUMP_PATTERNS; j++) {
            x->of[i][j] += times * a[i] * b[j];
        }
    }
}

void lac_lump_add_pairs(const lac_lump_pairs *x, double times, lac_lump_pairs *sum)
{
    for (size_t i = 0; i < LAC_LUMP_PATTERNS; i++) {
        for (size_t j = 0; j < LAC_LUMP_PATTERNS; j++) {
            sum->of[i][j] += times * x->of[i][j];
        }
    }
}

// The first block of a level that begins at a cell.
static size_t block_at(const lac_hierarchy *h, size_t level, size_t first)
{
    const uint32_t *begin = lac_hierarchy_offsets(h, level);
    size_t low = 0, high = lac_hierarchy_blocks(h, level);
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (begin[middle] < first) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

// Sums over the blocks of a level in [first, end) of products of their sums, over their cells.
static lac_lump_pairs pairs_of(const lac_lump_source *s, const lac_lump_cells *f, size_t level,
                               size_t first, size_t end)
{
    const uint32_t *begin = lac_hierarchy_offsets(s->blocks, level);
    lac_lump_pairs out = {0};
    for (size_t b = block_at(s->blocks, level, first); begin[b] < end; b++) {
        double sum[LAC_LUMP_PATTERNS];
        for (size_t which = 0; which < LAC_LUMP_PATTERNS; which++) {
            const double *force = f->force + which * (f->n + 1);
            sum[which] = force[begin[b + 1]] - force[begin[b]];
        }
        lac_lump_add(sum, sum, 1.0 / (double)(begin[b + 1] - begin[b]), &out);
        if (begin[b + 1] == end) {
            break;
        }
    }
    return out;
}

void lac_lump_add_levels(const lac_lump_source *s, lac_lump_cells *f, size_t top, size_t first,
                         size_t end, lac_lump_pairs *out)
{
    sum_forces(s, f, first, end);
    lac_lump_pairs finer = pairs_of(s, f, 0, first, end);
    for (size_t l = 0; l < top; l++) {
        const lac_lump_pairs coarser = pairs_of(s, f, l + 1, first, end);
        lac_lump_add_pairs(&finer, 1.0, &out[l]);
        lac_lump_add_pairs(&coarser, -1.0, &out[l]);
        finer = coarser;
    }
}

// Of what drives, by itself.
double lac_lump_trace(const lac_lump_pairs *x)
{
    double sum = 0.0;
    for (size_t a = LAC_LUMP_ANSWER + 1; a < LAC_LUMP_PATTERNS; a++) {
        sum += fmax(0.0, x->of[a][a]);
    }
    return sum;
}

double lac_lump_stiffness(const lac_lump_source *s, size_t level)
{
    const lac_transfer *transfer = s->whole.transfer;
    return transfer->kind->stiffness(transfer->state, level);
}

size_t lac_lump_choose_level(const lac_lump_source *s, lac_lump_cells *f, double error)
{
    const size_t levels = lac_hierarchy_levels(s->blocks);
    lac_lump_pairs of[LAC_LUMP_LEVELS] = {0};
    double apart[LAC_LUMP_LEVELS]; // squares of slip over dc by which each level may come apart
    lac_lump_add_levels(s, f, levels, 0, f->n, of);
    for (size_t l = 0; l < levels; l++) {
        const double by = f->direct * f->per_dc / lac_lump_stiffness(s, l);
        apart[l] = lac_lump_trace(&of[l]) * by * by / (double)f->n;
    }
    size_t level = levels;
    for (size_t l = levels; l-- > 1;) {
        level = apart[l] > fmax(0.1 * error, 2.0 * apart[0]) ? l : level;
    }
    return level;
}
