/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/keep.h"
#include "cli/common/pool.h"
#include "sweep/ensemble.h"

/// Members of a sweep, made in processes, each kept as soon as it is there.
typedef struct cli_members {
    lac_sweep *sweep;
    size_t n;
    const size_t *index; ///< [n] which of the sweep, ascending; borrowed
    lac_member **member; ///< [n] NULL: not made; owned, lac_ensemble_create takes them over
    cli_progress progress;
    cli_keep keep;
    cli_pool pool; ///< its `jobs` is set by whoever asks
    size_t next;
} cli_members;

/// Makes them. Those of which the process broke down are broken members too, which --resume makes
/// again.
/// @param m        `sweep`, `n`, `index` and `pool.jobs` set; cleared by cli_members_clear
/// @param request  with --resume goes on from those that are kept; where none are it begins
/// @param path     of the output, beside which they are kept
/// @return LAC_OK; LAC_EINPUT where the members kept there are of another sweep, or another one is
///         at work; LAC_EIO; LAC_EINTERRUPT; LAC_ENOMEM
lac_status cli_members_make(cli_members *m, const cli_request *request, const char *path,
                            lac_error *err);

/// Frees the members, and closes what they are kept in. @param written  the output is: all of it is
/// taken away
void cli_members_clear(cli_members *m, bool written);
