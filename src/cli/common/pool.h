/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/progress.h"

/// Tasks in processes: a task that breaks down takes nothing with it but its own result. Either
/// each task has a process of its own, whose memory, CPU time and limit are then the task's; or
/// workers make many, one after the other, where a task costs little more than a process would.

enum { CLI_POOL_JOBS = 64 };
#define CLI_POOL_NONE SIZE_MAX

/// How a task came to its end.
typedef struct cli_pool_end {
    bool answered;   ///< else it broke down with its process
    int signal;      ///< that ended its process; 0: none
    double cpu_time; ///< of its process [s]; NaN: of a worker that goes on
    double memory;   ///< peak of its process so far [bytes]
} cli_pool_end;

/// What is to be done, and how far it is.
typedef struct cli_pool {
    const char *what; ///< the tasks, as progress and messages call them: "members"
    size_t total;     ///< tasks, for progress
    size_t done;      ///< of them; may begin above 0, and a hook may count what needs no process
    size_t size;      ///< of a result [bytes]
    int jobs;         ///< processes at a time, 1 to CLI_POOL_JOBS
    bool fresh;       ///< a process a task; else workers
    int journal;   ///< file of a cli_keep, which processes close: its lock is not theirs; -1: none
    double memory; ///< peak of the largest process so far [bytes]; 0: the first one is alone,
                   ///< and tells
    cli_progress *progress;
    void *context;
    /// The next task, which it counts as given out; CLI_POOL_NONE: none, or none before another is
    /// done.
    size_t (*next)(void *context);
    /// Makes a task, in its process. The result is plain memory without pointers, zeros before the
    /// first task. A task that failed is a result too: any status but LAC_OK ends the whole pool.
    /// What the caller holds is as it was when the process began, some tasks ago.
    lac_status (*work)(void *context, size_t task, void *result, lac_error *err);
    /// Takes a result over, as soon as it is there, in any order. @param result  NULL: not answered
    lac_status (*take)(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err);
    /// CPU time after which a process ends by SIGXCPU [s], infinite: never. NULL: no limit; of
    /// `fresh` only.
    double (*limit)(void *context, size_t task);
} cli_pool;

/// Makes tasks until `next` has none and all are taken over. Shows progress with the time left.
/// Fewer than `jobs` run where memory is short. A worker that breaks down is begun again after its
/// task. No threads of OpenMP may have been begun before: a child would wait for them.
/// @return LAC_OK; LAC_EINTERRUPT after SIGINT or SIGTERM; LAC_EIO where no process can be begun;
/// as
///         `work` and `take`. No process is left in any case.
lac_status cli_pool_run(cli_pool *ask, lac_error *err);

/// Reads --jobs. @param text  NULL: as many as there are processors for this one
/// @return LAC_OK; LAC_EINPUT
lac_status cli_pool_jobs(const char *text, int *jobs, lac_error *err);

/// Threads of a command whose tasks wait for one another too often for processes: of --jobs, else
/// of
/// --threads, else one.
/// @return LAC_OK; LAC_EINPUT
lac_status cli_pool_threads(const cli_request *request, int *threads, lac_error *err);

/// How a task ended that did not answer: "ended by signal 9: Killed".
void cli_pool_reason(const cli_pool_end *end, char *text, size_t room);
