/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "sweep/sweep.h"

struct lac_simulation_options;

/// What came of the members of a sweep.

enum { LAC_MEMBER_MESSAGE = 200, LAC_MEMBER_EXTRAS = 16 };
#define LAC_AS_THE_CASE "(as the case)"

/// How far a member is.
enum { LAC_MEMBER_PENDING = 0, LAC_MEMBER_DONE, LAC_MEMBER_BROKEN };

/// What came of one: plain memory without pointers. What is not known is NaN.
typedef struct lac_member {
    int64_t index;                 ///< in the sweep, from 0
    int32_t state;                 ///< LAC_MEMBER_*
    int32_t ended;                 ///< lac_end, one more than the last of them: broken
    double failure_time, end_time; ///< since the start [s]; NaN: it did not fail
    double mean_slip;              ///< at the end [m]
    double end_rate, max_rate;     ///< mean at the end, of any cell [m/s]
    double max_ratio;              ///< largest Q over f0 P
    double safety;                 ///< least factor of safety
    double events, steps;
    double b_value;                  ///< of the catalogue
    double balance_residual;         ///< worst
    double extra[LAC_MEMBER_EXTRAS]; ///< what indicators say once, in the ensemble's order
    char message[LAC_MEMBER_MESSAGE];
    float series[]; ///< [records]
} lac_member;

/// A parameter as the ensemble has it.
typedef struct lac_ensemble_param {
    char *key, *said, *unit;
    double *value; ///< [n] drawn; of words which of them, in the order of their appearance
    char **word;   ///< [n] LAC_AS_THE_CASE where it is not set; NULL: they are numbers
    char *words;   ///< owned, what `word` points to; NULL
} lac_ensemble_param;

typedef struct lac_ensemble_extra {
    char name[64], unit[32], long_name[160];
} lac_ensemble_extra;

/// A number of each member, by its name in the file.
typedef struct lac_ensemble_result {
    const char *name, *unit, *long_name; ///< borrowed from the table or the extras
    size_t offset;                       ///< of the double in a lac_member
    bool time;                           ///< of failure: one that is missing is later than all
} lac_ensemble_result;

/// Members of a sweep, all or a part, in the order of their numbers. All is owned.
typedef struct lac_ensemble {
    char *case_text, *title;
    char *files; ///< checksums of files that members read
    char *design, *series, mark[17], seed[24];
    double end;     ///< of the case [s]
    size_t members; ///< of the whole sweep
    size_t params, n, records, extras;
    lac_ensemble_param *param; ///< [params]
    lac_member **member;       ///< [n]
    double *place;             ///< [records]
    int axis;                  ///< lac_series_axis
    lac_ensemble_extra extra[LAC_MEMBER_EXTRAS];
    // For answers.
    double *drawn, *result, *followed; ///< [params][n], [n], [n], in one piece
    const char **key, **unit;          ///< [params], in one piece
    float *rate;                       ///< [n][records] infinite after failure
} lac_ensemble;

/// Bytes of a member of the sweep.
size_t lac_member_size(const lac_sweep *sweep);

/// A member of which nothing is known but that it is broken.
void lac_member_break(const lac_sweep *sweep, size_t index, lac_member *out);

/// Runs a member. One that breaks is a member too, with its message.
/// @param out  [lac_member_size]
/// @return LAC_OK; LAC_EIO (a file that the case reads); LAC_EINTERRUPT; LAC_ENOMEM
lac_status lac_member_run(lac_sweep *sweep, size_t index,
                          const struct lac_simulation_options *options, lac_member *out,
                          lac_error *err);

/// Makes the run of a member once more, into a file as `lacuna run` makes it: what the member is
/// from has every step of it, and no fields.
/// @return as lac_sweep_case, lac_simulation_create, lac_simulation_write
lac_status lac_member_write(lac_sweep *sweep, size_t index, const char *path,
                            const lac_write_options *how, lac_error *err);

/// An ensemble of members.
/// @param member  [n] each allocated; taken over, also where it fails
lac_status lac_ensemble_create(const lac_sweep *sweep, size_t n, lac_member **member,
                               lac_ensemble **out, lac_error *err);

/// Reads the file of an ensemble.
/// @return LAC_OK; LAC_EINPUT (it is no such file); LAC_EIO; LAC_ENOMEM
lac_status lac_ensemble_read(const char *path, lac_ensemble **out, lac_error *err);

/// Finds a result by its name.
/// @param name   NULL: the time of failure
/// @param extra  [extras]
/// @return LAC_OK; LAC_EINPUT, with the names that there are
lac_status lac_ensemble_result_find(const char *name, size_t extras,
                                    const lac_ensemble_extra *extra, lac_ensemble_result *out,
                                    lac_error *err);

/// All members of several parts of a sweep, which are emptied. Members that are in none, in two, or
/// of another sweep are refused.
/// @param part, path  [parts] paths for messages
lac_status lac_ensemble_gather(size_t parts, lac_ensemble **part, const char *const *path,
                               lac_ensemble **out, lac_error *err);

/// Whether a file is that of a sweep.
bool lac_ensemble_is(const char *path);

void lac_ensemble_free(lac_ensemble *ensemble);

/// The dataset that its file is written from; the ensemble must outlive it.
lac_status lac_ensemble_describe(const lac_ensemble *ensemble, const lac_answers *answers,
                                 lac_dataset **out, lac_error *err);

/// What answers are made from. It holds until the next is asked for, or the ensemble is freed.
/// @param of  of this ensemble
/// @param by  in its unit; NaN: of a time the end, else none
lac_status lac_ensemble_sample(lac_ensemble *ensemble, const lac_ensemble_result *of, double by,
                               lac_sample *out, lac_error *err);
