/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_ANALYSIS_H
#define LACUNA_SCENE_ANALYSIS_H

#include "lacuna/analysis.h"
#include "lacuna/linkage.h"
#include "lacuna/scene_rg.h"

LAC_BEGIN_C

/// The indicators that a case names, for the run of its scene, which must outlive them.
/// @param watch  of the static cascade that `rg` starts from; NULL: not watched
/// @param out    NULL where the case names none
/// @return as lac_scene_rg_run
/// @cost   that of the cascade where `rg` has no critical_fraction given; else O(n)
lac_status lac_scene_analysis_create(const lac_scene *scene, const lac_rg_watch *watch,
                                     lac_analysis **out, lac_error *err);

LAC_END_C

#endif
