/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/keep.h"
#include "cli/common/pool.h"
#include "trade/trade.h"

/// Everything that a trade holds.
typedef struct cli_trade_job {
    const cli_request *request;
    lac_case *source;
    const char *fidelity; ///< of all runs that do not turn it; NULL: as the case says
    lac_trade trade;
    lac_trade_request ask;
    cli_progress progress;
    char *path;    ///< of the results
    cli_keep keep; ///< runs that are done, until they are written
    cli_pool pool; ///< in which they are made
    double started;
} cli_trade_job;

/// The case of a run.
/// @return as lac_case_read; LAC_EINPUT with the first thing that is wrong
lac_status cli_trade_case(const cli_trade_job *job, const lac_trade_run *run, lac_case **c,
                          lac_error *err);

/// Takes a run over that an earlier trade has kept; a cli_keep_take of the job.
void cli_trade_take_over(void *context, uint64_t key, const void *content);

/// One fidelity for all runs that do not turn it, where the case leaves it open: errors are those
/// against a reference of the same. A scene that cannot be made is told by its run.
void cli_trade_settle(cli_trade_job *job);

/// Makes the runs that are pending.
/// @return LAC_OK; LAC_EINTERRUPT; LAC_EIO
lac_status cli_trade_run(cli_trade_job *job, lac_error *err);
