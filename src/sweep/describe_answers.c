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

// A row of the file and of JSON: its path below `answers`, and what it is.
#define BOTH(path, name_, unit_, title, ...)                                             \
    {                                                                                    \
        .json = "answers/" path, .name = (name_), .unit = (unit_), .long_name = (title), \
        __VA_ARGS__                                                                      \
    }
#define IN_JSON(path, ...)                   \
    {                                        \
        .json = "answers/" path, __VA_ARGS__ \
    }

static const lac_variable of_answers[] = {
    IN_JSON("result", A(TEXT, name)),      IN_JSON("unit", A(TEXT, unit)),
    IN_JSON("members", A(COUNT, members)), IN_JSON("broken", A(COUNT, broken)),
    IN_JSON("never", A(COUNT, never)),     IN_JSON("counted", A(COUNT, counted)),
    IN_JSON("about", A(TEXT, about)),      IN_JSON("missing", A(COUNT, missing)),
};

static const lac_variable of_chance[] = {
    IN_JSON("probability/by", C(REAL, by)),
    IN_JSON("probability/share", C(REAL, share)),
    IN_JSON("probability/low", C(REAL, low)),
    IN_JSON("probability/high", C(REAL, high)),
    IN_JSON("probability/known", C(COUNT, known)),
    IN_JSON("probability/unknown", C(COUNT, unknown)),
    IN_JSON("probability/failed", C(COUNT, failed)),
};

#define COURSE "probability_over_time[]/"
static const lac_variable of_course[] = {
    BOTH(COURSE "by", "answer_time", "s", "time that a probability of failure is by",
         LAC_HELD(REAL, lac_chance, by)),
    BOTH(COURSE "share", "failure_probability", NULL, "share of the members that has failed",
         C(REAL, share)),
    BOTH(COURSE "low", "failure_probability_low", NULL, "its 95 % interval (Wilson), lower end",
         C(REAL, low)),
    BOTH(COURSE "high", "failure_probability_high", NULL, "its 95 % interval (Wilson), upper end",
         C(REAL, high)),
};

#define QUANTILES "quantiles[]/"
static const lac_variable of_quantiles[] = {
    BOTH(QUANTILES "share", "quantile", NULL, "share of the members below a quantile",
         LAC_HELD(REAL, lac_quantile_answer, share)),
    BOTH(QUANTILES "value", "failure_time_quantile", "s",
         "time by which this share of the members has failed", Q(REAL, value),
         .comment = "missing: more of them never fail"),
    BOTH(QUANTILES "low", "failure_time_quantile_low", "s", "order statistic below it with 97.5 %",
         Q(REAL, low), .comment = "missing: too few members"),
    BOTH(QUANTILES "high", "failure_time_quantile_high", "s",
         "order statistic above it with 97.5 %", Q(REAL, high),
         .comment = "missing: never, or too few members"),
    IN_JSON(QUANTILES "never", TRUTH(quantile_never)),
    IN_JSON(QUANTILES "high_never", TRUTH(high_never)),
};

#define INFLUENCES "influences[]/"
static const lac_variable of_influences[] = {
    BOTH(INFLUENCES "parameter", "influence_parameter", NULL,
         "parameters, the one that decides most first", LAC_HELD(TEXT, lac_influence, key)),
    BOTH(INFLUENCES "first", "sobol_first", NULL,
         "part of the variance that is owed to the parameter alone", I(REAL, first)),
    BOTH(INFLUENCES "first_error", "sobol_first_error", NULL, "its standard error, by bootstrap",
         I(REAL, first_error)),
    IN_JSON(INFLUENCES "first_low", I(REAL, first_low)),
    IN_JSON(INFLUENCES "first_high", I(REAL, first_high)),
    BOTH(INFLUENCES "total", "sobol_total", NULL, "the same with what it does through the others",
         I(REAL, total), .comment = "of a saltelli design"),
    BOTH(INFLUENCES "total_error", "sobol_total_error", NULL, "its standard error, by bootstrap",
         I(REAL, total_error)),
    IN_JSON(INFLUENCES "total_low", I(REAL, total_low)),
    IN_JSON(INFLUENCES "total_high", I(REAL, total_high)),
    BOTH(INFLUENCES "rank_correlation", "rank_correlation", NULL,
         "rank correlation of parameter and time of failure", I(REAL, rank)),
};

static const lac_variable of_whether[] = {
    IN_JSON("influences_of_probability", A(BOOL, of_chance)),
    IN_JSON("influence_rows", A(COUNT, rows)),
};

static const lac_variable of_base[] = {
    IN_JSON("base", A(REAL, base)),
    IN_JSON("base_never", TRUTH(base_stays)),
};

#define SWINGS "swings[]/"
static const lac_variable of_swings[] = {
    BOTH(SWINGS "parameter", "swing_parameter", NULL,
         "parameters of the tornado, the widest swing first", LAC_HELD(TEXT, lac_swing, key)),
    IN_JSON(SWINGS "unit", LAC_HELD(TEXT, lac_swing, unit)),
    IN_JSON(SWINGS "low", S(REAL, low)),
    IN_JSON(SWINGS "low_word", S(TEXT, low_word)),
    IN_JSON(SWINGS "high_word", S(TEXT, high_word)),
    IN_JSON(SWINGS "high", S(REAL, high)),
    BOTH(SWINGS "result_low", "swing_low", "s", "time of failure with the parameter low",
         S(REAL, result_low), .comment = "missing: never"),
    BOTH(SWINGS "result_high", "swing_high", "s", "time of failure with the parameter high",
         S(REAL, result_high), .comment = "missing: never"),
    IN_JSON(SWINGS "low_never", TRUTH(low_stays)),
    IN_JSON(SWINGS "high_never", TRUTH(high_stays)),
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
