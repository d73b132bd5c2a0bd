/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "run/pending.h"

// What waits is made in one pass over memory.

enum {
    LAC_PASS_LANES = 8, // sums of squares that run beside each other
    LAC_PASS_ORDER = 5, // of a prediction that is made in registers, at most: BDF's
};

// z = sum_j c_j x_j; count 0: z = c_0. Or another form of x_0.
typedef struct lac_combination {
    const double *x[LAC_PENDING_TERMS];
    double c[LAC_PENDING_TERMS];
    double *z;
    int count;
    lac_pending_form form;
} lac_combination;

// What CVODE does to its history z_0 ... z_q from step to step: z_j = c_j a + z_j of each where
// `corrected`, then z_j-1 = z_j-1 + z_j for j = q ... m, of m = 1 ... q.
typedef struct lac_prediction {
    const double *z[LAC_PASS_ORDER + 1];
    double *to[LAC_PASS_ORDER + 1]; // the same; the last only where it is corrected
    double c[LAC_PASS_ORDER + 1];
    const double *a;
    int order; // q; 0: none
    bool corrected;
} lac_prediction;

// Made in one pass, in the order of the list; (x w)^2 is added up on the way.
typedef struct lac_pass {
    const lac_combination *list;
    size_t count;
    size_t apart; // the first so many are made one by one, the rest as
    lac_prediction predicted;
    const double *x, *w; // or NULL
    double level;        // w where that is NULL
} lac_pass;

// Whether t is z = c x + z.
bool lac_combination_gains(const lac_combination *t, const double *z, const double *x);

// Looks how the list is best made.
void lac_pass_plan(lac_pass *pass);

// All of it for a stretch of the vectors. @param sums  [LAC_PASS_LANES] gain the squares
void lac_pass_make(const void *pass, size_t first, size_t end, double *sums);
