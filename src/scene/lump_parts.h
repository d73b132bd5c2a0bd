/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/lump.h"

// Rows of `friction`: what friction the cells have, in parts of the direct effect; the leaves keep
// their sums.
enum {
    LAC_LUMP_ANSWER = 0,                   // b/dc: how friction answers to slip
    LAC_LUMP_LOAD,                         // traction over pressure at the start
    LAC_LUMP_START,                        // at the joint's slip rate
    LAC_LUMP_FAST,                         // at a much faster one, states as at the start
    LAC_LUMP_STEADY,                       // at both, with the states that are steady there
    LAC_LUMP_STAGES = LAC_LUMP_STEADY + 2, // after so much slip, at several slip rates
    LAC_LUMP_HISTORIES = 3,
    LAC_LUMP_EACH = 12,
    LAC_LUMP_ROWS = LAC_LUMP_STAGES + LAC_LUMP_HISTORIES * LAC_LUMP_EACH,
    LAC_LUMP_LEVELS = 64,
    LAC_LUMP_PATTERNS = 6 // LAC_LUMP_ANSWER, and what friction may leave cells apart by
};

// What moves the cells.
typedef struct lac_lump_cells {
    size_t n;
    double *friction; // [LAC_LUMP_ROWS][n]
    double *pattern;  // [LAC_LUMP_PATTERNS][n]
    double *apart;    // [n] how far they come apart: lac_lump_apart
    double *scratch;  // [2 n + lac_hierarchy_work]
    double pressure;  // mean [Pa]
    double direct;    // mean of a by pressure
    double answer;    // mean of the answer by pressure
    double per_dc;    // mean of 1/dc [1/m]
    double mean_rate; // mean slip rate at the start [m/s]
    double rate;      // once all cells go as one [m/s]
    double gain;      // by which an error counts more, near a steady state
    double *memory;
} lac_lump_cells;

// What moves the cells; `memory` is the caller's to free.
lac_status lac_lump_look(const lac_lump_source *s, lac_lump_cells *f, lac_error *err);

// Fills in `apart`: the force by which each pattern moves a cell, less the mean of its block of
// level `top`, times what sum_l by_l (P_l - P_{l+1}) makes of it. @param by  [levels]
void lac_lump_apart(const lac_lump_source *s, lac_lump_cells *f, size_t top, const double *by);

// k_l of the scene [Pa/m].
double lac_lump_stiffness(const lac_lump_source *s, size_t level);

// The level whose blocks are taken together: above it slip over dc by which blocks would come apart
// is small, or no larger than that of single cells.
size_t lac_lump_choose_level(const lac_lump_source *s, lac_lump_cells *f, double error);
