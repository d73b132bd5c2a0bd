/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "lacuna/simulation.h"
#include "scene/scene.h"
#include "store/past.h"

/// A run that goes on from another one, with what its case changes: initial.run.
typedef struct lac_branch {
    const lac_case *to;
    lac_case *source; ///< of the run that it goes on from
    lac_stored_past past;
    double time;          ///< at which [s]
    double from;          ///< of what the file keeps and is begun with: not later [s]
    size_t snapshot;      ///< that; SIZE_MAX: its checkpoint
    bool same, new_scene; ///< changes nothing of the motion; changes the transfer or the rock
    char *changes;        ///< "load.shear.0.ratio.value: 0.6 -> 0.5; ..."; "" where nothing is
    char sum[17];         ///< of the text of the source's case, FNV-1a in hexadecimals
    lac_run_start start;
    char text[800]; ///< in words, as far as it has come
} lac_branch;

/// Reads the other run, finds where to begin, and sees what the case changes.
/// @param c    gets the fidelity of the other run where it leaves that open and takes it
/// @param out  to be freed; its words say what would be done
/// @return LAC_OK; LAC_EINPUT (what may not change, no state to go on from, a time that is not
///         there); LAC_EIO; LAC_ENOMEM
lac_status lac_branch_open(lac_case *c, lac_branch **out, lac_error *err);

/// Comes to the time of the branch under the loads of the other run.
/// @param options  its `interrupted` and `progress` are asked and told
/// @param scene    of the branch's case; freed by the caller, whatever the status
/// @return also LAC_ENUMERIC where the other run breaks on the way, LAC_EINTERRUPT
lac_status lac_branch_reach(lac_branch *branch, const lac_simulation_options *options,
                            lac_scene **scene, lac_error *err);

void lac_branch_free(lac_branch *branch);
