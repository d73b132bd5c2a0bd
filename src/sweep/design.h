/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "sweep/sweep.h"

/// A distribution by the inverse of its cumulative distribution.
typedef struct lac_distribution {
    const char *name, *arguments;
    size_t count;
    bool bare[3]; ///< an argument that is a bare number
    double (*at)(const double *given, double share);
    const char *(*wrong)(const double *given); ///< NULL: nothing
} lac_distribution;

/// A design: how many members, and where they lie in the unit cube.
typedef struct lac_design {
    const char *name;
    size_t (*members)(const lac_sweep *sweep, size_t asked);
    lac_status (*fill)(lac_sweep *sweep, lac_error *err);
} lac_design;

extern const lac_distribution lac_distributions[];
extern const lac_design lac_designs[];
