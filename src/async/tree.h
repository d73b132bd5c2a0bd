/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "async/async.h"

// One contact cell with a time of its own; docs/theory/fidelity-events.md.
typedef struct lac_async_cell {
    double a, b, constant, dc, ln_dc; // friction: f = constant + a u + b w
    double pressure;                  // total [Pa]
    double share, share_rate;         // effective over total at t = 0 of the loads [1], [1/s]
    double damping;                   // of its own rate [Pa s/m]
    double traction;                  // q at t = 0 of the loads [Pa]
    double stiffness;                 // ties it to its parent block: K_i of eq. 2 [Pa/m]
    double t;                         // time of the state [s]
    double u, w, v, slip;             // ln v, ln theta, v [m/s], slip [m]
    double told;                      // rate that the others are told from t on [m/s]
    double ahead;                     // slip that they are told at t, less its own [m]
    double outer, area;               // E of its parent at t, and its integral over time
    double z;                         // slip over dc that a step may take
    double reach;                     // longest step, where waking cut the last one short [s]
    double due;                       // time of its next update [s]
    double pending;                   // change of E since t that has been handed down [Pa]
    double low, high;                 // change of E that wakes it [Pa]
    uint32_t parent;
} lac_async_cell;

// What all cells have in common.
typedef struct lac_async_rules {
    const lac_friction_lone *law;
    bool regularised;
    double tolerance; // of ln v over a step
} lac_async_rules;

// A stretch of time of one cell, over which what acts on it from outside is linear.
typedef struct lac_async_span {
    double length;       // [s]
    double pull0, pull1; // traction less own stiffness times slip, at its ends: A of eq. 3 [Pa]
    double pressure0, pressure1; // effective normal pressure [Pa]
    double own;                  // K_ii: own stiffness [Pa/m]
    double skew;                 // mean of A over the span less that of its ends [Pa]
} lac_async_span;

// Takes u, w, v and slip over a span, in as many steps as the tolerance asks for, which it counts.
// False where no slip rate balances the traction.
bool lac_async_cell_advance(const lac_async_rules *rules, const lac_async_span *span,
                            lac_async_cell *cell, int64_t *steps);

// Whether the traction that friction holds has fallen to nothing.
bool lac_async_cell_let_go(const lac_async_rules *rules, const lac_async_cell *cell);

// What acts on a cell at an instant.
typedef struct lac_async_push {
    double pull_rate;               // dA/dt [Pa/s]
    double pressure, pressure_rate; // effective [Pa], [Pa/s]
    double own;                     // K_ii [Pa/m]
} lac_async_push;

// Plans the next step of a cell from its state: its length, the rate that others are told, and the
// change of E that wakes it. Gives back its length [s]; may be INFINITY.
double lac_async_cell_plan(const lac_async_rules *rules, const lac_async_push *push,
                           lac_async_cell *cell);

// A block of two cells or more, or the root. Blocks with a single child are left out.
typedef struct lac_async_node {
    double below;     // stiffness that ties its children to it [Pa/m]
    double weight;    // that less the one that ties it to its parent: c of eq. 2 [Pa/m]
    double share;     // 1/cells
    double self;      // sum of weight share from here to the root: what a cell's slip does to E
    double sum, rate; // of the cells' slip at t, as told [m], [m/s]
    double t;         // [s]
    double area;      // integral of the mean slip over time up to t [m s]
    double damping;   // of its mean rate, at the root: what it takes off the mean cell [Pa s/m]
    double heard;     // mean rate when it was last opened [m/s]
    double gone;      // integral of the mean rate over time up to t [m]
    double opened;    // mean slip when it was last opened [m]
    double received;  // change of E handed down since then [Pa]
    double low, high; // change of E that opens it, since then [Pa]
    double cap_low, cap_high; // further change of E that cells below can do with [Pa]
    double next;              // when the first of all below is due [s]
    double due;               // that or exit [s]
    uint32_t next_who, who;   // which that is
    uint32_t parent;
    uint32_t first, children; // where its children stand in `child`
} lac_async_node;

// The blocks over the cells. Items are cells (below n) and blocks (n + number); the last is the
// root.
typedef struct lac_async_tree {
    uint32_t n, nodes;
    lac_async_cell *cell; // [n]
    lac_async_node *node; // [nodes]
    uint32_t *child;
    int64_t openings;
} lac_async_tree;

#define LAC_ASYNC_NONE UINT32_MAX
// Blocks on the way from a cell to the root, at most: grid coordinates have 32 bits.
enum { LAC_ASYNC_LEVELS = 40 };
// A cell wakes when this part of its margin is used; the rest keeps its blocks' bounds above 0.
#define LAC_ASYNC_WAKES 0.75

lac_status lac_async_tree_create(const lac_hierarchy *h, const double *k, lac_async_tree *out,
                                 lac_error *err);
void lac_async_tree_clear(lac_async_tree *tree);

// Sets the stiffness of the mean slip, and the damping of the mean rate.
void lac_async_tree_anchor(lac_async_tree *tree, double k_mean, double damping);

// What the blocks do to a cell at time t; eq. 2.
typedef struct lac_async_view {
    double outer, rate; // E and dE/dt, without damping of the mean [Pa], [Pa/s]
    double area;        // integral of E over time [Pa s]
    double mean, gone;  // mean rate of all cells and its integral over time [m/s], [m]
} lac_async_view;

lac_async_view lac_async_tree_view(const lac_async_tree *tree, uint32_t parent, double t);

// A cell was updated at time t: its slip is `slip` more than told, and it tells a rate `rate` more
// from now on. Its blocks take that, hand down what they have pending, and renew their bounds.
void lac_async_tree_add(lac_async_tree *tree, uint32_t cell, double t, double slip, double rate);

// Hands down what a block has pending to its children; cells that this wakes are due at t.
void lac_async_tree_open(lac_async_tree *tree, uint32_t node, double t);

// Sums and bounds of all blocks from their cells, all at time 0, nothing pending.
void lac_async_tree_fill(lac_async_tree *tree);

// Renews all bounds.
void lac_async_tree_propagate(lac_async_tree *tree, double t);

// Takes `by` off all times.
void lac_async_tree_shift(lac_async_tree *tree, double by);
