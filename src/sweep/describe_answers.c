// SPDX-License-Identifier: GPL-3.0-or-later
// What an ensemble says, as tables: the variables of its file and the `answers` of its JSON.
#include "data/describe.h"
#include "sweep/answers.h"

#define A(kind, field) LAC_HELD(kind, lac_answers, field)
#define C(kind, field) LAC_HELD(kind, lac_chance, field), .flags = LAC_MISSING
#define Q(kind, field) LAC_HELD(kind, lac_quantile_answer, field), .flags = LAC_MISSING
#define I(kind, field) LAC_HELD(kind, lac_influence, field), .flags = LAC_MISSING
#define S(kind, field) LAC_HELD(kind, lac_swing, field), .flags = LAC_MISSING
#define NEVER(name, declared, value) LAC_GETTER(double, name, declared, isinf(value) ? 1.0 : 0.0)
#define TRUTH(getter) G(getter), .flags = LAC_WHOLE | LAC_TRUTH

NEVER(quantile_never, const lac_quantile_answer *q = of, q->value)
NEVER(high_never, const lac_quantile_answer *q = of, q->high)
NEVER(low_stays, const lac_swing *s = of, s->result_low)
NEVER(high_stays, const lac_swing *s = of, s->result_high)
NEVER(base_stays, const lac_answers *a = of, a->base)

static const lac_variable of_answers[] = {
    {.json = "answers/result", A(TEXT, name)},      {.json = "answers/unit", A(TEXT, unit)},
    {.json = "answers/members", A(COUNT, members)}, {.json = "answers/broken", A(COUNT, broken)},
    {.json = "answers/never", A(COUNT, never)},     {.json = "answers/counted", A(COUNT, counted)},
    {.json = "answers/about", A(TEXT, about)},      {.json = "answers/missing", A(COUNT, missing)},
};

static const lac_variable of_chance[] = {
    {.json = "answers/probability/by", C(REAL, by)},
    {.json = "answers/probability/share", C(REAL, share)},
    {.json = "answers/probability/low", C(REAL, low)},
    {.json = "answers/probability/high", C(REAL, high)},
    {.json = "answers/probability/known", C(COUNT, known)},
    {.json = "answers/probability/unknown", C(COUNT, unknown)},
    {.json = "answers/probability/failed", C(COUNT, failed)},
};

static const lac_variable of_course[] = {
    {.name = "answer_time",
     .json = "answers/probability_over_time[]/by",
     .unit = "s",
     .long_name = "time that a probability of failure is by",
     LAC_HELD(REAL, lac_chance, by)},
    {.name = "failure_probability",
     .json = "answers/probability_over_time[]/share",
     .long_name = "share of the members that has failed",
     C(REAL, share)},
    {.name = "failure_probability_low",
     .json = "answers/probability_over_time[]/low",
     .long_name = "its 95 % interval (Wilson), lower end",
     C(REAL, low)},
    {.name = "failure_probability_high",
     .json = "answers/probability_over_time[]/high",
     .long_name = "its 95 % interval (Wilson), upper end",
     C(REAL, high)},
};

static const lac_variable of_quantiles[] = {
    {.name = "quantile",
     .json = "answers/quantiles[]/share",
     .long_name = "share of the members below a quantile",
     LAC_HELD(REAL, lac_quantile_answer, share)},
    {.name = "failure_time_quantile",
     .json = "answers/quantiles[]/value",
     .unit = "s",
     .long_name = "time by which this share of the members has failed",
     .comment = "missing: more of them never fail",
     Q(REAL, value)},
    {.name = "failure_time_quantile_low",
     .json = "answers/quantiles[]/low",
     .unit = "s",
     .long_name = "order statistic below it with 97.5 %",
     .comment = "missing: too few members",
     Q(REAL, low)},
    {.name = "failure_time_quantile_high",
     .json = "answers/quantiles[]/high",
     .unit = "s",
     .long_name = "order statistic above it with 97.5 %",
     .comment = "missing: never, or too few members",
     Q(REAL, high)},
    {.json = "answers/quantiles[]/never", TRUTH(quantile_never)},
    {.json = "answers/quantiles[]/high_never", TRUTH(high_never)},
};

static const lac_variable of_influences[] = {
    {.name = "influence_parameter",
     .json = "answers/influences[]/parameter",
     .long_name = "parameters, the one that decides most first",
     LAC_HELD(TEXT, lac_influence, key)},
    {.name = "sobol_first",
     .json = "answers/influences[]/first",
     .long_name = "part of the variance that is owed to the parameter alone",
     I(REAL, first)},
    {.name = "sobol_first_error",
     .json = "answers/influences[]/first_error",
     .long_name = "its standard error, by bootstrap",
     I(REAL, first_error)},
    {.json = "answers/influences[]/first_low", I(REAL, first_low)},
    {.json = "answers/influences[]/first_high", I(REAL, first_high)},
    {.name = "sobol_total",
     .json = "answers/influences[]/total",
     .long_name = "the same with what it does through the others",
     .comment = "of a saltelli design",
     I(REAL, total)},
    {.name = "sobol_total_error",
     .json = "answers/influences[]/total_error",
     .long_name = "its standard error, by bootstrap",
     I(REAL, total_error)},
    {.json = "answers/influences[]/total_low", I(REAL, total_low)},
    {.json = "answers/influences[]/total_high", I(REAL, total_high)},
    {.name = "rank_correlation",
     .json = "answers/influences[]/rank_correlation",
     .long_name = "rank correlation of parameter and time of failure",
     I(REAL, rank)},
};

static const lac_variable of_whether[] = {
    {.json = "answers/influences_of_probability", A(BOOL, of_chance)},
    {.json = "answers/influence_rows", A(COUNT, rows)},
};

static const lac_variable of_base[] = {
    {.json = "answers/base", A(REAL, base)},
    {.json = "answers/base_never", TRUTH(base_stays)},
};

static const lac_variable of_swings[] = {
    {.name = "swing_parameter",
     .json = "answers/swings[]/parameter",
     .long_name = "parameters of the tornado, the widest swing first",
     LAC_HELD(TEXT, lac_swing, key)},
    {.json = "answers/swings[]/unit", LAC_HELD(TEXT, lac_swing, unit)},
    {.json = "answers/swings[]/low", S(REAL, low)},
    {.json = "answers/swings[]/low_word", S(TEXT, low_word)},
    {.json = "answers/swings[]/high_word", S(TEXT, high_word)},
    {.json = "answers/swings[]/high", S(REAL, high)},
    {.name = "swing_low",
     .json = "answers/swings[]/result_low",
     .unit = "s",
     .long_name = "time of failure with the parameter low",
     .comment = "missing: never",
     S(REAL, result_low)},
    {.name = "swing_high",
     .json = "answers/swings[]/result_high",
     .unit = "s",
     .long_name = "time of failure with the parameter high",
     .comment = "missing: never",
     S(REAL, result_high)},
    {.json = "answers/swings[]/low_never", TRUTH(low_stays)},
    {.json = "answers/swings[]/high_never", TRUTH(high_stays)},
};

lac_status lac_answers_add(const lac_answers *a, lac_dataset *dataset, lac_error *err)
{
    const size_t drawn = a->tornado ? 0 : a->params, swings = a->tornado ? a->params : 0;
    const lac_extent dims[] = {{"answer_time", a->tornado ? 0 : LAC_ANSWERS_TIMES},
                               {"quantile", a->tornado ? 0 : LAC_ANSWERS_QUANTILES},
                               {"influence", drawn},
                               {"swing", swings}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_answers, "", 0), a},
        {LAC_VARIABLES(of_chance, "", 0), a->tornado ? NULL : &a->chance},
        {LAC_VARIABLES(of_course, "answer_time", sizeof(lac_chance)), a->course},
        {LAC_VARIABLES(of_quantiles, "quantile", sizeof(lac_quantile_answer)), a->quantile},
        {LAC_VARIABLES(of_whether, "", 0), a->tornado ? NULL : a},
        {LAC_VARIABLES(of_influences, "influence", sizeof(lac_influence)), a->influence},
        {LAC_VARIABLES(of_base, "", 0), a->tornado ? a : NULL},
        {LAC_VARIABLES(of_swings, "swing", sizeof(lac_swing)), a->swing},
    };
    LAC_TRY_RETURN(lac_dataset_dims(dataset, dims, sizeof dims / sizeof *dims, err));
    return lac_dataset_add(dataset, laid, sizeof laid / sizeof *laid, err);
}
