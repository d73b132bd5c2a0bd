/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "sweep/sweep.h"

/// Members whose runs are kept whole, with their fields, beside the file of the sweep: of ENS.nc
/// ENS-member-I.nc. Tasks are those of a part of a sweep.
typedef struct cli_kept_runs {
    const cli_request *request;
    const char *path;        ///< of the sweep's file; borrowed
    size_t first, stride, n; ///< task k is member first + k stride
    bool *wanted;            ///< [n]; NULL: none is
} cli_kept_runs;

/// Reads --keep-fields, with the part set. @return LAC_OK; LAC_EINPUT; LAC_ENOMEM
lac_status cli_kept_runs_read(const lac_sweep *sweep, cli_kept_runs *runs, lac_error *err);

/// Sees that their files may be written. @return as cli_output_check
lac_status cli_kept_runs_check(const cli_kept_runs *runs, const lac_sweep *sweep, lac_error *err);

/// Whether the run of a task is asked for, and its file is not there.
bool cli_kept_runs_lacks(const cli_kept_runs *runs, size_t task);

/// Makes the run of a task that is asked for. @return LAC_OK; as lac_member_write
lac_status cli_kept_runs_write(const cli_kept_runs *runs, lac_sweep *sweep, size_t task,
                               lac_error *err);
