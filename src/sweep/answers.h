/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/dataset.h"

enum {
    LAC_ANSWERS_QUANTILES = 5, ///< 5, 25, 50, 75, 95 %
    LAC_ANSWERS_TIMES = 61     ///< of the chance over time
};

extern const double lac_answers_share[LAC_ANSWERS_QUANTILES];

/// How members were chosen, as far as answers differ by it.
typedef enum lac_sample_design {
    LAC_SAMPLE_DRAWN = 0, ///< each as likely as the others
    LAC_SAMPLE_SALTELLI,  ///< member r (params + 2) + k: k = 0 row r of A, 1 of B, 2 + p of A with
                          ///< parameter p of B
    LAC_SAMPLE_TORNADO    ///< member 0 the base, 1 + 2p and 2 + 2p parameter p low and high
} lac_sample_design;

/// What is asked about: numbers alone, so that it needs no run. Borrowed.
typedef struct lac_sample {
    size_t params, members;
    const double *drawn;    ///< [params][members]
    const double *result;   ///< [members] one number of each, as the time of failure; INFINITY: not
                            ///< within the time that it was followed; NaN: broken, or missing
    const double *followed; ///< [members] how long; NULL: long enough
    bool plain;             ///< the result is no time that is waited for: from the least to the
                            ///< largest, not from 0
    size_t missing;         ///< members that are not broken, and yet have no such number
    lac_sample_design design;
    double by;     ///< when chance and influences are asked for; NaN: as long as any was followed,
                   ///< of a plain result the largest
    uint64_t seed; ///< of the bootstrap
    /// A value that is a word. @return NULL: it is a number. NULL: all are
    const char *(*word)(const void *of, size_t param, size_t member);
    const void *of;
    const char *name, *unit, *about;          ///< of the result; NULL: not told
    const char *const *key, *const *key_unit; ///< [params] the same of the parameters; NULL
} lac_sample;

/// How likely the result is at most `by`. Members whose end is not known by then are neither.
typedef struct lac_chance {
    double by, share; ///< of those that are known
    double low, high; ///< 95 % interval of Wilson, as if all that are not known had not, or had
    size_t known, unknown, failed;
} lac_chance;

/// The value that a share of members is below; INFINITY: never.
typedef struct lac_quantile_answer {
    double share, value;
    double low, high; ///< order statistics that hold it with at least 95 %; NaN: too few members
} lac_quantile_answer;

/// What the variance of the result owes to a parameter. Where a member never fails, or a time is
/// asked for, it is the variance of whether a member fails by then.
typedef struct lac_influence {
    size_t param;
    const char *key;                                  ///< borrowed, as all texts; NULL
    double first, first_error, first_low, first_high; ///< alone; error: sd, low, high: 95 %
    double total, total_error, total_low, total_high; ///< with what it does through the others; NaN
                                                      ///< but of LAC_SAMPLE_SALTELLI
    double rank; ///< rank correlation (Spearman) with the result: > 0: more of it is later
} lac_influence;

/// What one parameter alone does to the result of the base.
typedef struct lac_swing {
    size_t param;
    const char *key, *unit;
    double low, high;                 ///< its values
    const char *low_word, *high_word; ///< the same as words; NULL: they are numbers
    double result_low, result_high;   ///< INFINITY: never; NaN: broken
    double swing; ///< from the least to the largest of these and the base's; INFINITY: from or to
                  ///< never
} lac_swing;

/// What an ensemble says of one result.
typedef struct lac_answers {
    const char *name, *unit, *about; ///< of the result
    bool plain;                      ///< as in the sample
    size_t params, members, broken, never;
    size_t missing; ///< members that have no such result, and are not broken
    size_t counted; ///< members that chance and quantiles are of: of Saltelli's design A and B
    bool tornado;   ///< it has swings, and neither chance nor quantiles nor influences
    bool of_chance; ///< influences are of whether, not of when
    bool alike;     ///< it is the same in all members, so that nothing decides
    size_t rows;    ///< of Saltelli's design that influences are of: none of its members is broken
    lac_chance chance, course[LAC_ANSWERS_TIMES];
    lac_quantile_answer quantile[LAC_ANSWERS_QUANTILES];
    lac_influence *influence; ///< [params] the strongest first
    double base;              ///< result of the tornado's base
    lac_swing *swing;         ///< [params] the widest first
} lac_answers;

/// Answers. Broken members are counted and left out. Shares have the interval of Wilson (1927),
/// quantiles that of order statistics (by the binomial distribution). Influences: of a
/// saltelli design first-order indices by Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018,
/// table 2 b, total ones by Jansen (1999), doi 10.1016/S0010-4655(98)00154-4, intervals by 500
/// bootstrap samples of its rows; else the part of the variance between members of equal (or, of
/// many values, neighbouring) values, less what chance gives it (epsilon squared, Kelley 1935); NaN
/// where fewer than two such groups, or no two members of one, leave nothing to compare.
/// @return LAC_OK; LAC_EINPUT (members that are no whole design); LAC_ENOMEM
/// @cost  500 members params
lac_status lac_answers_create(const lac_sample *sample, lac_answers **out, lac_error *err);
void lac_answers_free(lac_answers *answers);

/// Adds the tables of answers, which must outlive it, to a dataset: in JSON under `answers`.
/// @return as lac_dataset_add
lac_status lac_answers_add(const lac_answers *answers, lac_dataset *dataset, lac_error *err);

/// The chance by a time alone.
lac_chance lac_answers_chance(const lac_sample *sample, double by);

/// Quantiles of a series over the members at each record; values that are NaN are left out, of
/// INFINITY are above all.
/// @param series  [members][records]
/// @param use     [members] NULL: all
/// @param fan     [LAC_ANSWERS_QUANTILES][records] NaN: no member has a value
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_answers_fan(size_t members, size_t records, const float *series, const bool *use,
                           double *fan, lac_error *err);

/// Whether a member counts as drawn: not broken, and not one of the combined rows of a design.
bool lac_answers_counts(const lac_sample *sample, size_t member);

/// Fills influences, whether they are of a chance, and how many rows they are of.
/// @pre   the chance is known
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_influences_fill(const lac_sample *sample, lac_answers *answers, lac_error *err);
