// SPDX-License-Identifier: GPL-3.0-or-later
// What an engineer is told first, as tables: variables over issue times, attributes, and JSON.
#include "data/describe.h"
#include "precursor/kinds.h"

enum { MEDIAN = LAC_FORECAST_LEVELS / 2 };

#define VERDICT const lac_verdict *v = of
#define OUTCOME const lac_forecast_outcome *o = of
#define V(kind_, field) LAC_HELD(kind_, lac_verdict, field)
#define DATE .flags = LAC_DATE
#define MAYBE .flags = LAC_MISSING

LAC_TEXT_GETTER(level, VERDICT, lac_level_name(v->level))
LAC_TEXT_GETTER(answer, VERDICT, lac_answer_name(v->trend.answer))
LAC_TEXT_GETTER(span_name, (void)of, lac_spans[at[0]].name)
LAC_GETTER(bool, has_pooled, VERDICT, !isnan(v->pooled[MEDIAN]))

// Under `in`: of one verdict `over` is "", of those of issue times "issue ".
#define OF_VERDICT(in, over)                                                                      \
    {.json = in "level", T(level)}, {.json = in "level_number", V(INT, level)},                   \
        {.json = in "rule", V(CHARS, rule), MAYBE}, {.json = in "accelerates", T(answer)},        \
        {.json = in "accelerates_reason", V(CHARS, trend.reason), MAYBE},                         \
        {.json = in "p", V(REAL, trend.p)}, {.json = in "window_start_s", V(REAL, trend.start)},  \
        {.json = in "window_start_date", V(REAL, trend.start), DATE},                             \
        {.json = in "rate_rise_m_per_s", V(REAL, trend.rise)},                                    \
        {.json = in "rate_rise_error_m_per_s", V(REAL, trend.error)},                             \
        {.json = in "position_m", V(REAL, position)},                                             \
        {.json = in "rates[]/span", .dims = over "span", T(span_name)},                           \
        {.json = in "rates[]/rate_m_per_s", .dims = over "span", V(REAL, rate)},                  \
        {.json = in "rates[]/change_m_per_s", .dims = over "span", V(REAL, change)},              \
        {.json = in "log_odds", V(REAL, log_odds)},                                               \
        {.json = in "log_odds_needed", V(REAL, needed)},                                          \
        {.json = in "methods_issued", V(COUNT, issued)},                                          \
        {.json = in "methods_near", V(COUNT, near)}, {.json = in "horizon_s", V(REAL, horizon)},  \
        {.json = in "chance_within_horizon", V(REAL, chance)},                                    \
        {.json = in "pooled_s", V(REAL, pooled[0]), .has = has_pooled},                           \
        {.json = in "pooled_s", V(REAL, pooled[1])}, {.json = in "pooled_s", V(REAL, pooled[2])}, \
        {.json = in "pooled_s", V(REAL, pooled[3])}, {.json = in "pooled_s", V(REAL, pooled[4])}, \
    {                                                                                             \
        .json = in "pooled_median_date", V(REAL, pooled[MEDIAN]), DATE                            \
    }
static const lac_variable of_verdict[] = {OF_VERDICT("verdict/", "")};
static const lac_variable of_verdicts[] = {OF_VERDICT("rolling/issues[]/verdict/", "issue ")};

#define OVER(dims_, name, unit, field, long_name, ...) \
    LAC_ROW(name, dims_, unit, long_name, field, .coordinates = "issue_time", __VA_ARGS__)
static const lac_variable in_file[] = {
    OVER("issue", "alarm_level", NULL, V(INT, level), "level of alarm",
         .meanings = "quiet watch warning alarm", .flags = LAC_WHOLE),
    OVER("issue", "accelerates", NULL, V(INT, trend.answer), "whether the rate rises",
         .meanings = "cannot_tell no yes", .flags = LAC_WHOLE),
    OVER("issue", "acceleration_p", NULL, V(REAL, trend.p),
         "chance of so clear a rise where the rate is steady", MAYBE),
    OVER("issue", "log_odds_of_failing", NULL, V(REAL, log_odds),
         "logarithm of the odds of a law that ends in failure", MAYBE,
         .comment = "over a line, a step, a relaxation; missing where the rate does not rise"),
    OVER("issue", "horizon", "s", V(REAL, horizon), "time within which failure is an alarm", MAYBE),
    OVER("issue", "chance_within_horizon", NULL, V(REAL, chance),
         "chance of failure within the horizon, by the pooled methods", MAYBE),
    OVER("issue span", "rate", "m s-1", V(REAL, rate),
         "mean rate over the last step, day, week, month", MAYBE,
         .comment = "missing where readings are not so close"),
    OVER("issue span", "rate_change", "m s-1", V(REAL, change),
         "change of the rate from the span before", MAYBE),
    OVER("issue quantile", "pooled_time", NULL, V(REAL, pooled),
         "time of failure by the pooled methods", .flags = LAC_TIME | LAC_MISSING),
};
static const lac_variable of_spans[] = {
    LAC_ROW("span", NULL, NULL, "time over which a rate is told", LAC_HELD(TEXT, lac_span, name),
            .flags = LAC_MEANINGS)};
static const lac_variable of_quantiles[] = {
    LAC_ROW("quantile", NULL, NULL, "chance that failure comes before", .held = LAC_HELD_REAL)};

#define LINE(k) LAC_TEXT_GETTER(line##k, OUTCOME, lac_verdict_line(o, k, room, LAC_TEXT_ROOM))
LINE(0)
LINE(1)
LINE(2)
LINE(3)
LINE(4)
static const lac_variable in_words[] = {
    {.name = "verdict", T(line0)},         {.name = "verdict_accelerates", T(line1)},
    {.name = "verdict_moved", T(line2)},   {.name = "verdict_rate", T(line3)},
    {.name = "verdict_failure", T(line4)},
};

lac_status lac_verdict_describe(const lac_verdict *verdict, lac_dataset *d, lac_error *err)
{
    const lac_laid laid = {LAC_VARIABLES(of_verdict, "", 0), verdict};
    return lac_dataset_add(d, &laid, 1, err);
}

lac_status lac_verdicts_describe(const lac_forecast_outcome *o, lac_dataset *d, lac_error *err)
{
    static const double chances[LAC_FORECAST_LEVELS] = {0.05, 0.25, 0.5, 0.75, 0.95};
    const lac_verdict *first = o->rolling != NULL ? o->rolling->verdict : &o->forecasts->verdict;
    const lac_laid file[] = {{LAC_VARIABLES(in_words, "", 0), o},
                             {LAC_VARIABLES(of_spans, "span", sizeof *lac_spans), lac_spans},
                             {LAC_VARIABLES(of_quantiles, "quantile", 0), chances},
                             {LAC_VARIABLES(in_file, "issue", sizeof *first), first}};
    const lac_laid rolled = {LAC_VARIABLES(of_verdicts, "issue", sizeof *first), first};
    LAC_TRY_RETURN(lac_dataset_add(d, file, sizeof file / sizeof *file, err));
    return o->readings != NULL && o->rolling != NULL ? lac_dataset_add(d, &rolled, 1, err) : LAC_OK;
}
