// SPDX-License-Identifier: GPL-3.0-or-later
// What an engineer is told first, in words that can be read aloud.
#include <ctype.h>

#include "base/date.h"
#include "base/units.h"
#include "precursor/precursor.h"

static const double day = 86400.0;
static const double unchanged = 1e-9; // of a rate: what rounding makes of none

enum { TIME = 40 };

// A text that grows.
typedef struct words {
    char *text;
    size_t size;
} words;

#define ADD(w, ...) lac_append((w)->text, (w)->size, __VA_ARGS__)

// In the unit that the file counts time in, where it is known.
static void clock_text(const lac_series *series, double t, char *text, size_t size)
{
    const double whole = 1e6, exact = 1e15;
    if (series == NULL || series->time_name[0] == '\0') {
        (void)lac_units_format(t, "s", text, size);
        return;
    }
    const double x = t / series->time_unit;
    (void)snprintf(text, size, fabs(x) >= whole && fabs(x) < exact ? "%.0f %s" : "%.6g %s", x,
                   series->time_name);
}

const char *lac_outcome_time(const lac_forecast_outcome *of, double t, char *text, size_t size)
{
    enum { DATE = 10, MINUTE = 16, SECOND = 20 };
    if (!isfinite(t)) {
        (void)snprintf(text, size, "-");
    } else if (!of->dated) {
        clock_text(of->series, t, text, size);
    } else if (strlen(lac_date_format(t, text, size)) != SECOND) {
        (void)snprintf(text, size, t > 0.0 ? "after year 9999" : "before year 0");
    } else {
        text[DATE] = ' ';
        text[MINUTE] = '\0';
    }
    return text;
}

static void add_time(const words *w, const lac_forecast_outcome *o, const char *before, double t)
{
    char text[TIME];
    ADD(w, "%s%s", before, lac_outcome_time(o, t, text, sizeof text));
}

bool lac_outcome_zoned(const lac_forecast_outcome *o)
{
    return o->series == NULL || o->series->time_name[0] != '\0';
}

// What a person must know of a date that was just told.
static const char *zone(const lac_forecast_outcome *o)
{
    return !o->dated ? "" : lac_outcome_zoned(o) ? " UTC" : " on the file's clock";
}

// "21 days"; a unit of which there are two at least.
static void add_span(const words *w, double seconds)
{
    static const struct {
        double length;
        const char *name;
    } units[] = {{86400.0, "day"}, {3600.0, "hour"}, {60.0, "minute"}, {1.0, "second"}};
    size_t k = 0;
    while (k + 1 < sizeof units / sizeof *units && seconds < 1.99 * units[k].length) {
        k++;
    }
    char number[TIME];
    (void)snprintf(number, sizeof number, "%.3g", seconds / units[k].length);
    ADD(w, "%s %s%s", number, units[k].name, strcmp(number, "1") == 0 ? "" : "s");
}

static void add_percent(const words *w, double chance)
{
    const double least = 0.01;
    const bool sure = chance > 1.0 - least;
    if (chance < least || sure) {
        ADD(w, sure ? "more than 99 %%" : "less than 1 %%");
    } else {
        ADD(w, "%.0f %%", 100.0 * chance);
    }
}

// Without an exponent: it is read aloud.
static void add_p(const words *w, double p)
{
    const double least = 1e-6;
    const int digits = p < least ? 6 : (int)fmax(2.0, -floor(log10(p)));
    ADD(w, "(p %s%.*f, the chance that a steady slope looks so)", p < least ? "below " : "", digits,
        fmax(p, least));
}

static void say_level(const lac_forecast_outcome *o, const words *w)
{
    const lac_verdict *v = &o->forecasts->verdict;
    const bool unknown = v->level == LAC_QUIET && v->trend.answer == LAC_CANNOT_TELL;
    const char *name = unknown ? lac_answer_name(LAC_CANNOT_TELL) : lac_level_name(v->level);
    for (const char *c = name; *c != '\0'; c++) {
        ADD(w, "%c", toupper((unsigned char)*c));
    }
    add_time(w, o, " as of ", o->forecasts->issue_time);
    ADD(w, "%s: %s", zone(o), v->rule[0] != '\0' ? v->rule : "nothing gives another level");
}

static void say_acceleration(const lac_forecast_outcome *o, const words *w)
{
    const lac_trend *t = &o->forecasts->verdict.trend;
    ADD(w, "%s", lac_answer_name(t->answer));
    if (t->answer == LAC_CANNOT_TELL) {
        ADD(w, "%s%s", t->reason[0] != '\0' ? ": " : "", t->reason);
        return;
    }
    if (isfinite(t->start)) {
        ADD(w,
            t->answer == LAC_DOES ? ", over " : ": a rise by half is excluded (19 of 20), over ");
        add_span(w, o->forecasts->issue_time - t->start);
        add_time(w, o, " since ", t->start);
        ADD(w, "%s", zone(o));
    }
    if (t->answer == LAC_DOES && isfinite(t->p)) {
        ADD(w, " ");
        add_p(w, t->p);
    }
}

static void say_position(const lac_forecast_outcome *o, const words *w)
{
    const double moved = o->forecasts->verdict.position * 1e3, plain = 1e3;
    const lac_motion *m = o->forecasts->motion;
    if (!isfinite(moved)) {
        ADD(w, "not known");
        return;
    }
    ADD(w, fabs(moved) >= plain ? "%.0f mm" : "%.4g mm", moved);
    if (m != NULL && m->n > 0) {
        add_time(w, o, " since ", m->time[0]);
        ADD(w, "%s%s", zone(o), m->falling ? ", falling" : "");
        if (m->resets > 0) {
            ADD(w, ", with %zu reset%s of the sensor taken out", m->resets,
                m->resets > 1 ? "s" : "");
        }
    }
}

static void say_rates(const lac_forecast_outcome *o, const words *w)
{
    const lac_verdict *v = &o->forecasts->verdict;
    bool known = false;
    for (size_t k = 0; k < LAC_SPANS; k++) {
        const double rate = v->rate[k] * day * 1e3, change = v->change[k] * day * 1e3;
        const char *name = lac_spans[k].name;
        if (!isfinite(rate)) {
            continue;
        }
        ADD(w, known ? ", %.3g over the last %s" : "%.3g mm/day over the last %s", rate, name);
        if (fabs(change) <= unchanged * fabs(rate)) {
            ADD(w, " (unchanged)");
        } else if (isfinite(change)) {
            ADD(w, " (%.3g %s than over the %s before)", fabs(change),
                change < 0.0 ? "less" : "more", name);
        }
        known = true;
    }
    const char *before = known ? "; not known over the last " : "not known over the last ";
    for (size_t k = 0; k < LAC_SPANS; k++) {
        if (!isfinite(v->rate[k])) {
            ADD(w, "%s%s", before, lac_spans[k].name);
            before = ", ";
        }
    }
}

static void add_window(const words *w, const lac_forecast_outcome *o, double low, double high)
{
    add_time(w, o, "", low);
    if (isfinite(high)) {
        add_time(w, o, " to ", high);
    } else {
        ADD(w, " on, without an end");
    }
}

static void say_failure(const lac_forecast_outcome *o, const words *w)
{
    const lac_verdict *v = &o->forecasts->verdict;
    if (v->issued == 0) {
        ADD(w, "no method gives a time of failure");
        return;
    }
    if (!isfinite(v->chance)) {
        ADD(w, v->issued == 1 ? "one method gives a time, too few for a chance"
                              : "two methods give a time, too few for a chance");
        return;
    }
    if (v->level < LAC_WARNING) {
        ADD(w, "if it is heading for failure: ");
    }
    if (isfinite(v->pooled[0])) {
        ADD(w, "with a chance of 50 %% from ");
        add_window(w, o, v->pooled[1], v->pooled[3]);
        ADD(w, ", of 90 %% from ");
        add_window(w, o, v->pooled[0], v->pooled[4]);
        ADD(w, "%s; ", zone(o));
    }
    ADD(w, "a chance of ");
    add_percent(w, v->chance);
    ADD(w, " within ");
    add_span(w, v->horizon);
    ADD(w, "; ");
    ADD(w, "%zu of %zu methods that give a time put it within ", v->near, v->issued);
    add_span(w, v->horizon);
}

const char *const lac_verdict_about[LAC_VERDICT_LINES] = {"level", "accelerates", "moved", "rate",
                                                          "failure"};

const char *lac_verdict_line(const lac_forecast_outcome *o, size_t line, char *text, size_t size)
{
    static void (*const say[LAC_VERDICT_LINES])(const lac_forecast_outcome *, const words *) = {
        say_level, say_acceleration, say_position, say_rates, say_failure};
    text[0] = '\0';
    say[line](o, &(words){.text = text, .size = size});
    return text;
}
