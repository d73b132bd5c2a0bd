/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"
#include "sweep/answers.h"

/// A sweep: many runs of one case, its members, each with other values of some of its keys. What a
/// member is follows from the plan and its number alone, not from the others or the machine.

/// What is asked for. Texts are borrowed.
typedef struct lac_sweep_request {
    const char *path;              ///< of the case
    const lac_override *overrides; ///< [count] of all members
    size_t count;
    const char *const *over; ///< [varied] "friction.aging.dc=uniform(1 cm, 5 cm)"
    size_t varied;
    const char *table;  ///< CSV of what varies together, a row a member's; NULL: none
    const char *design; ///< NULL: grid, or random where something is drawn
    const char *series; ///< what is kept of each run: "time:50", "rate:2", "left:4"; NULL: the
                        ///< first
    int64_t members;    ///< 0: as many as the design makes
    uint64_t seed;
    double until; ///< an end before the case's [s]; NaN: none
    /// Checksums of the files that a case reads, a line each behind "files:". NULL: not told
    /// @return owned; NULL: no memory
    char *(*files)(const lac_case *c);
} lac_sweep_request;

/// One key that varies.
typedef struct lac_swept {
    char *key, *said;  ///< keys that take one value, + between them; "uniform(1 cm, 5 cm)"
    char unit[32];     ///< of its numbers
    bool number, word; ///< its values are numbers; the case takes it as a text only
    bool anew;         ///< the case is read anew with it: other values are made from it
    const struct lac_distribution *drawn; ///< NULL: a list
    double argument[3];
    size_t values; ///< of a list
    char **text;   ///< [values] owned
    double *value; ///< [values] NaN where it is no number
    size_t axis;   ///< that its position is along
} lac_swept;

/// Whatever draws a value from a number in (0, 1).
typedef struct lac_distribution {
    const char *name, *arguments, *doc; ///< "uniform", "low, high"
    size_t count;                       ///< of arguments
    bool last_plain;                    ///< the last one has no unit
    /// @return NULL, or what is allowed
    const char *(*wrong)(const double *argument);
    double (*value)(const double *argument, double u); ///< the inverse of its distribution
} lac_distribution;

enum { LAC_SWEEP_AXES = 128, LAC_SWEEP_KEY = 160 }; ///< at most; bytes of a key

struct lac_sweep;

/// A way to choose members.
typedef struct lac_design {
    const char *name, *doc;
    lac_sample_design sample;
    bool lists;   ///< every value of each list: nothing can be drawn
    bool once;    ///< just that many
    size_t fixed; ///< members are whole multiples of fixed + each * axes, plus
    size_t each;
    /// Places of a member along all axes. @param u  [axes] in (0, 1)
    void (*place)(const struct lac_sweep *sweep, size_t member, double *u);
} lac_design;

const lac_design *lac_design_get(size_t index);

/// What a sweep is; see lac_sweep_create.
typedef struct lac_sweep {
    lac_case *base;          ///< the case as it stands
    char *path, *text;       ///< of the base: its path, all of it resolved
    char *written;           ///< the same as it was written
    char *files;             ///< as in the request, of the base and of what is listed; ""
    lac_override *overrides; ///< [count] copies, and room for those of a member
    size_t count;
    char (*keys)[LAC_SWEEP_KEY]; ///< of those of a member
    const lac_design *design;
    size_t params, axes, members;
    lac_swept *param;  ///< [params]
    size_t *positions; ///< [axes] values along an axis of lists; 0: drawn
    double *points;    ///< [members or rows][width] of designs that are made at once; NULL
    size_t width;      ///< numbers of a point
    uint64_t seed;
    uint64_t mark;                    ///< of all that members follow from
    double until;                     ///< an end before the cases' [s]; NaN
    size_t extras;                    ///< what the case's indicators say once
    struct lac_ensemble_extra *extra; ///< [extras]
    // What is kept of each run.
    int series; ///< lac_series_axis
    size_t records;
    double *place;     ///< [records] time [s], slip rate [m/s], or time left [s]
    char *said;        ///< "time:50"
    lac_case *current; ///< the case of the last member; NULL
    char *current_words;
} lac_sweep;

typedef enum lac_series_axis {
    LAC_SERIES_TIME = 0, ///< slip rate at stated times
    LAC_SERIES_RATE,     ///< when a slip rate is first passed
    LAC_SERIES_LEFT,     ///< slip rate so long before failure
} lac_series_axis;

/// Plans a sweep.
/// @return LAC_OK; LAC_EINPUT (what is wrong with the case, a key, its values, the design or the
///         number of members); LAC_EIO; LAC_ENOMEM
lac_status lac_sweep_create(const lac_sweep_request *request, lac_sweep **out, lac_error *err);
void lac_sweep_free(lac_sweep *sweep);

/// The value of a parameter for a member: a number, of a list of words its place. NaN: as the case
/// has it, which has no number there.
double lac_sweep_value(const lac_sweep *sweep, size_t param, size_t member);

/// The same as a case has it: "0.02 m". @param text  room @return text, or the list's
const char *lac_sweep_text(const lac_sweep *sweep, size_t param, size_t member, char *text,
                           size_t room);

/// The case of a member, until the next is asked for.
/// @return as lac_case_read, lac_case_set
lac_status lac_sweep_case(lac_sweep *sweep, size_t member, const lac_case **c, lac_error *err);

/// One of the keys that take its value. @return false: there is none of that index
bool lac_swept_key(const lac_swept *param, size_t index, char key[LAC_SWEEP_KEY]);

/// A number and its unit, to the bit. @return text
const char *lac_swept_quantity(double value, const char *unit, char *text, size_t room);

// Of the module: what is said of values.
lac_status lac_swept_read(lac_swept *param, const char *said, lac_case *base, lac_error *err);
lac_status lac_swept_table(lac_sweep *sweep, const char *path, lac_error *err);
lac_status lac_sweep_arrange(lac_sweep *sweep, const lac_sweep_request *request, lac_error *err);
lac_status lac_sweep_sum_files(lac_sweep *sweep, char *(*sums)(const lac_case *c), lac_error *err);

/// The first file of one text of sums whose sum is not in another; NULL: none.
/// @param length  of its name
const char *lac_sweep_changed_file(const char *before, const char *now, int *length);

/// Whether the files that the members read are still what they were when the sweep was made.
/// @return LAC_EIO where one is not, which is named
lac_status lac_sweep_check_files(lac_sweep *sweep, char *(*sums)(const lac_case *c),
                                 lac_error *err);
