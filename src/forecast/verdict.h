/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"
#include "series/motion.h"

enum { LAC_VERDICT_TEXT = 240 };

/// Whether the rate rises: noise may forbid to say.
typedef enum lac_answer { LAC_CANNOT_TELL = 0, LAC_DOES_NOT, LAC_DOES } lac_answer;

/// "cannot tell", "no", "yes".
const char *lac_answer_name(lac_answer answer);

/// The rate's trend over the window in which it is clearest.
typedef struct lac_trend {
    lac_answer answer;
    double p;     ///< chance of so clear a rise where the rate is steady; NaN: too few readings
    double start; ///< of the window [s]; NaN
    size_t n;     ///< readings in it
    double rate;  ///< mean over it [m/s]; NaN
    double rise;  ///< of the rate over it [m/s]; NaN
    double error; ///< standard error of the rise [m/s]; NaN
    char reason[LAC_VERDICT_TEXT]; ///< of "cannot tell": why, and what would tell; else ""
} lac_trend;

typedef enum lac_level { LAC_QUIET = 0, LAC_WATCH, LAC_WARNING, LAC_ALARM } lac_level;

/// "quiet", "watch", "warning", "alarm".
const char *lac_level_name(lac_level level);

/// What gives a level; docs/theory/forecasting.md says how they were chosen.
typedef struct lac_levels {
    double watch_p; ///< watch: p of a rising rate below it
    double surge;   ///< or the last readings go at so many times the rate before
    double odds;    ///< warning: ln odds of a law that ends in failure
    double
        odds_dense; ///< and so much more at readings a day apart, twice at a tenth; of 10 days none
    double odds_sudden;  ///< and so much more, likewise, where one reading alone says so
    double running;      ///< readings in a row that must say so, else
    double hold;         ///< readings that a level outlasts what gave it
    double horizon;      ///< alarm: failure within it [s], or within two intervals where longer
    double chance;       ///< with this chance by the pooled methods
    double agree;        ///< and by this share of the methods that issue one
    double watch_rate;   ///< rates of the last day, or step where longer, that give a level by
    double warning_rate; ///< themselves [m/s]; INFINITY: none does
    double alarm_rate;
} lac_levels;

lac_levels lac_levels_default(void);

enum { LAC_SPANS = 4 };

/// How much faster the last readings go than those before, forward or back: the slower half of
/// the last 2, 4, 8 ... intervals, over the median of rates over as many before.
typedef struct lac_surge {
    double factor;       ///< 1: not clearly above noise and what rates scatter by [1]
    double rate, before; ///< of that half; the median [m/s]; NaN: too few readings
    double since;        ///< when the window began [s]
} lac_surge;

/// A time over which the rate is told. The step is the last interval.
typedef struct lac_span {
    const char *name; ///< "step", "day", "week", "month"
    double length;    ///< [s]; 0: the last interval
} lac_span;
extern const lac_span lac_spans[LAC_SPANS];

/// What an engineer is told first.
typedef struct lac_verdict {
    double position;          ///< since the first reading [m]
    double rate[LAC_SPANS];   ///< mean over the last span [m/s]; NaN: not sampled so finely, or
                              ///< known for so long
    double change[LAC_SPANS]; ///< from the span before [m/s]; NaN
    lac_trend trend;
    lac_surge surge;
    double log_odds; ///< of a law that ends in failure over a line, a step, a relaxation; NaN: not
                     ///< asked, as the rate does not rise
    double found;    ///< odds that gave a warning
    double needed;   ///< for one
    size_t issued, near; ///< methods that issue a forecast; whose median lies within the horizon
    double horizon;      ///< [s]
    double chance;       ///< of failure within it by the pooled methods; NaN: fewer than 3 issue
    double pooled[5];    ///< 5, 25, 50, 75 and 95 % of the pooled time of failure [s]; NaN
    lac_level level;
    char rule[LAC_VERDICT_TEXT]; ///< what gave it
} lac_verdict;

/// Whether the rate rises, by a test of its trend in units of its standard error: robust to single
/// bad readings, for any spacing.
/// @cost  O(n) for n readings, below 1 ms of 2000
lac_trend lac_trend_find(const lac_motion *motion);

/// Where the rate surged: the longest window of those in which it did about as much.
/// @cost  some 0.2 ms of 2000 readings
lac_surge lac_surge_find(const lac_motion *motion);

/// ln odds that the first n readings of a motion follow a law that ends in failure within a quarter
/// of the window, over the strongest of a line, a step that relaxes and a rate that goes over to
/// another; in the window, of a third of the other in length each, in which they are highest. Mean
/// likelihoods over grids of shapes, Voight's law (1988) with alpha from 1.3 to 3. NaN of fewer
/// than 6 readings.
/// @cost  some 5 ms
double lac_evidence_find(const lac_motion *motion, size_t n);
