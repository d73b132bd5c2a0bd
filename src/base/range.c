// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over the cells in blocks that only their number fixes.
#include "base/range.h"

#include "base/parallel_for.h"
#include "base/strip.h"
#include "base/vsum.h"

static size_t up_to_multiple(size_t n, size_t of) { return (n + of - 1) / of * of; }

lac_range lac_range_whole(size_t all)
{
    const size_t even = up_to_multiple(all, LAC_RANGE_BLOCKS) / LAC_RANGE_BLOCKS;
    const size_t block = up_to_multiple(even, LAC_PARTS_GRAIN);
    const size_t least = all < LAC_RANGE_ALONE ? LAC_RANGE_ALONE : LAC_RANGE_BLOCK_LEAST;
    return (lac_range){.all = all, .n = all, .block = block > least ? block : least};
}

lac_range lac_range_of(lac_team *team, int rank, size_t all)
{
    lac_range range = lac_range_whole(all);
    const lac_strip cells = lac_strip_of(team, all, range.block), of = lac_strip_at(&cells, rank);
    range.team = team;
    range.first = of.first;
    range.n = of.n;
    return range;
}

void lac_range_bring(const lac_range *range, const double *x, size_t first, size_t n, double *out)
{
    const lac_strip cells = lac_strip_of(range->team, range->all, range->block);
    const uint64_t wants[LAC_TEAM_MOST][2] = {{first, n}}; // of the first alone
    lac_strip_exchange(&cells, wants, sizeof *x, x, out);
}

bool lac_range_hand(const lac_range *range, double *x, size_t arrays, lac_range_take *take,
                    void *context)
{
    const bool alone = range->team == NULL, leads = lac_team_leads(range->team);
    double *room = alone ? NULL : malloc((leads ? LAC_RANGE_PIECE : 1) * sizeof *room);
    const bool good = alone || lac_team_all(range->team, room != NULL);
    for (size_t a = 0; good && a < arrays; a++, x += range->n) {
        for (size_t at = 0; at < range->all; at += LAC_RANGE_PIECE) {
            const size_t left = range->all - at,
                         n = left < LAC_RANGE_PIECE ? left : LAC_RANGE_PIECE;
            if (!alone) {
                lac_range_bring(range, x, at, n, room);
            }
            if (leads) {
                take(context, alone ? x + at : room, n);
            }
        }
    }
    free(room);
    return good;
}

// One pass over the cells.
typedef struct pass {
    lac_range_body *body;
    const void *context;
    size_t values;
    double *partial; // [blocks][values]
} pass;

static void add_block(void *context, size_t block, size_t first, size_t end)
{
    const pass *p = context;
    double *sums = p->partial + block * p->values;
    memset(sums, 0, p->values * sizeof *sums);
    p->body(p->context, first, end, sums);
}

void lac_range_join(const lac_range *range, size_t values, lac_range_body *body,
                    const void *context, double *sums)
{
    double partial[LAC_RANGE_BLOCKS * LAC_RANGE_SUMS];
    pass p = {body, context, values, partial};
    const size_t blocks = lac_range_blocks(range);
    if (range->team != NULL) {
        memset(partial, 0, blocks * values * sizeof *partial);
        p.partial += range->first / range->block * values;
    }
    (void)lac_parallel_blocks(range->n, range->block, add_block, &p);
    lac_team_join(range->team, partial, blocks * values);
    for (size_t i = 0; i < blocks; i++) {
        for (size_t k = 0; k < values; k++) {
            sums[k] += partial[i * values + k];
        }
    }
}

// One array.
typedef struct array {
    const double *x;
} array;

static void add_array(const void *context, size_t first, size_t end, double *sums)
{
    sums[0] += lac_vsum(end - first, ((const array *)context)->x + first);
}

double lac_range_sum(const lac_range *range, const double *x)
{
    double sum;
    lac_range_sums(range, 1, add_array, &(array){x}, &sum);
    return sum;
}
