/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/lump.h"

// Rows of `friction`: what friction the cells have, in parts of the direct effect; all but those
// behind LAC_LUMP_KEPT have sums that the leaves keep.
enum {
    LAC_LUMP_ANSWER = 0,                   // b/dc: how friction answers to slip
    LAC_LUMP_LOAD,                         // traction over pressure at the start
    LAC_LUMP_START,                        // at the joint's slip rate
    LAC_LUMP_FAST,                         // at a much faster one, states as at the start
    LAC_LUMP_STEADY,                       // at both, with the states that are steady there
    LAC_LUMP_STAGES = LAC_LUMP_STEADY + 2, // after so much slip, at several slip rates
    LAC_LUMP_HISTORIES = 3,
    LAC_LUMP_EACH = 12,
    LAC_LUMP_KEPT = LAC_LUMP_STAGES + LAC_LUMP_HISTORIES * LAC_LUMP_EACH,
    LAC_LUMP_TESTS = LAC_LUMP_HISTORIES * LAC_LUMP_EACH, // the same between those stages
    LAC_LUMP_ROWS = LAC_LUMP_KEPT + LAC_LUMP_TESTS,
    LAC_LUMP_LEVELS = 64,
    LAC_LUMP_PATTERNS = 6 // LAC_LUMP_ANSWER, and what friction may leave cells apart by
};

// What moves the cells.
typedef struct lac_lump_cells {
    size_t n;
    double *friction; // [LAC_LUMP_ROWS][n]
    double *pattern;  // [LAC_LUMP_PATTERNS][n]
    double *force;    // [LAC_LUMP_PATTERNS][n + 1] sums up to a cell of p times a pattern
    double pressure;  // mean [Pa]
    double direct;    // mean of a by pressure
    double answer;    // mean of the answer by pressure
    double per_dc;    // mean of 1/dc [1/m]
    double mean_rate; // mean slip rate at the start [m/s]
    double rate;      // once all cells go as one [m/s]
    double gain;      // of lac_lump
    double *memory;
} lac_lump_cells;

// Of each two patterns: what the second drives apart, as the first answers to it.
typedef struct lac_lump_pairs {
    double of[LAC_LUMP_PATTERNS][LAC_LUMP_PATTERNS];
} lac_lump_pairs;

// What moves the cells; `memory` is the caller's to free.
lac_status lac_lump_look(const lac_lump_source *s, lac_lump_cells *f, lac_error *err);

// x += times a b'
void lac_lump_add(const double *a, const double *b, double times, lac_lump_pairs *x);
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
size_t lac_lump_choose_level(const lac_lump_source *s, lac_lump_cells *f, double error);
