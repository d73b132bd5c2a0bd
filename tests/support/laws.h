/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_LAWS_H
#define LACUNA_TESTS_LAWS_H

#include <stdint.h>

#include "friction/friction.h"

// Laws on made-up cells, for the conformance kit.

enum { LAWS_CELLS = 300 };

// Everything that one evaluation gives, at up to a block of cells.
typedef struct evaluation {
    double u[LAC_FRICTION_BLOCK], w[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    double out[9][LAC_FRICTION_BLOCK];
} evaluation;

enum { F, F_U, F_W, G, F_UU, F_UW, F_WW, G_U, G_W, OUTPUTS };

// A law in one of its forms.
typedef struct variant {
    size_t law;
    int form;
    bool v1, v2; // with cut-offs
} variant;

// Uniform numbers, a function of `i` and `what`.
double laws_uniform(uint64_t i, uint64_t what, double low, double high);
// Uniform, but every fourth time one of the ends.
double laws_biased(uint64_t i, uint64_t what, double low, double high);

// Cells that are alike, and cells that differ in every parameter they have, over decades of each.
lac_friction *laws_make(const variant *kind, size_t n, double a, double b, double dc);
lac_friction *laws_make_varied(const variant *kind);

void laws_evaluate(const lac_friction *friction, size_t first, size_t n, evaluation *e);

// Fails, unless `holds`, with the law, the cell's parameters and the rate and state it was at,
// ln v and ln theta.
void laws_must(bool holds, const lac_friction *friction, size_t cell, const double at[2],
               const char *what);

#endif
