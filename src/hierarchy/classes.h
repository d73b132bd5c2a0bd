/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Classes of cells tied to one another in blocks: the leaves stand for several cells each, a block
/// for its leaves and blocks. A node's number is below that of the block that it lies in, so the
/// last one is the root. docs/theory/lumped.md.
typedef struct lac_classes {
    size_t leaves, nodes; ///< the leaves come first
    uint32_t *parent;     ///< [nodes] block that a node lies in; of the root itself
    double *weight;       ///< [nodes] cells that it stands for, in any unit
    double *k;            ///< [nodes] what ties the children of a block to its mean [Pa/m]
} lac_classes;

/// Room for so many nodes; numbers and ties are the caller's.
lac_status lac_classes_create(size_t leaves, size_t nodes, lac_classes **out, lac_error *err);

/// Of all four `state` is a lac_classes, as a transfer has it.
void lac_classes_free(void *state);

/// Doubles of scratch that apply and solve need.
size_t lac_classes_work(const void *state);

/// y = K x over the leaves: of every block B that a leaf lies in, child c, k_B (x_c - x_B), means
/// by weight. x and y do not overlap. @cost  O(nodes)
void lac_classes_apply(const void *state, const double *x, double *y, double *work);

/// Solves (D + K + k_mean times the mean by weight) x = y as lac_hierarchy_solve does.
bool lac_classes_solve(const void *state, double k_mean, const double *diagonal, const double *y,
                       double *x, double *work);
