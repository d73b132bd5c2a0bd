/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "async/async.h"
#include "async/cell.h"

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
