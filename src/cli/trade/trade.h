/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_TRADE_TRADE_H
#define LACUNA_CLI_TRADE_TRADE_H

#include <stdint.h>

#include "cli/common/options.h"
#include "cli/common/progress.h"
#include "trade/trade.h"

/// Settings of a run, as its case has them in the end.
typedef struct cli_trade_settings {
    uint64_t key;                          ///< of the whole resolved case and its files
    char label[LAC_DIALS][LAC_DIAL_LABEL]; ///< of every dial
} cli_trade_settings;

/// Everything that a trade holds.
typedef struct cli_trade_job {
    const cli_request *request;
    lac_case *source;
    lac_trade_plan plan;
    lac_trade_ask ask;
    lac_trade_measure *measure;   ///< [plan.runs]
    cli_trade_settings *settings; ///< [plan.runs]
    cli_trade_settings own;       ///< of the case as it is
    lac_trade_verdict verdict;
    cli_progress progress;
    char *path, *folder; ///< of the results; of what is kept until they are written
    int kept;            ///< the file of runs that are done; -1: none
    int jobs;            ///< runs at a time at most
    double started;
} cli_trade_job;

/// What a case is read for.
lac_case_purpose cli_trade_purpose(lac_trade_of of);

/// The case of a run of the plan.
/// @return as lac_case_read; LAC_EINPUT with the first thing that is wrong
lac_status cli_trade_case(const cli_trade_job *job, size_t run, lac_case **c, lac_error *err);

/// Looks up the settings of all runs; those that are refused or twice there are marked.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status cli_trade_resolve(cli_trade_job *job, lac_error *err);

/// Computes one run in this process.
/// @param file     of its output, which is written and removed
/// @param measure  end, values, output, steps, wall time, message
/// @return of the run, as lac_run: LAC_EIO is the disk's doing, not the settings'
lac_status cli_trade_compute(const cli_trade_job *job, size_t run, const char *file,
                             lac_trade_measure *measure);

/// Opens the folder of what is kept; with --resume what is there is taken over.
/// @return LAC_OK; LAC_EIO; LAC_EINPUT where another trade is at work there
lac_status cli_trade_keep_open(cli_trade_job *job, lac_error *err);

/// Adds a run that is done.
lac_status cli_trade_keep(cli_trade_job *job, size_t run, lac_error *err);

/// Closes the folder. @param remove  takes it away with all that is in it
void cli_trade_keep_close(cli_trade_job *job, bool remove);

/// Makes the runs that are pending.
/// @return LAC_OK; LAC_EINTERRUPT; LAC_EIO
lac_status cli_trade_run(cli_trade_job *job, lac_error *err);

/// The settings of a run that differ from the case's own, as `--set KEY=VALUE --set ...`; "" where
/// none do.
const char *cli_trade_options(const cli_trade_job *job, size_t run, char *text, size_t size);

/// What to choose, in one sentence.
const char *cli_trade_sentence(const cli_trade_job *job, char *text, size_t size);

/// The table and the sentence on stdout.
void cli_trade_print(const cli_trade_job *job);
void cli_trade_json(const cli_trade_job *job);

/// Writes the netCDF file.
/// @return as lac_store_dataset
lac_status cli_trade_store(const cli_trade_job *job, lac_error *err);

#endif
