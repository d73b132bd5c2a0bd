/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/dataset.h"
#include "sweep/answers.h"
#include "sweep/sweep.h"

enum { LAC_MEMBER_RECORDS = 61, LAC_MEMBER_MESSAGE = 200 };

/// What came of a member: plain memory, that a process hands on as it is.
typedef struct lac_member {
    bool done, failed;
    int end;                                       ///< lac_end
    double failure_time, time;                     ///< [s]; NaN: did not fail
    double mean_slip, max_slip_rate, least_safety; ///< [m], [m/s], [1]
    double steps;
    char message[LAC_MEMBER_MESSAGE]; ///< why it broke; "": it did not
    float rate[LAC_MEMBER_RECORDS];   ///< mean slip rate at even times from 0 to the case's end
                                    ///< [m/s]; infinite after failure, NaN: not known
} lac_member;

/// Runs a member: the case with what the user sets, and with the member's values.
/// @param set  [count] overrides of all members
/// @return LAC_OK, also of a member that breaks; LAC_EINTERRUPT; LAC_ENOMEM
lac_status lac_member_run(const lac_sweep *sweep, size_t member, const char *path,
                          const lac_override *set, size_t count, lac_member *out, lac_error *err);

/// All members and what they say.
typedef struct lac_ensemble {
    const char *design, *varied; ///< keys, ", " between them
    double end;                  ///< [s] of the case
    size_t params, members;
    const char **key, **unit;         ///< [params]
    double *drawn;                    ///< [params][members] SI
    double *result, *followed;        ///< [members] as lac_sample has them
    double place[LAC_MEMBER_RECORDS]; ///< of records [s]
    float *rate;                      ///< [members][LAC_MEMBER_RECORDS]
    lac_sample sample;
    lac_answers *answers;
    lac_member *member; ///< [members]; NULL: read from a file
    const lac_sweep *sweep;
    char *texts; ///< that keys and units point into, of a file
} lac_ensemble;

/// Of members that are done. @param by  as lac_sample
lac_status lac_ensemble_create(const lac_sweep *sweep, lac_member *member, double end, double by,
                               lac_ensemble **out, lac_error *err);

/// From the file of a sweep.
lac_status lac_ensemble_read(const char *path, double by, lac_ensemble **out, lac_error *err);

/// Whether a file is that of a sweep.
bool lac_ensemble_is(const char *path);

void lac_ensemble_free(lac_ensemble *ensemble);

/// Its file and JSON.
lac_status lac_ensemble_describe(const lac_ensemble *ensemble, lac_dataset **out, lac_error *err);
