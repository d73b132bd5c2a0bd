/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BENCH_STOCK_CREEP_H
#define LACUNA_BENCH_STOCK_CREEP_H

#include <stdbool.h>
#include <stdint.h>

#include "support/tree.h"

/// What somebody would write with SUNDIALS as it is installed: the rate formulation on the same
/// tree, cell by cell with libm, NVECTOR_SERIAL, BDF, SPGMR with Jacobian products by differences
/// and no preconditioner.
typedef struct stock_outcome {
    int64_t steps, rhs, linear_iterations;
    double time, max_rate; // reached [s], [m/s]
    double cpu;            // [s]
    bool done;             // the rate was reached
} stock_outcome;

/// Runs until a cell slips at `stop_rate` or `most_cpu` seconds are used. Exits where it cannot.
stock_outcome stock_creep(const tree *t, const tree_def *def, double rtol, double stop_rate,
                          double most_cpu);

#endif
