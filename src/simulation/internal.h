/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "simulation/branch.h"
#include "simulation/simulation.h"
#include "simulation/tape.h"

/// A pilot run that may be the run: what came out, and what it put out.
typedef struct lac_take {
    lac_run_result run;
    lac_analysis *analysis; ///< its indicators, summed up; NULL where the case names none
    lac_tape tape;
    bool whole; ///< false: the run has to be made again
} lac_take;

/// Frees what it holds; it is empty then.
void lac_take_clear(lac_take *take);

/// What pilot runs are made of.
typedef struct lac_accuracy_def {
    lac_scene *scene; ///< made from the case; renewed with the settings picked
    const lac_points *points;
    const lac_critical_fraction *critical; ///< for its indicators
    const lac_simulation_options *options;
} lac_accuracy_def;

/// Picks rtol for c->accuracy, and the method and formulation that the case leaves open, by runs of
/// the scene itself: a coarse one, and ever tighter ones until what has changed says that the last
/// is close enough, which is then the run. Work is counted, not timed, so that the same case has
/// the same pick. docs/trade.md.
/// @param c     gets the settings; its accuracy is then NaN
/// @param take  empty; the run with the settings picked, where it could be kept
/// @return LAC_OK; LAC_ENUMERIC where no tolerance does; LAC_EINTERRUPT; as lac_scene_renew
/// @cost   some two or three times the run picked, with it
lac_status lac_accuracy_choose(const lac_accuracy_def *def, lac_case *c, lac_accuracy_pick *out,
                               lac_take *take, lac_error *err);

/// What the indicators that a case names need to know before a run.
/// @return as lac_scene_rg_run
/// @cost   that of the cascade where `rg` has no critical_fraction given; else nothing
lac_status lac_indicators_prepare(const lac_scene *scene, lac_critical_fraction *critical,
                                  lac_error *err);

/// The indicators that a case names, for a run of its scene, which must outlive them.
/// @param critical  of lac_indicators_prepare
/// @param out       NULL where the case names none
/// @cost   O(n)
lac_status lac_indicators_create(const lac_scene *scene, const lac_critical_fraction *critical,
                                 lac_analysis **out, lac_error *err);
