/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "rg/rg.h"

/// A joint as the cascade needs it.
typedef struct lac_rg_joint {
    const lac_domain *domain;
    const double *strength;          ///< [n] f p [Pa]
    const double *drop;              ///< [n] (1 - beta) f p [Pa]
    const lac_rg_path *path;         ///< how the shear force grows
    const lac_rg_resolve_def *press; ///< solved again for the critical force of each place; NULL:
                                     ///< that of the path
} lac_rg_joint;

/// How an ensemble of joints is studied.
typedef struct lac_rg_study_def {
    lac_rg_rule rule;
    size_t places;      ///< of the grid of blocks on each joint, at random, averaged; the first is
                        ///< the grid's own
    size_t loads;       ///< Q/Q_nom from 1/loads to 1, evenly; along a path that begins loaded
                        ///< (lac_rg_path_further) from its start to its end
    size_t resamplings; ///< of the bootstrap
    uint64_t seed;      ///< of places and bootstrap
    size_t first;       ///< joints of the ensemble before the first one, studied elsewhere
} lac_rg_study_def;

/// FIX, 16 places, 60 loads, 400 resamplings, seed 1, first 0.
lac_rg_study_def lac_rg_study_default(void);

/// A value, its standard error and its 95 % interval, by bootstrap over joints, over places where
/// there is one joint; NaN where too few of the resamplings have one.
typedef struct lac_rg_estimate {
    double value, error, low, high;
} lac_rg_estimate;

/// The renormalization map s' = S(s) of the slipped fraction from a level to the next, fitted by
/// logit s' = lambda logit s + g, so that S(0) = 0 and S(1) = 1.
typedef struct lac_rg_map {
    size_t points;      ///< pairs (s, s') with both between 0.05 and 0.95
    double lambda;      ///< slope at the fixed point, in logits as in s [1]
    double g;           ///< [1]
    double fixed_point; ///< C, the unstable one [1]; NaN where lambda is not > 1
    double nu;          ///< exponent of the correlation length, ln 2 / ln lambda; NaN likewise
    double residual;    ///< rms of the fit, in logits
} lac_rg_map;

/// Fits the map to pairs (s, s').
lac_status lac_rg_map_fit(size_t n, const double *s, const double *s_next, lac_rg_map *map,
                          lac_error *err);

/// A map fitted to groups of pairs, with the intervals that resampling the groups gives.
typedef struct lac_rg_fit {
    lac_rg_map map;
    lac_rg_estimate fixed_point, lambda, nu;
} lac_rg_fit;

/// Fits the map to pairs in groups, group i from first[i] to first[i + 1]; groups are resampled.
/// Too few pairs give NaN.
lac_status lac_rg_map_resample(size_t groups, const size_t *first, const double *s,
                               const double *s_next, size_t resamplings, uint64_t seed,
                               lac_rg_fit *fit, lac_error *err);

/// A power law xi ~ (1 - Q/Q_crit)^-exponent, or none.
typedef struct lac_rg_power {
    size_t points;
    double exponent, error; ///< NaN where fewer than four points
    double curvature;       ///< of ln xi against ln(1 - Q/Q_crit), over its standard error
    bool holds;             ///< xi grows by a factor of 4 at least, straight within two errors
} lac_rg_power;

/// Results of a study. Levels: 0 the cells ... levels the joint.
typedef struct lac_rg_result {
    size_t joints, places, levels, loads;
    double critical;       ///< Q_crit/Q_nom, mean over joints and places [1]
    double critical_sd;    ///< standard deviation among joints; among places where there is one
    double critical_error; ///< of the mean: sd/sqrt(joints), or /sqrt(places) where there is one
    double *of_joint;      ///< [joints] Q_crit/Q_nom of each, mean over places
    double place_sd;       ///< standard deviation among the places of a joint, mean over joints
    lac_rg_fit fit;        ///< of all pairs of levels with 8 blocks at least
    lac_rg_power cluster_law, block_law; ///< of the two correlation lengths below
    double *load;                        ///< [loads] Q/Q_nom
    double *fraction;                    ///< [loads * (levels + 1)] N_slip/N_tot, mean
    double *cluster;    ///< [loads] longer side of the largest slipped cluster [m], mean
    double *block;      ///< [loads] side of the largest block slipped as a whole [m], mean
    double *blocks;     ///< [levels + 1] N_tot, mean
    double *slipping;   ///< [levels + 1] N_slip at Q_crit, just before the joint slides, mean
    double *begin;      ///< [levels + 1] N_slip where a path begins loaded, mean; of the root: the
                        ///< share of joints and places that slide there; else 0
    lac_rg_sizes *size; ///< [levels + 1] mean over joints and places
    double *cell_load;  ///< [n of the last joint] first load at which each cell has slipped [1]
    double *own_level;  ///< [n of the last joint] level of the largest block around each cell that
                        ///< slips by itself where a path begins loaded; NaN: none
    size_t last_n;      ///< n of the last joint
} lac_rg_result;

/// One interface of the ensemble.
typedef struct lac_rg_interface {
    int64_t seed;            ///< INT64_MIN where it depends on none
    double pressure;         ///< mean over the nominal area, as given or as found [Pa]
    double contact_fraction; ///< [1]
    double dimension;        ///< D_box [1]; NaN where it was not counted
    double dyadic;           ///< dimension of the grid's own blocks [1], lac_dyadic
} lac_rg_interface;

/// An ensemble under study: joints are added one after the other.
typedef struct lac_rg_study lac_rg_study;

lac_status lac_rg_study_create(const lac_rg_study_def *def, lac_rg_study **out, lac_error *err);

/// Lets the cascade run on one joint, its places shared among the threads; the results do not
/// depend on how many these are.
lac_status lac_rg_study_add(lac_rg_study *study, const lac_rg_joint *joint, lac_error *err);

/// What a study of one joint holds of it, in plain memory, for lac_rg_study_take in a study of all,
/// maybe of another process: all but cell_load and own_level.
/// @param part  [lac_rg_study_part_size]
void lac_rg_study_give(const lac_rg_study *study, void *part);
size_t lac_rg_study_part_size(const lac_rg_study_def *def, const lac_grid *grid);

/// Adds a joint that another study gave, one of as many levels, places and loads: to the bit as
/// lac_rg_study_add of it, but for cell_load and own_level, which stay those of the joint before.
lac_status lac_rg_study_take(lac_rg_study *study, const lac_grid *grid, const void *part,
                             lac_error *err);

/// Statistics of what was added.
/// @param result  freed with the study
lac_status lac_rg_study_finish(lac_rg_study *study, const lac_rg_result **result, lac_error *err);
void lac_rg_study_free(lac_rg_study *study);
