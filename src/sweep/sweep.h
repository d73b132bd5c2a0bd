/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"

/// What is varied, and which members there are.
typedef struct lac_sweep_def {
    const lac_override *over; ///< [count] key and values: "a, b", "1:100", "uniform(1 cm, 5 cm)"
    size_t count;
    const char *design; ///< NULL: grid where all values are lists, else random
    size_t members;     ///< 0: as many as the lists make, else 100
    uint64_t seed;
} lac_sweep_def;

enum { LAC_SWEEP_TEXT = 64 }; ///< bytes of one value

/// A parameter: keys that take one value together.
typedef struct lac_sweep_param {
    char *key;                                   ///< as given: keys between '+'
    char *name;                                  ///< of its variable in a file
    const char *unit;                            ///< SI
    const struct lac_distribution *distribution; ///< NULL: a list
    double given[3], own;                        ///< of the distribution; the case's own value
    size_t values;
    char (*text)[LAC_SWEEP_TEXT]; ///< [values]
    double *number;               ///< [values] SI; its place where it is no number
} lac_sweep_param;

typedef struct lac_sweep {
    const struct lac_design *design;
    size_t params, members;
    uint64_t seed;
    lac_sweep_param *param; ///< [params]
    double *place;          ///< [params][members] in (0, 1); NaN: the case's own value
} lac_sweep;

/// Reads what is varied against the case, and draws all members.
/// @return LAC_OK; LAC_EINPUT (a key, a value, a design); LAC_ENOMEM
lac_status lac_sweep_create(const lac_case *c, const lac_sweep_def *def, lac_sweep **out,
                            lac_error *err);
void lac_sweep_free(lac_sweep *sweep);

/// Value of a parameter of a member [SI].
double lac_sweep_value(const lac_sweep *sweep, size_t member, size_t param);

/// The same as an override has it. @return NULL: the case's own
const char *lac_sweep_text(const lac_sweep *sweep, size_t member, size_t param,
                           char room[LAC_SWEEP_TEXT]);

/// Name of the design.
const char *lac_sweep_design(const lac_sweep *sweep);
