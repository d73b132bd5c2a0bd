/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_ONE_CELL_H
#define LACUNA_TESTS_ONE_CELL_H

#include "lacuna/simulation.h"
#include "support/block.h"

// Time [s] in which the block goes from its start to slip rate `to` under constant load, aging law,
// plain form, damping included, in long double: with u = ln v and w = ln theta the balance gives
//   b (w - w0) = -a (u - u0) - eta (v - v(0))/p,   so   dt = (a + eta v/p)/b du / (v/dc - 1/theta)
// The integrand must not change sign on the way.
double one_cell_time(const block_def *def, double to);

// What came of a run.
typedef struct one_cell_outcome {
    lac_status status;
    lac_run_result result;
    char message[256]; // where status is not LAC_OK
    bool finite;       // every number of every record
    double last_rate;  // mean slip rate of the last record [m/s]
} one_cell_outcome;

// Runs a problem with a watch on its records.
one_cell_outcome watched_run(const lac_problem *problem, const lac_run_def *how);
one_cell_outcome one_cell_run(const block_def *def, const lac_run_def *how);

#endif
