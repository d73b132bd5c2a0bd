// SPDX-License-Identifier: GPL-3.0-or-later
// How often a run puts out and keeps itself: what time cannot tell apart, and what costs much.
#include "case/sections.h"

// Outputs closer in time than numbers near the end of the run are would all be at one time.
static void check_fineness(lac_reader *reader, const lac_case *c)
{
    const struct {
        const char *key;
        double time;
    } cadences[] = {{"output.every", c->run.record.time},
                    {"output.fields_every", c->run.snapshot.time},
                    {"output.checkpoint", c->run.checkpoint.time}};
    const double least = c->run.end * 0x1p-52;
    char text[64];
    for (size_t i = 0; i < sizeof cadences / sizeof cadences[0] && lac_clean(reader, "time"); i++) {
        (void)lac_refuse(reader, cadences[i].time < least && lac_clean(reader, "output"),
                         cadences[i].key,
                         "is finer than times are told apart by time.end: must be >= %s",
                         lac_units_format(least, "s", text, sizeof text));
    }
}

// At each the integrator begins anew, with short steps of the lowest order.
static void check_checkpoints(lac_reader *reader, const lac_case *c)
{
    const int64_t steps = c->run.checkpoint.steps;
    const double times = c->run.end / c->run.checkpoint.time, many = 1e4; // NaN: not by time
    if (!lac_clean(reader, "output") || !lac_clean(reader, "time")) {
        return;
    }
    if (steps > 0 && steps < LAC_CLOSE_STEPS) {
        lac_warn(reader, "output.checkpoint.steps",
                 "the integrator begins anew at each checkpoint, and some ten steps or more go by "
                 "until its steps are as long as before: a run can take 10 times the steps with "
                 "10, 40 times with 1; %d or more cost little",
                 5 * LAC_CLOSE_STEPS);
    } else if (times > many) {
        lac_warn(reader, "output.checkpoint.time",
                 "names %.2g checkpoints up to time.end: the integrator begins anew at each, so "
                 "that no step is longer than this time, and many are far shorter",
                 times);
    }
}

void lac_check_cadences(lac_reader *reader, const lac_case *c)
{
    check_fineness(reader, c);
    check_checkpoints(reader, c);
}
