// SPDX-License-Identifier: GPL-3.0-or-later
// Long loops in threads, cut at the same places for any number of them: sums keep the same bits.
#include "base/parallel_for.h"

#include <omp.h>

static size_t begin_of(size_t n, size_t part)
{
    size_t grains = (n + LAC_PARTS_GRAIN - 1) / LAC_PARTS_GRAIN;
    size_t first = grains * part / LAC_PARTS * LAC_PARTS_GRAIN;
    return first < n ? first : n;
}

size_t lac_parallel_for(size_t n, lac_parallel_body *body, void *context)
{
    if (n < LAC_PARTS_ALONE) {
        body(context, 0, 0, n);
        return 1;
    }
#pragma omp parallel for schedule(static) if (omp_get_max_threads() > 1)
    for (int part = 0; part < LAC_PARTS; part++) {
        size_t k = (size_t)part;
        body(context, k, begin_of(n, k), begin_of(n, k + 1));
    }
    return LAC_PARTS;
}

size_t lac_parallel_blocks(size_t n, size_t block, lac_parallel_body *body, void *context)
{
    const int blocks = (int)((n + block - 1) / block);
#pragma omp parallel for schedule(static) if (n >= LAC_PARTS_ALONE && omp_get_max_threads() > 1)
    for (int b = 0; b < blocks; b++) {
        const size_t first = (size_t)b * block;
        body(context, (size_t)b, first, n - first < block ? n : first + block);
    }
    return (size_t)blocks;
}
