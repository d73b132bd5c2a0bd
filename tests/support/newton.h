/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_NEWTON_H
#define LACUNA_TESTS_NEWTON_H

#include "support/tree.h"

// The exact Newton solve of the creep problem against a dense one whose Jacobian is made of
// differences.

#define NEWTON_EXACT 1e-6 // but for the differences that J is made of

// What pulls at the cells: the parameters of a load of the row.
typedef enum newton_pull_kind {
    BY_RATIO = 1,
    BY_FORCE = 2,
    BY_SPRING = 4,
    BY_PORE = 8
} newton_pull_kind;
extern const lac_load_kind newton_pull;
extern const int newton_pulls[6];
extern const lac_formulation newton_formulations[3];

// Damping: none; of the mean so weak that the solve leaves it out, its error then a thousandth; so
// strong that it holds as much as friction.
typedef struct newton_damping {
    double times, left;
} newton_damping;
extern const newton_damping newton_dampings[3];

// A tree of few cells for one law and form.
tree_def newton_tree(const lac_friction_law *law, int form, uint64_t seed);

// Puts every cell of a block with mass up to a tenth of an e-fold off the rate that balances it.
void newton_near_balance(const tree *t, const tree_def *def, double time, double *y);

// @param left  of the largest component, that the solve may be off by
void newton_check(const lac_problem *problem, const double *y, double t, double gamma, double left);

// The same at the start of a tree, over steps of many lengths. @param damped  not the longest
void newton_check_tree(const tree_def *def, bool damped, double left);

#endif
