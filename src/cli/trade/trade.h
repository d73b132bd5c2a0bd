/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "cli/common/progress.h"
#include "trade/trade.h"

/// Everything that a trade holds.
typedef struct cli_trade_job {
    const cli_request *request;
    lac_case *source;
    lac_trade trade;
    lac_trade_request ask;
    cli_progress progress;
    char *path, *folder; ///< of the results; of what is kept until they are written
    int kept;            ///< the file of runs that are done; -1: none
    int jobs;            ///< runs at a time at most
    double started;
} cli_trade_job;

/// The case of a run.
/// @return as lac_case_read; LAC_EINPUT with the first thing that is wrong
lac_status cli_trade_case(const cli_trade_job *job, const lac_trade_run *run, lac_case **c,
                          lac_error *err);

/// Opens the folder of what is kept; with --resume what is there is taken over.
/// @return LAC_OK; LAC_EIO; LAC_EINPUT where another trade is at work there
lac_status cli_trade_keep_open(cli_trade_job *job, lac_error *err);

/// Adds a run that is done.
lac_status cli_trade_keep(const cli_trade_job *job, const lac_trade_run *run, lac_error *err);

/// Closes the folder. @param remove  takes it away with all that is in it
void cli_trade_keep_close(cli_trade_job *job, bool remove);

/// Makes the runs that are pending.
/// @return LAC_OK; LAC_EINTERRUPT; LAC_EIO
lac_status cli_trade_run(cli_trade_job *job, lac_error *err);
