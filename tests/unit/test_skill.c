// SPDX-License-Identifier: GPL-3.0-or-later
// How forecasts are judged, of forecasts that are made up.
#include <stdlib.h>

#include <math.h>

#include "forecast/hindcast.h"
#include "support/test.h"

enum { MOST = 16 };

static const lac_forecast_kind kind = {.info = {.name = "made up"}};
static lac_forecast forecasts[2 * MOST];
static double issue_times[MOST];

// A method and its baseline, which say the same.
static lac_rolling roll(size_t issues)
{
    return (lac_rolling){.start = 0.0,
                         .issues = issues,
                         .methods = 2,
                         .issue_time = issue_times,
                         .forecast = forecasts};
}

static void issue(size_t i, double now, const double quantile[5])
{
    issue_times[i] = now;
    for (size_t k = 0; k < 2; k++) {
        forecasts[2 * i + k] = (lac_forecast){.kind = &kind,
                                              .issued = true,
                                              .issue_time = now,
                                              .time = now + quantile[2],
                                              .low90 = now + quantile[0],
                                              .low50 = now + quantile[1],
                                              .high50 = now + quantile[3],
                                              .high90 = now + quantile[4]};
    }
}

static double crps_at(double failed_at)
{
    lac_skill skill[2];
    const lac_rolling r = roll(1);
    assert_int_equal(lac_rolling_measure(&r, failed_at, 1.0, skill, NULL), LAC_OK);
    assert_true(skill[0].crps == skill[1].crps && skill[0].crps == skill[0].persistence_crps);
    return skill[0].crps;
}

// The CRPS is the integral over y of (F(y) - 1(y > y0))^2, or twice that of the quantile loss over
// the level. Each of the five levels stands for those that are nearer to it than to another one: as
// y0 passes its quantile, the slope of the score rises by twice the width of that part.
static void each_level_stands_for_those_near_it(void **state)
{
    (void)state;
    static const double level[5] = {0.05, 0.25, 0.5, 0.75, 0.95};
    const double quantile[5] = {1.0, 2.0, 7.0, 18.0, 40.0};
    issue(0, 100.0, quantile);
    for (size_t k = 0; k < 5; k++) {
        const double from = k > 0 ? 0.5 * (level[k - 1] + level[k]) : 0.0;
        const double to = k < 4 ? 0.5 * (level[k] + level[k + 1]) : 1.0;
        const double y = 100.0 + quantile[k];
        const double bend = (crps_at(y + 0.5) - 2.0 * crps_at(y) + crps_at(y - 0.5)) / 0.5;
        assert_true(fabs(bend - 2.0 * (to - from)) < 1e-9);
    }
    // beyond all quantiles the score grows as the distance does, but for the tails it cannot see
    const double late = crps_at(1200.0) - crps_at(1100.0);
    double slope = 0.0;
    for (size_t k = 0; k < 5; k++) {
        const double from = k > 0 ? 0.5 * (level[k - 1] + level[k]) : 0.0;
        const double to = k < 4 ? 0.5 * (level[k] + level[k + 1]) : 1.0;
        slope += 2.0 * (to - from) * level[k];
    }
    assert_true(fabs(late / 100.0 - slope) < 1e-9);
}

// An eighth of the series left is of the first class, what is more of the second; likewise a
// quarter and a half.
static void borders_belong_to_the_shorter_lead(void **state)
{
    (void)state;
    static const struct {
        double now; // of a series from 0 to a failure at 64
        size_t lead;
    } issues[] = {{63.0, 0},  {56.0, 0}, {55.75, 1}, {48.0, 1},
                  {47.75, 2}, {32.0, 2}, {31.75, 3}, {1.0, 3}};
    const double quantile[5] = {1.0, 2.0, 3.0, 4.0, 5.0};
    for (size_t i = 0; i < sizeof issues / sizeof *issues; i++) {
        lac_skill skill[2];
        const lac_rolling r = roll(1);
        issue(0, issues[i].now, quantile);
        assert_int_equal(lac_rolling_measure(&r, 64.0, 1.0, skill, NULL), LAC_OK);
        for (size_t lead = 0; lead < LAC_LEADS; lead++) {
            assert_int_equal(skill[0].lead_count[lead], lead == issues[i].lead ? 1 : 0);
        }
        const double error = fabs(issues[i].now + 3.0 - 64.0);
        assert_true(skill[0].lead_error[issues[i].lead] == error && skill[0].error == error);
        assert_true(skill[0].lead_bias[issues[i].lead] == 3.0 / (64.0 - issues[i].now));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_level_stands_for_those_near_it),
        cmocka_unit_test(borders_belong_to_the_shorter_lead),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
