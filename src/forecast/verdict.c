// SPDX-License-Identifier: GPL-3.0-or-later
// What an engineer is told first: where the slope is, whether it accelerates, what the methods
// agree on, and the level that follows.
#include <math.h>

#include "forecast/kinds.h"

static const double day = 86400.0;

const lac_span lac_spans[LAC_SPANS] = {
    {"step", 0.0}, {"day", 86400.0}, {"week", 7.0 * 86400.0}, {"month", 30.0 * 86400.0}};

const char *lac_answer_name(lac_answer answer)
{
    static const char *const names[] = {"cannot tell", "no", "yes"};
    return names[answer];
}

const char *lac_level_name(lac_level level)
{
    static const char *const names[] = {"quiet", "watch", "warning", "alarm"};
    return names[level];
}

lac_levels lac_levels_default(void)
{
    return (lac_levels){.watch_p = 0.01,
                        .odds = 1.0,
                        .odds_dense = 1.3,
                        .odds_sudden = 3.0,
                        .running = 2.0,
                        .hold = 2.0,
                        .horizon = 7.0 * day,
                        .chance = 0.75,
                        .agree = 0.5,
                        .watch_rate = INFINITY,
                        .warning_rate = INFINITY,
                        .alarm_rate = INFINITY};
}
