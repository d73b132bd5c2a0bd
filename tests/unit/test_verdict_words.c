// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts that are made up, in words and as JSON.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "precursor/precursor.h"
#include "support/test.h"

static const double day = 86400.0, since = 1435708800.0; // 2015-07-01

static lac_verdict sure(void)
{
    const double mm_day = 1e-3 / day;
    return (lac_verdict){.position = 1.23456,
                         .rate = {12.3 * mm_day, NAN, 9.8 * mm_day, 5.1 * mm_day},
                         .change = {2.1 * mm_day, NAN, -3.0 * mm_day, NAN},
                         .trend = {.answer = LAC_DOES,
                                   .p = 4e-4,
                                   .start = since,
                                   .n = 20,
                                   .rate = 5.0 * mm_day,
                                   .rise = 7.25 * mm_day,
                                   .error = 1.5 * mm_day},
                         .log_odds = 3.0,
                         .needed = 1.0,
                         .issued = 8,
                         .near = 5,
                         .horizon = 7.0 * day,
                         .chance = 0.62,
                         .pooled = {since + 22.0 * day, since + 23.0 * day, since + 24.0 * day,
                                    since + 25.5 * day, since + 30.0 * day},
                         .level = LAC_WARNING,
                         .rule = "it accelerates, and a law that ends in failure is likelier"};
}

// As where nothing can be told: all that may be missing is.
static lac_verdict unsure(void)
{
    lac_verdict v = {.position = NAN,
                     .trend = {.answer = LAC_CANNOT_TELL,
                               .p = NAN,
                               .start = NAN,
                               .rate = NAN,
                               .rise = NAN,
                               .error = NAN},
                     .log_odds = NAN,
                     .needed = NAN,
                     .horizon = NAN,
                     .chance = NAN};
    for (size_t k = 0; k < LAC_SPANS; k++) {
        v.rate[k] = v.change[k] = NAN;
    }
    for (size_t k = 0; k < 5; k++) {
        v.pooled[k] = NAN;
    }
    return v;
}

static void check(const lac_verdict *verdict, bool dated, const char *const want[LAC_VERDICT_LINES])
{
    double start = since - 10.0 * day;
    lac_motion motion = {.n = 1, .time = &start};
    lac_forecast_set set = {
        .motion = &motion, .issue_time = since + 21.0 * day, .verdict = *verdict};
    const lac_forecast_outcome outcome = {.dated = dated, .forecasts = &set};
    char text[LAC_VERDICT_LONGEST];
    for (size_t k = 0; k < LAC_VERDICT_LINES; k++) {
        assert_string_equal(lac_verdict_line(&outcome, k, text, sizeof text), want[k]);
    }
}

static void all_of_it_is_said(void **state)
{
    (void)state;
    const lac_verdict v = sure();
    check(
        &v, true,
        (const char *const[]){
            "WARNING as of 2015-07-22 00:00 UTC: it accelerates, and a law that ends in failure is "
            "likelier",
            "yes, over 21 days since 2015-07-01 00:00 UTC (p "
            "0.0004, the chance that a steady slope looks so)",
            "1235 mm since 2015-06-21 00:00 UTC",
            "12.3 mm/day over the last step (2.1 more than over the step before), 9.8 over the "
            "last week (3 less than over the week before), 5.1 over the last month; not known "
            "over the last day",
            "with a chance of 50 % from 2015-07-24 00:00 to 2015-07-26 12:00, of 90 % from "
            "2015-07-23 00:00 to 2015-07-31 00:00 UTC; a chance of 62 % within 7 days; 5 of 8 "
            "methods that give a time put it within 7 days"});
}

static void what_is_not_known_is_said(void **state)
{
    (void)state;
    lac_verdict v = unsure();
    check(&v, true,
          (const char *const[]){
              "CANNOT TELL as of 2015-07-22 00:00 UTC: nothing gives another level", "cannot tell",
              "not known", "not known over the last step, day, week, month",
              "no method gives a time of failure"});
    v.trend = (lac_trend){.answer = LAC_DOES_NOT, .p = 0.4, .start = NAN};
    (void)snprintf(v.rule, sizeof v.rule, "a steady rate");
    v.position = -0.0042;
    v.issued = 3;
    v.chance = 0.1;
    v.horizon = 3600.0;
    v.pooled[0] = v.pooled[1] = 200.0 * day;
    check(
        &v, false,
        (const char *const[]){
            "QUIET as of 45.5533 year: a steady rate", "no", "-4.2 mm since 45.4685 year",
            "not known over the last step, day, week, month",
            "if it is heading for failure: with a chance of 50 % from 200 day on, without an end, "
            "of 90 % from 200 day on, without an end; a chance of 10 % within 60 minutes; 0 of "
            "3 methods that give a time put it within 60 minutes"});
    v.issued = 1;
    v.chance = NAN;
    check(&v, false,
          (const char *const[]){"QUIET as of 45.5533 year: a steady rate", "no",
                                "-4.2 mm since 45.4685 year",
                                "not known over the last step, day, week, month",
                                "one method gives a time, too few for a chance"});
}

static char *json_of(const lac_verdict *verdict)
{
    const lac_forecast_set set = {.verdict = *verdict};
    lac_dataset *d = NULL;
    char *text = NULL;
    assert_int_equal(lac_issue_describe(&set, true, &d, NULL), LAC_OK);
    assert_int_equal(lac_dataset_to_json(d, &text, NULL), LAC_OK);
    lac_dataset_free(d);
    return text;
}

static void all_of_it_is_json(void **state)
{
    (void)state;
    static const char *const known[] = {"\"level\": \"warning\"",
                                        "\"level_number\": 2",
                                        "\"accelerates\": \"yes\"",
                                        "\"accelerates_reason\": null",
                                        "\"p\": 0.0004",
                                        "\"window_start_date\": \"2015-07-01T00:00:00Z\"",
                                        "\"position_m\": 1.23456",
                                        "\"span\": \"month\"",
                                        "\"methods_issued\": 8",
                                        "\"methods_near\": 5",
                                        "\"pooled_median_date\": \"2015-07-25T00:00:00Z\""};
    static const char *const unknown[] = {"\"rule\": null",
                                          "\"accelerates\": \"cannot tell\"",
                                          "\"p\": null",
                                          "\"window_start_s\": null",
                                          "\"window_start_date\": null",
                                          "\"rate_rise_m_per_s\": null",
                                          "\"rate_rise_error_m_per_s\": null",
                                          "\"position_m\": null",
                                          "\"rate_m_per_s\": null",
                                          "\"change_m_per_s\": null",
                                          "\"log_odds\": null",
                                          "\"log_odds_needed\": null",
                                          "\"horizon_s\": null",
                                          "\"chance_within_horizon\": null",
                                          "\"pooled_s\": null",
                                          "\"pooled_median_date\": null"};
    const lac_verdict all = sure(), none = unsure();
    char *text = json_of(&all);
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        assert_non_null(strstr(text, known[k]));
    }
    free(text);
    text = json_of(&none);
    for (size_t k = 0; k < sizeof unknown / sizeof *unknown; k++) {
        assert_non_null(strstr(text, unknown[k]));
    }
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_of_it_is_said),
        cmocka_unit_test(what_is_not_known_is_said),
        cmocka_unit_test(all_of_it_is_json),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
