// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over the cells in blocks that only their number fixes.
#include "base/range.h"

#include "base/parallel_for.h"
#include "base/vsum.h"

static size_t up_to_multiple(size_t n, size_t of) { return (n + of - 1) / of * of; }

lac_range lac_range_whole(size_t all)
{
    const size_t even = up_to_multiple(all, LAC_RANGE_BLOCKS) / LAC_RANGE_BLOCKS;
    const size_t block = up_to_multiple(even, LAC_PARTS_GRAIN);
    const size_t least = all < LAC_RANGE_ALONE ? LAC_RANGE_ALONE : LAC_RANGE_BLOCK_LEAST;
    return (lac_range){.all = all, .n = all, .block = block > least ? block : least};
}

// Where the blocks of a rank begin.
static size_t begin_of(size_t blocks, size_t rank, size_t ranks)
{
    return (blocks * rank + ranks - 1) / ranks;
}

lac_range lac_range_of(lac_team *team, int rank, size_t all)
{
    lac_range range = lac_range_whole(all);
    if (team == NULL) {
        return range;
    }
    const size_t blocks = lac_range_blocks(&range);
    const size_t first = begin_of(blocks, (size_t)rank, (size_t)team->ranks) * range.block;
    const size_t end = begin_of(blocks, (size_t)rank + 1, (size_t)team->ranks) * range.block;
    range.team = team;
    range.first = first < all ? first : all;
    range.n = (end < all ? end : all) - range.first;
    return range;
}

// Of an array the next piece that the rank that leads takes.
static void hand_piece(const lac_range *range, double *x, size_t piece, double *room,
                       lac_range_take *take, void *context)
{
    const size_t left = range->all - piece, n = left < LAC_RANGE_PIECE ? left : LAC_RANGE_PIECE;
    const size_t end = range->first + range->n < piece + n ? range->first + range->n : piece + n;
    const size_t first = range->first > piece ? range->first : piece;
    const bool some = first < end;
    range->team->gather(range->team, x + (some ? first - range->first : 0), some ? end - first : 0,
                        room);
    if (lac_team_leads(range->team)) {
        take(context, room, piece, n);
    }
}

bool lac_range_hand(const lac_range *range, double *x, size_t arrays, lac_range_take *take,
                    void *context)
{
    double *room = NULL;
    if (range->team != NULL && lac_team_leads(range->team)) {
        room = malloc((range->all < LAC_RANGE_PIECE ? range->all : LAC_RANGE_PIECE) * sizeof *room);
    }
    const bool good = lac_team_all(range->team, room != NULL || !lac_team_leads(range->team));
    for (size_t a = 0; a < arrays && (good || range->team == NULL); a++) {
        double *here = x + a * range->n;
        if (range->team == NULL) {
            take(context, here, 0, range->n);
        }
        for (size_t at = 0; range->team != NULL && at < range->all; at += LAC_RANGE_PIECE) {
            hand_piece(range, here, at, room, take, context);
        }
    }
    free(room);
    return good || range->team == NULL;
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
