/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "model/problem.h"

typedef struct lac_run_def lac_run_def; // of run/run.h

/// One step of a way.
typedef struct lac_lump_stage {
    double time;           ///< its length [s]
    double slip;           ///< that, times the mean slip rate at its start [m]
    double start, slipped; ///< time and mean slip so far [s, m]
    bool whole;            ///< it ends where the loads break or the run ends
} lac_lump_stage;

/// How a way ends.
typedef enum lac_lump_arrival {
    LAC_LUMP_ON_ITS_WAY = 0,
    LAC_LUMP_AT_TIME,
    LAC_LUMP_AT_LIMIT, ///< of the mean slip, which may be that of failure
    LAC_LUMP_AT_FAILURE,
} lac_lump_arrival;

/// The steps that all cells took to the end of a run.
typedef struct lac_lump_way {
    lac_lump_stage *stage; ///< owned by the caller
    size_t count;
    lac_lump_arrival arrival;
    double value; ///< what they come to
    double apart; ///< of the last that followed, in their second half: the largest, over `value`
} lac_lump_way;

/// Goes to the end of a run by linearly implicit steps, one evaluation and one solve each, and says
/// what it comes to: the time of failure or of a limit, else the mean slip.
/// @param ends   end, failure_rate, failure_slip, stop_slip, stop_rate count
/// @param leads  its steps are chosen, and kept in `way`; else those of `way` are taken, as long by
///               slip where the end is not one of time
/// @param value  NaN: it comes to no such end, or to none
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_lump_walk(const lac_problem *problem, const lac_run_def *ends, bool leads,
                         lac_lump_way *way, double *value, lac_error *err);
