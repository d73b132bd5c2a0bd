/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "hierarchy/blocks.h"

// Whether other ranks have cells too, and there is a top over all.
static inline bool lac_split_is_topped(const lac_hierarchy *h)
{
    return h->split != NULL && h->split->top != NULL;
}

void lac_split_free(lac_split *split);

// Doubles of scratch for the top, behind those of the part here.
size_t lac_split_work(const lac_split *split);

// Up to two values of the cells, and of the blocks of all partitions but the cells.
typedef struct lac_split_values {
    const double *cells[2], *blocks[2]; // NULL: there is none
} lac_split_values;

// Those of the leaves of all ranks, to each. @param leaves  [2 leaves + 1] overwritten: one value
// of all, then the other. @return whether all ranks are good
bool lac_split_join(const lac_hierarchy *h, bool good, const lac_split_values *from,
                    double *leaves);

// What others have a part of counts for nothing here, and is good.
static inline void lac_split_calm(const lac_hierarchy *h, size_t j, double *t, double *y)
{
    for (int i = 0; h->split != NULL && i < h->split->edges[j]; i++) {
        t[h->split->edge[j][i].here] = 1.0;
        y[h->split->edge[j][i].here] = 0.0;
    }
}

// Takes what the top says of them. @param top  of all its partitions but the leaves
static inline void lac_split_patch(const lac_hierarchy *h, size_t j, const double *const top[2],
                                   double *a, double *b)
{
    for (int i = 0; h->split != NULL && i < h->split->edges[j]; i++) {
        const lac_edge *edge = &h->split->edge[j][i];
        a[edge->here] = top[0][edge->top];
        b[edge->here] = top[1][edge->top];
    }
}
