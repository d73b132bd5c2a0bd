/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/lump.h"

enum {
    MOST_VARIABLES = 24,
    PATTERNS = 6,
    ANSWERS = 3,
    STAGES = 3,
    FEWEST_NODES = 4,
    MOST_NODES = 10
};

// What the cells differ in: of all of them, scaled block by block.
typedef struct lac_lump_variable {
    double *value; // [n]
    double mean, scale;
} lac_lump_variable;

typedef struct lac_lump_cells {
    size_t n, variables;
    lac_lump_variable of[MOST_VARIABLES];
    double *pattern;     // [PATTERNS][n] what friction may leave a cell apart by, in parts of p
    double *force;       // [PATTERNS][n + 1] sums up to a cell of p times a pattern
    double *held;        // [STAGES][n] part of friction by the state, after so much slip
    double per_dc;       // mean of 1/dc [1/m]
    double rate;         // mean slip rate at the start [m/s]
    double gain;         // of lac_lump
    double apart_by[64]; // squares of slip over dc by which each level may come apart
    bool apart;          // a load acts on the cells otherwise than their pressures do
    double *memory;
} lac_lump_cells;

// The cells of one block as points.
typedef struct lac_lump_block {
    const double *pressure; // [n] from its first cell on
    size_t first, n;
    size_t active; // variables that are no straight line of those before them
    const lac_lump_variable *at[MOST_VARIABLES];
    double mean[MOST_VARIABLES], scale[MOST_VARIABLES];
    double share[MOST_VARIABLES][MOST_VARIABLES]; // of the ones before it that each is less
    double mean_pressure;
    size_t degree;
    bool apart; // leaves keep pressures of their own
} lac_lump_block;

// Of each two patterns.
typedef struct lac_lump_pairs {
    double of[PATTERNS][PATTERNS];
} lac_lump_pairs;

// What moves the cells; `memory` is the caller's to free.
lac_status lac_lump_look(const lac_lump_source *s, lac_lump_cells *f, lac_error *err);

// A block of n cells from `first` on, for a quadrature of so many nodes.
void lac_lump_block_look(const lac_lump_cells *of, const double *pressure, size_t first, size_t n,
                         size_t nodes, lac_lump_block *b);

// Functions of its cells whose sums are kept, and their values: lac_cubature.at.
size_t lac_lump_block_functions(const lac_lump_block *b);
void lac_lump_block_values(const void *block, size_t point, double *value);

// Which of its leaves each cell is most like. @param kept  [leaves] cells of the block
// @param leaf  [b->n] overwritten; room  [leaves][b->active]
void lac_lump_block_assign(const lac_lump_block *b, const uint32_t *kept, size_t leaves,
                           uint32_t *leaf, double *room);

void lac_lump_add_pairs(const lac_lump_pairs *x, double times, lac_lump_pairs *sum);
double lac_lump_trace(const lac_lump_pairs *x);

// What the patterns have of each level below `top` within cells [first, end): products of the means
// of its blocks less those of the next ones'. @param out  [top]; added to
void lac_lump_add_levels(const lac_lump_source *s, lac_lump_cells *f, size_t top, size_t first,
                         size_t end, lac_lump_pairs *out);

// k_l of the scene [Pa/m].
double lac_lump_stiffness(const lac_lump_source *s, size_t level);

// The level whose blocks are taken together: above it slip over dc by which blocks would come apart
// is small, or no larger than that of single cells.
lac_status lac_lump_choose_level(const lac_lump_source *s, lac_lump_cells *f, double error,
                                 size_t *level, lac_error *err);
