/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_ACCURACY_H
#define LACUNA_ACCURACY_H

#include "lacuna/linkage.h"
#include "lacuna/trade.h"

LAC_BEGIN_C

/// What an accuracy is held to.
typedef enum lac_accuracy_of {
    LAC_ACCURACY_FAILURE = 0, ///< time of failure
    LAC_ACCURACY_STOP,        ///< time at which a limit of time.stop_when is reached
    LAC_ACCURACY_SLIP,        ///< mean slip at the end
} lac_accuracy_of;

/// Settings that pilot runs picked, and what these say of them.
typedef struct lac_accuracy_pick {
    double asked, estimated; ///< relative errors
    lac_accuracy_of of;
    double rtol;
    lac_method method;
    lac_formulation formulation;
    int64_t pilots, evaluations; ///< runs made to find out, and what they took
} lac_accuracy_pick;

/// What it is held to, in words.
const char *lac_accuracy_of_name(lac_accuracy_of of);

/// Picks rtol for c->accuracy, and the method and formulation that the case leaves open, by runs of
/// the scene itself: ever tighter ones, until what a decade of rtol changes says how good the
/// tightest is; of all that are close enough to that one the one with the least work is picked.
/// Work is counted, not timed, so that the same case has the same pick. docs/trade.md.
/// @param scene  made from `c`; renewed with the settings picked
/// @param c      gets the settings; its accuracy is then NaN and LAC_BEYOND_ACCURACY cleared
/// @param how    interrupted, progress and context are passed to the runs; NULL: none
/// @return LAC_OK; LAC_ENUMERIC where no tolerance does; LAC_EINTERRUPT; as lac_scene_renew
/// @cost   some four times the run picked
lac_status lac_accuracy_choose(lac_scene *scene, lac_case *c, const lac_run_def *how,
                               lac_accuracy_pick *out, lac_error *err);

LAC_END_C

#endif
