/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "rg/rg_study.h"

/// What one joint gave with its blocks at one place.
typedef struct lac_rg_sample {
    double critical;
    double *fraction;   ///< [loads * (levels + 1)]
    double *block;      ///< [loads] side of the largest block slipped as a whole [m]
    double *blocks;     ///< [levels + 1]
    double *slipping;   ///< [levels + 1]
    double *begin;      ///< [levels + 1]
    lac_rg_sizes *size; ///< [levels + 1]
} lac_rg_sample;

/// What one joint gave at its own place only.
typedef struct lac_rg_order {
    const lac_domain *domain;
    double *cell_load; ///< [n] the first load at which each cell has slipped in the end; NaN;
                       ///< holds the two below, too
    double *own_level; ///< [n] of the largest block around it that slips by itself where a loaded
                       ///< path begins; NaN
    double *cluster;   ///< [loads] longer side of the largest cluster of slipped cells [m]
    uint8_t *slipped;  ///< [n] scratch
    lac_domain part;   ///< scratch
} lac_rg_order;

lac_status lac_rg_order_create(const lac_domain *domain, size_t loads, lac_rg_order *order,
                               lac_error *err);

void lac_rg_order_clear(lac_rg_order *order);

/// @param order  NULL: not wanted
lac_status lac_rg_sample_take(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                              size_t dy, const double *load, lac_rg_order *order,
                              lac_rg_sample *out, lac_error *err);

/// The critical force of a sample on contacts that are solved for it, where the joint has them.
lac_status lac_rg_sample_solve(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                               size_t dy, lac_rg_sample *sample, lac_error *err);

/// Levels of the trees of a grid; one that is not periodic is laid into one twice as long.
size_t lac_rg_sample_levels(const lac_grid *grid);

/// Fits xi ~ (1 - load/critical)^-exponent below the critical load.
lac_rg_power lac_rg_power_fit(size_t n, const double *load, const double *xi, double critical);
