/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/dataset.h"
#include "lacuna/simulation.h"
#include "run/run.h"

/// What is put out at the moment; the variables of a run are laid on it.
typedef struct lac_run_place {
    lac_run_output of;        ///< asked only while the dataset is made and for what does not grow
    double apparent_friction; ///< Q/P [1]
    lac_record record;
    lac_snapshot snapshot;
    lac_event event;
    const double *once; ///< values of the extras over nothing; NULL: none yet
} lac_run_place;

/// The variables of a run: of its records along `time`, of its `snapshot`s, its `event`s and what
/// does not change; docs/format.md.
/// @param place  its `of` is set; outlives the dataset
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_run_describe(const lac_run_place *place, lac_dataset **out, lac_error *err);

/// Adds the components that a run of slip in two directions puts out; of others nothing.
lac_status lac_run_describe_components(lac_dataset *d, const lac_run_place *place, lac_error *err);

/// A record becomes what is put out.
void lac_run_place_record(lac_run_place *place, const lac_record *record);

/// The index-th variable of all records; NULL: there is none.
const lac_variable *lac_run_column(size_t index);

/// How a run ended.
typedef struct lac_run_ending {
    const lac_run_result *result; ///< NULL: not known
    const char *status;           ///< complete, failed, interrupted
    bool dated;
    double start_date;     ///< seconds since 1970 of t = 0
    double wall_time, now; ///< [s] that it took; since 1970 of its begin
} lac_run_ending;

/// The same as a dataset: attributes that its file gets last.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_run_ending_describe(const lac_run_ending *ending, lac_dataset **out, lac_error *err);
