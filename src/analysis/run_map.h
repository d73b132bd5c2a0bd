/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/slip_blocks.h"
#include "base/archive.h"
#include "rg/rg_study.h"

enum { LAC_RUN_MAP_STATES = 64 };

/// Pairs (s_l, s_{l+1}) of a run, taken when the slip fraction first comes to each 1/64.
typedef struct lac_run_map {
    size_t levels; ///< pairs a state, at most
    const lac_hierarchy *h;
    size_t states;                        ///< taken so far
    size_t reached;                       ///< 64ths that have been
    size_t first[LAC_RUN_MAP_STATES + 1]; ///< pair of each state
    double *s, *s_next;                   ///< [64 levels]
} lac_run_map;

lac_status lac_run_map_create(const lac_hierarchy *h, lac_run_map *out, lac_error *err);
void lac_run_map_clear(lac_run_map *map);

/// Takes the pairs of levels with 8 blocks at least, where it is time to.
void lac_run_map_evaluate(lac_run_map *map, const lac_slip_blocks *blocks);

/// Passes the pairs taken so far.
void lac_run_map_serialize(lac_run_map *map, lac_archive *archive);

/// Fits the map, its intervals by resampling stretches of four states: neighbouring states of one
/// run hang together.
lac_status lac_run_map_fit(const lac_run_map *map, lac_rg_fit *fit, lac_error *err);
