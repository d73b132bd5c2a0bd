/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_TREE_H
#define LACUNA_TESTS_TREE_H

#include "run/run.h"

// Many cells on a random lacunar tree: each block of 2^levels cells a side keeps each of its
// children with probability `keep`, at least one.
typedef struct tree_def {
    int levels;
    double keep;
    uint64_t seed;
    const char *law;
    int form;
    double f0, a, b, dc, v0;
    double v1, v2, alpha; // 0: none
    double pressure;      // p_i = pressure * (0.05 + exponential(1))
    double k0, ratio;     // k_l = k0 ratio^l
    double damping;
    double mass, columns;               // [kg/m2], [1]; 0: none
    double cohesion;                    // [Pa]
    const lac_weakening_set *weakening; // NULL: none
    double slip_rate;                   // ln v uniform within +-1 of it
    double state;                       // theta [s]
    lac_load_set loads;
    lac_formulation formulation;
    double heading; // of the tractions at the start, where slip has two directions [rad]
} tree_def;

typedef struct tree {
    lac_domain *domain;
    lac_hierarchy *hierarchy;
    lac_transfer transfer;
    lac_friction *friction;
    lac_problem *problem;
} tree;

// Rock at 50 MPa, 1 mm cells, G 10 GPa, aging law, creep at 1e-9 m/s.
tree_def tree_default(int levels, uint64_t seed);

// Its parts, for domains of other making: out->domain and out->hierarchy must be there.
void tree_make_transfer(const tree_def *def, tree *out);
void tree_make_friction(const tree_def *def, tree *out);

void tree_create(const tree_def *def, tree *out);
void tree_clear(tree *t);

#endif
