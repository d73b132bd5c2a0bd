/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

enum {
    LAC_PARTS = 64,            ///< a long loop is cut into so many parts, whatever the threads
    LAC_PARTS_ALONE = 1 << 17, ///< shorter loops are one part
    LAC_PARTS_GRAIN = 256      ///< parts begin at multiples of this
};

/// What is done to the elements first ... end - 1, the part-th part of a loop.
typedef void lac_parallel_body(void *context, size_t part, size_t first, size_t end);

/// Runs a loop over n elements, in as many threads as omp_get_max_threads says where it is long.
/// The parts depend on n alone: what is summed up by parts, in their order, has the same bits for
/// any number of threads. Gives back how many there were.
size_t lac_parallel_for(size_t n, lac_parallel_body *body, void *context);

/// The same cut into blocks of so many elements, the last of which may be shorter.
size_t lac_parallel_blocks(size_t n, size_t block, lac_parallel_body *body, void *context);
