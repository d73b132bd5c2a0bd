/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>
#include <stddef.h>

// What waits is made in one pass over memory.

enum {
    LAC_PASS_TERMS = 16, // of a sum, at most: CVODE and ARKODE ask for less
    LAC_PASS_LANES = 8,  // sums of squares that run beside each other
    LAC_PASS_ORDER = 5,  // of a prediction that is made in registers, at most: BDF's
};

// z = sum_j c_j x_j; count 0: z = c_0
typedef struct lac_combination {
    const double *x[LAC_PASS_TERMS];
    double c[LAC_PASS_TERMS];
    double *z;
    int count;
} lac_combination;

// What CVODE does to its history z_0 ... z_q at the beginning of a step, q its order:
// z_j-1 = z_j-1 + z_j for j = q ... m, of m = 1 ... q.
typedef struct lac_prediction {
    double *z[LAC_PASS_ORDER + 1]; // but the last
    const double *top;             // z_q, which stays
    int order;                     // q; 0: none
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

// Looks whether the last of the list are a prediction.
void lac_pass_plan(lac_pass *pass);

// All of it for a stretch of the vectors. @param sums  [LAC_PASS_LANES] gain the squares
void lac_pass_make(const void *pass, size_t first, size_t end, double *sums);
