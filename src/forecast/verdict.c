// SPDX-License-Identifier: GPL-3.0-or-later
// What an engineer is told first: where the slope is, whether it accelerates, what the methods
// agree on, and the level that follows. It knows the motion and the forecasts of one time alone,
// so that it is the same whatever was asked before.
#include <gsl/gsl_cdf.h>

#include "forecast/kinds.h"

enum { QUANTILES = LAC_FORECAST_LEVELS };
static const double day = 86400.0;
static const double sparse = 10.0;      // days: intervals from which odds count alone
static const double asked_below = 0.05; // p of a rise above which the odds are not asked
static const double nearly = 1e-6;      // of the farthest quantile: no time is nearer
static const double far_off = 10.0;     // noises, and times what readings before were off
static const double most_said = 0.99;
static const double held_below = 0.5;      // and from which on no level is held
static const double stretched = 1.5;       // what a span may be longer or shorter by
static const double few_intervals = 2.0;   // that a horizon is of at least
static const double much_faster = 2.0;     // a surge, times that of a watch: one reading is enough
static const double silent_after = 3.5;    // intervals
enum { STUCK_LEAST = 6, STUCK_TIMES = 4 }; // equal readings in a row, and times what ever was

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
                        .surge = 5.0,
                        .odds = 0.75,
                        .odds_dense = 2.0,
                        .odds_sudden = 2.0,
                        .running = 2.0,
                        .hold = 2.0,
                        .horizon = 7.0 * day,
                        .chance = 0.5,
                        .agree = 0.5,
                        .watch_rate = INFINITY,
                        .warning_rate = INFINITY,
                        .alarm_rate = INFINITY};
}

static size_t reading_near(const lac_motion *m, size_t n, double time)
{
    size_t low = 0, high = n - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        low = m->time[middle] <= time ? middle : low;
        high = m->time[middle] <= time ? high : middle;
    }
    return time - m->time[low] <= m->time[high] - time ? low : high;
}

// Mean rate over a span that ends with reading `last`; NaN where no reading is near its begin.
// @param first  the reading that it begins with
static double rate_over(const lac_motion *m, size_t last, double length, size_t *first)
{
    *first = last;
    if (last == 0) {
        return NAN;
    }
    *first = length > 0.0 ? reading_near(m, last, m->time[last] - length) : last - 1;
    const double took = m->time[last] - m->time[*first];
    const bool off = length > 0.0 && (took > stretched * length || took < length / stretched);
    return off ? (double)NAN : (m->displacement[last] - m->displacement[*first]) / took;
}

static void tell_rates(const lac_motion *m, lac_verdict *v)
{
    v->position = m->n > 0 ? m->displacement[m->n - 1] - m->displacement[0] : (double)NAN;
    for (size_t k = 0; k < LAC_SPANS; k++) {
        size_t first = 0, before = 0;
        v->rate[k] = m->n > 0 ? rate_over(m, m->n - 1, lac_spans[k].length, &first) : (double)NAN;
        v->change[k] = isnan(v->rate[k])
                           ? (double)NAN
                           : v->rate[k] - rate_over(m, first, lac_spans[k].length, &before);
    }
}

// Chance of failure before `time`: through the quantiles, normal in ln of the remaining time.
static double chance_before(const double *quantile, double now, double time)
{
    static const double normal[] = {-1.6448536269514722, -0.6744897501960817, 0.0,
                                    0.6744897501960817, 1.6448536269514722};
    const double x = log(time - now);
    double left[QUANTILES];
    size_t k = 0;
    for (int i = 0; i < QUANTILES; i++) { // the first may be now itself
        left[i] = log(fmax(quantile[i] - now, nearly * (quantile[QUANTILES - 1] - now)));
    }
    while (k < QUANTILES - 2 && x > left[k + 1]) {
        k++;
    }
    const double part = left[k + 1] > left[k] ? (x - left[k]) / (left[k + 1] - left[k])
                        : x > left[k]         ? INFINITY
                                              : -INFINITY;
    return gsl_cdf_ugaussian_P(normal[k] + part * (normal[k + 1] - normal[k]));
}

// Each quantile of the pool is the median of the methods' own; fewer than three are none.
static void pool(const lac_forecast_set *o, lac_verdict *v)
{
    enum { MOST = 32 };
    for (int q = 0; q < QUANTILES; q++) {
        double one[MOST];
        size_t n = 0;
        for (size_t k = 0; k < o->count && n < MOST; k++) {
            const lac_forecast *f = &o->forecast[k];
            const double own[QUANTILES] = {f->low90, f->low50, f->time, f->high50, f->high90};
            if (f->issued && !f->kind->baseline) {
                one[n++] = own[q];
            }
        }
        v->issued = n;
        v->pooled[q] = n >= LAC_POOLED ? lac_median(n, one) : (double)NAN;
    }
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        v->near += f->issued && !f->kind->baseline && f->time <= o->issue_time + v->horizon ? 1 : 0;
    }
    v->chance = isnan(v->pooled[2])
                    ? (double)NAN
                    : chance_before(v->pooled, o->issue_time, o->issue_time + v->horizon);
}

// How dense readings are: 0 at ten days and more, 1 at one, 2 at a tenth and less.
static double density(double interval)
{
    const double days = fmax(1.0 / sparse, fmin(sparse, interval / day));
    return 1.0 - log(days) / log(sparse);
}

// Odds as of `back` readings ago; NaN where the rate did not rise then.
static double odds_of(const lac_motion *m, const lac_trend *now, size_t back)
{
    lac_motion past = *m;
    if (m->n <= back) {
        return NAN;
    }
    past.n -= back;
    past.velocities = m->velocities > back ? m->velocities - back : 0;
    const double p = back == 0 ? now->p : lac_trend_find(&past).p;
    return p < asked_below ? lac_evidence_find(&past, past.n) : (double)NAN;
}

// Whether odds as of one reading, so many ago, are enough by themselves: high, or of a rate that
// has surged.
static bool is_sudden(const lac_levels *l, const lac_motion *m, const lac_verdict *v, size_t back,
                      double odds)
{
    lac_motion past = *m;
    past.n -= back;
    return odds >= v->needed + l->odds_sudden * density(m->interval) ||
           (odds >= v->needed && lac_surge_find(&past).factor >= much_faster * l->surge);
}

// How many readings ago the odds were high enough last, for as long as that holds.
// @return whether they were
static bool warns(const lac_levels *l, const lac_motion *m, lac_verdict *v, size_t *ago)
{
    const size_t running = (size_t)l->running, hold = (size_t)l->hold;
    size_t run = 0;
    if (!(v->trend.p < held_below)) {
        return false;
    }
    for (size_t back = 0; back < hold + running && back - run <= hold; back++) {
        const double odds = odds_of(m, &v->trend, back);
        v->log_odds = back == 0 ? odds : v->log_odds;
        if (is_sudden(l, m, v, back, odds)) {
            v->found = odds;
            *ago = back - run;
            return true;
        }
        run = odds >= v->needed ? run + 1 : 0;
        if (run == running) {
            v->found = odds;
            *ago = back + 1 - run;
            return true;
        }
    }
    return false;
}

#define RULE(v, ...) (void)snprintf((v)->rule, sizeof(v)->rule, __VA_ARGS__)

// By the rate alone, where levels name one.
static lac_level level_of_rate(const lac_levels *l, lac_verdict *v)
{
    const double limit[] = {l->watch_rate, l->warning_rate, l->alarm_rate};
    const double rate = isnan(v->rate[1]) ? v->rate[0] : v->rate[1];
    int level = 0;
    for (int k = 1; k <= 3; k++) {
        level = rate >= limit[k - 1] ? k : level;
    }
    if (level > 0) {
        RULE(v, "the rate over the last %s, %.3g mm/day, is at least %.3g mm/day",
             isnan(v->rate[1]) ? "step" : "day", 1e3 * day * rate, 1e3 * day * limit[level - 1]);
    }
    return (lac_level)level;
}

// How far reading i is off the line through the two before it.
static double off_before(const lac_motion *m, size_t i)
{
    const double *t = m->time + i, *d = m->displacement + i;
    return d[0] - d[-1] - (d[-1] - d[-2]) / (t[-1] - t[-2]) * (t[0] - t[-1]);
}

// How far the last reading is off, if by far more than noise and than those before it; else 0. A
// failure or a bad reading: the next one tells, and nobody should wait for it in quiet.
static double jump_of(const lac_motion *m)
{
    enum { BEFORE = 8, LEAST = 5 };
    const size_t last = m->n - 1;
    double most = far_off * m->noise;
    if (m->n < LEAST || !(m->noise > 0.0)) {
        return 0.0;
    }
    for (size_t i = m->n > BEFORE + 3 ? m->n - BEFORE - 1 : 2; i < last; i++) {
        most = fmax(most, far_off * fabs(off_before(m, i)));
    }
    return fabs(off_before(m, last)) > most ? off_before(m, last) : 0.0;
}

static const char *odds_text(double log_odds, char text[static 32])
{
    const double most = 1e5, odds = exp(log_odds);
    (void)snprintf(text, 32,
                   odds > most   ? "above %.0f"
                   : odds < 10.0 ? "%.1f"
                                 : "%.0f",
                   fmin(odds, most));
    return text;
}

static void say_surge(lac_verdict *v, double now)
{
    const double mm_day = 1e3 * day;
    RULE(v,
         "over the last %.3g days it went%s at %.3g mm/day or more, against %.3g mm/day that were "
         "usual before",
         (now - v->surge.since) / day, v->surge.rate < 0.0 ? " back" : "",
         mm_day * fabs(v->surge.rate), mm_day * v->surge.before);
}

static void say_rise(const lac_levels *l, const lac_motion *m, lac_verdict *v)
{
    char odds[32], alone[32];
    if (v->log_odds >= v->needed) {
        RULE(v,
             "the rate rises, and odds of a law that ends in failure are %s to 1 at this reading: "
             "%.0f readings in a row, or %s to 1, make a warning",
             odds_text(v->log_odds, odds), l->running,
             odds_text(v->needed + l->odds_sudden * density(m->interval), alone));
        return;
    }
    RULE(v, "the rate rises, but a law that ends in failure is not yet told from a step or a new "
            "steady rate");
}

// Readings whose values are missing say nothing of the slope.
static bool is_silent(const lac_motion *m, double now)
{
    return m->n > 1 && now - m->time[m->n - 1] > silent_after * m->interval;
}

// Equal readings at the end, to the last digit: so many, and so many times what was seen before,
// that the sensor may have stopped. 0: they are fewer.
static size_t stuck_for(const lac_motion *m)
{
    size_t run = m->n > 0, longest = 1;
    for (size_t i = 1; i < m->n; i++) {
        if (m->displacement[i] != m->displacement[i - 1]) {
            longest = run > longest ? run : longest;
            run = 0;
        }
        run++;
    }
    return run >= STUCK_LEAST && run >= STUCK_TIMES * longest ? run : 0;
}

// By the odds and the methods, of the last values.
static lac_level level_of_values(const lac_levels *l, const lac_forecast_set *o, lac_verdict *v)
{
    const lac_motion *m = o->motion;
    size_t ago = 0;
    if (warns(l, m, v, &ago)) {
        const bool alarm = v->chance >= l->chance && v->near >= LAC_POOLED &&
                           (double)v->near >= l->agree * (double)v->issued;
        char when[64] = "";
        if (ago > 0) {
            (void)snprintf(when, sizeof when, " until %zu reading%s ago", ago, ago > 1 ? "s" : "");
        }
        if (alarm) {
            RULE(
                v,
                "the motion follows a law that ends in failure%s, and %zu of %zu methods expect it "
                "within %.3g days (chance %s%.0f %%)",
                when, v->near, v->issued, v->horizon / day, v->chance > most_said ? "above " : "",
                100.0 * fmin(v->chance, most_said));
        } else {
            char odds[32], needed[32];
            RULE(v,
                 "the motion follows a law that ends in failure%s rather than a line, a step or a "
                 "new steady rate (odds %s to 1, %s to 1 needed)",
                 when, odds_text(v->found, odds), odds_text(v->needed, needed));
        }
        return alarm ? LAC_ALARM : LAC_WARNING;
    }
    if (v->surge.factor >= l->surge) {
        say_surge(v, o->issue_time);
        return LAC_WATCH;
    }
    if (v->trend.p < l->watch_p) {
        say_rise(l, m, v);
        return LAC_WATCH;
    }
    if (jump_of(m) != 0.0) {
        RULE(v,
             "the last reading is %.3g mm off the trend before it: measure again, it is a bad "
             "reading or a failure",
             1e3 * jump_of(m));
        return LAC_WATCH;
    }
    RULE(v, "%s",
         v->trend.answer != LAC_CANNOT_TELL ? "the rate does not rise"
         : isnan(v->trend.p)                ? v->trend.reason
                                            : "noise forbids to say whether the rate rises");
    return LAC_QUIET;
}

// Nobody should wait in quiet for a sensor that has gone silent, or says the same for ever.
static lac_level level_of_motion(const lac_levels *l, const lac_forecast_set *o, lac_verdict *v)
{
    const lac_motion *m = o->motion;
    const lac_level level = level_of_values(l, o, v);
    const size_t stuck = level < LAC_WARNING ? stuck_for(m) : 0;
    if (stuck > 0) {
        RULE(
            v,
            "the last %zu readings are the same to the last digit, %.3g days long: the slope is at "
            "rest or the sensor has stopped, check it",
            stuck, (m->time[m->n - 1] - m->time[m->n - stuck]) / day);
    }
    if (!is_silent(m, o->issue_time)) {
        return stuck > 0 ? LAC_WATCH : level;
    }
    char then[LAC_VERDICT_TEXT];
    (void)snprintf(then, sizeof then, "%s", v->rule);
    RULE(v, "no value has come for %.3g days; at the last one %.*s",
         (o->issue_time - m->time[m->n - 1]) / day, (int)sizeof then - 64, then);
    return level > LAC_WATCH ? level : LAC_WATCH;
}

// A driver that explains the rate: what remains is no warning.
static void heed_drivers(const lac_forecast_set *o, lac_verdict *v)
{
    for (size_t k = 0; k < o->effects && v->level > LAC_WATCH; k++) {
        if (lac_driver_withholds(&o->effect[k])) {
            v->level = LAC_WATCH;
            RULE(v, "%.60s explains %.0f %% of the rate, and what remains does not accelerate",
                 o->effect[k].driver->name, 100.0 * o->effect[k].share);
        }
    }
}

void lac_verdict_find(const lac_forecast_def *def, lac_forecast_set *o)
{
    const lac_levels *l = &def->levels;
    const lac_motion *m = o->motion;
    lac_verdict *v = &o->verdict;
    const lac_trend trend = v->trend;
    *v = (lac_verdict){.trend = trend,
                       .log_odds = NAN,
                       .needed = l->odds + l->odds_dense * density(m->interval),
                       .horizon = fmax(l->horizon, m->n > 1 ? few_intervals * m->interval : 0.0)};
    tell_rates(m, v);
    pool(o, v);
    v->surge = lac_surge_find(m);
    if (v->surge.factor >= l->surge && trend.answer == LAC_DOES_NOT &&
        trend.start < v->surge.since) {
        v->trend.answer = LAC_CANNOT_TELL;
        (void)snprintf(v->trend.reason, sizeof v->trend.reason,
                       "the rate changed at once, in the last %.3g days: too few readings since",
                       (o->issue_time - v->surge.since) / day);
    }
    v->level = level_of_motion(l, o, v);
    heed_drivers(o, v);
    lac_verdict by_rate = *v;
    if (level_of_rate(l, &by_rate) > v->level) {
        v->level = level_of_rate(l, v);
    }
}
