/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "simulation/branch.h"
#include "simulation/simulation.h"

/// Picks rtol for c->accuracy, and the method and formulation that the case leaves open, by runs of
/// the scene itself: ever tighter ones, until what a decade of rtol changes says how good the
/// tightest is; of all that are close enough to that one the one with the least work is picked.
/// Work is counted, not timed, so that the same case has the same pick. docs/trade.md.
/// @param scene  made from `c`; renewed with the settings picked
/// @param c      gets the settings; its accuracy is then NaN
/// @return LAC_OK; LAC_ENUMERIC where no tolerance does; LAC_EINTERRUPT; as lac_scene_renew
/// @cost   some four times the run picked
lac_status lac_accuracy_choose(lac_scene *scene, lac_case *c, const lac_simulation_options *options,
                               lac_accuracy_pick *out, lac_error *err);

/// The indicators that a case names, for the run of its scene, which must outlive them.
/// @param out  NULL where the case names none
/// @return as lac_scene_rg_run
/// @cost   that of the cascade where `rg` has no critical_fraction given; else O(n)
lac_status lac_indicators_create(const lac_scene *scene, lac_analysis **out, lac_error *err);
