// SPDX-License-Identifier: GPL-3.0-or-later
// What keeps methods from being asked, the readings that they are fitted to, all methods asked at
// the last reading, and which of their answers are good enough as forecasts: what drivers explain
// widens intervals, or withholds a forecast.
#include "forecast/kinds.h"

enum { LEAST_LATER = 10, BRIDGED = 3, LINE = 3, LONGEST_RUN = 1000 };
static const double beyond = 1e150; // what is not computed with, nor its inverse

static const double driver_level = 0.05; // of all drivers together
// Of ln of the remaining time, where a slope fails while driven: tools/studies/driven_failures.py
static const double driven_spread = 1.0;

// Asks the definition's drivers of the set's motion. One of n explains where p is up to 0.05/n.
static lac_status explain_all(const lac_forecast_def *def, lac_forecast_set *o, lac_error *err)
{
    o->effect = calloc(def->drivers + 1, sizeof *o->effect);
    LAC_FAIL_MEMORY_IF(o->effect == NULL, err);
    for (size_t k = 0; k < def->drivers; k++) {
        o->effects = k + 1;
        LAC_TRY_RETURN(lac_driver_explain(o->motion, &def->driver[k],
                                          driver_level / (double)def->drivers, &o->effect[k], err));
    }
    return LAC_OK;
}

static void free_effects(lac_forecast_set *o)
{
    for (size_t k = 0; k < o->effects; k++) {
        lac_driver_effect_clear(&o->effect[k]);
    }
    free(o->effect);
}

// In ln of the remaining time, about the median.
static void widen(lac_forecast *f)
{
    static const double normal50 = 0.6744897501960817, normal90 = 1.6448536269514722;
    const double now = f->issue_time;
    const double middle = log(f->time - now);
    double *const end[] = {&f->low90, &f->low50, &f->high50, &f->high90};
    for (size_t k = 0; k < sizeof end / sizeof *end && isfinite(middle); k++) {
        const double off = log(*end[k] - now) - middle;
        const double more = driven_spread * (k == 1 || k == 2 ? normal50 : normal90);
        *end[k] = now + exp(middle + copysign(hypot(off, more), k < 2 ? -1.0 : 1.0));
    }
}

// Takes a forecast back where a driver explains the rate and what remains does not accelerate, and
// widens its intervals where what remains does, or may. Baseline and a model of its own, which
// knows its loads, are left alone.
static void temper(const lac_forecast_set *o, lac_forecast *f)
{
    bool driven = false;
    // a model that a caller brings has no fit in its row
    for (size_t k = 0; k < o->effects && f->issued && !f->kind->baseline && f->kind->fit != NULL;
         k++) {
        const lac_driver_effect *e = &o->effect[k];
        driven = driven || e->verdict == LAC_EXPLAINS;
        if (lac_driver_withholds(e)) {
            f->issued = false;
            (void)lac_forecast_fit_refuse(&f->fit,
                                          "withheld: %.60s explains %.0f %% of the rate (p %.2g), "
                                          "and what remains does not accelerate",
                                          e->driver->name, 100.0 * e->share, e->p);
        }
    }
    if (driven && f->issued) {
        widen(f);
    }
}

static double mean_velocity(const lac_motion *m, size_t last, size_t count)
{
    double sum = 0.0;
    for (size_t i = last + 1 - count; i <= last; i++) {
        sum += m->velocity[i];
    }
    return sum / (double)count;
}

// By more than the last digits of the numbers could.
static bool accelerates(const lac_forecast_def *def, const lac_motion *m, size_t at)
{
    double squares = 0.0;
    for (size_t i = 0; i < def->long_run; i++) {
        const double part =
            (i < def->short_run ? 1.0 / (double)def->short_run : 0.0) - 1.0 / (double)def->long_run;
        const double rounding = part * m->rounding[at - i];
        squares += rounding * rounding;
    }
    return mean_velocity(m, at, def->short_run) - mean_velocity(m, at, def->long_run) >
           sqrt(squares);
}

// The first velocity of the long mean that the short one rose above, and stayed but for
// interruptions shorter than BRIDGED.
static size_t find_onset(const lac_forecast_def *def, const lac_motion *m)
{
    size_t onset = m->velocities - 1;
    size_t below = 0;
    for (size_t i = m->velocities; i-- > def->long_run - 1 && below < BRIDGED;) {
        bool above = accelerates(def, m, i);
        below = above ? 0 : below + 1;
        onset = above ? i : onset;
    }
    return onset + 1 - def->long_run;
}

static double largest(size_t n, const double *value, double from)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs(value[i] - from));
    }
    return most;
}

// Whether squares of what the methods fit, or of its inverse, are beyond all numbers.
static bool is_out_of_range(const lac_motion *m)
{
    const double v = largest(m->velocities, m->velocity, 0.0);
    const double d = m->n > 0 ? largest(m->n, m->displacement, m->displacement[0]) : 0.0;
    return !(v <= beyond && d <= beyond) || (v > 0.0 && v < 1.0 / beyond) ||
           (d > 0.0 && d < 1.0 / beyond);
}

// The gate of --onset: an onset of acceleration by means.
static bool has_onset(const lac_forecast_def *def, const lac_motion *m, char *reason)
{
    const size_t last = m->velocities - 1;
    if (m->velocities < def->long_run) {
        (void)snprintf(reason, LAC_FORECAST_TEXT, "too few readings: %zu velocities, at least %zu",
                       m->velocities, def->long_run);
    } else if (!accelerates(def, m, last)) {
        (void)snprintf(reason, LAC_FORECAST_TEXT,
                       "no acceleration: the mean of %zu velocities, %.3g m/s, is not above that "
                       "of %zu, %.3g m/s%s",
                       def->short_run, mean_velocity(m, last, def->short_run), def->long_run,
                       mean_velocity(m, last, def->long_run),
                       mean_velocity(m, last, def->short_run) >
                               mean_velocity(m, last, def->long_run)
                           ? ", by more than the last digits"
                           : "");
    }
    return reason[0] == '\0';
}

// Off the least-squares line of x over t, or off the mean of x where it must be level.
static double rms_off_line(size_t n, const double *t, const double *x, bool level, double *slope)
{
    lac_line line = {0};
    for (size_t i = 0; i < n; i++) {
        lac_line_add(&line, level ? 0.0 : t[i], x[i]);
    }
    *slope = level ? 0.0 : lac_line_slope(&line);
    return sqrt(line.rest / line.n);
}

// The gate that takes the onset's place with --since: more than a line, rounded to the last digit.
static bool is_curved(const lac_motion *m, double since, char *reason)
{
    const size_t size = m->integrated ? m->velocities : m->n;
    const double *time = m->integrated ? m->velocity_time : m->time;
    const size_t first = lac_first_at(size, time, since);
    const size_t n = size - first;
    double slope = 0.0;
    if (n < LINE) {
        (void)snprintf(reason, LAC_FORECAST_TEXT,
                       "too few readings: %zu since --since, at least %d", n, (int)LINE);
        return false;
    }
    const double off =
        rms_off_line(n, time + first, (m->integrated ? m->velocity : m->displacement) + first,
                     m->integrated, &slope);
    const double digit = m->integrated ? m->rounding[size - 1] : m->resolution;
    if (off <= 0.5 * digit + 2.0 * DBL_EPSILON * fabs(slope * time[size - 1])) {
        (void)snprintf(reason, LAC_FORECAST_TEXT,
                       "no acceleration: the %zu readings since --since are those of a steady "
                       "motion, but for the last digits",
                       n);
    }
    return reason[0] == '\0';
}

// The reading that the onset's first interval begins with.
static double start_of(const lac_forecast_def *def, const lac_motion *m)
{
    const double onset = m->velocity_time[find_onset(def, m)];
    double start = onset;
    for (size_t i = 0; i < m->n && m->time[i] <= onset; i++) {
        start = m->time[i];
    }
    return start;
}

// The gate that knows the noise.
static bool rises(const lac_trend *t, char *reason)
{
    const double mm_day = 1e3 * 86400.0;
    if (t->answer == LAC_CANNOT_TELL) {
        (void)snprintf(reason, LAC_FORECAST_TEXT, "cannot tell whether it accelerates: %s",
                       t->reason);
    } else if (t->answer == LAC_DOES_NOT) {
        (void)snprintf(reason, LAC_FORECAST_TEXT,
                       "no acceleration: over the last %zu readings the rate, %.3g mm/day, rose by "
                       "%.2g with an error of %.2g mm/day (p %.2g)",
                       t->n, mm_day * t->rate, mm_day * t->rise, mm_day * t->error, t->p);
    }
    return t->answer == LAC_DOES;
}

// What stands before any method: whether the readings make sense, and the slope accelerates.
// @param reason  [LAC_FORECAST_TEXT] why no method is asked; "": all are
// @return whether methods can be asked, were there not the reason
static bool pass_gates(const lac_forecast_def *def, lac_forecast_set *o, char *reason)
{
    const lac_motion *m = o->motion;
    char none[LAC_FORECAST_TEXT] = "";
    const bool rising = def->onset ? has_onset(def, m, none) : rises(&o->verdict.trend, none);
    bool sound = false;
    o->window_start = !isnan(def->since) ? def->since
                      : !def->onset      ? o->verdict.trend.start
                      : rising           ? start_of(def, m)
                                         : NAN;
    if (m->disbelieved > 0) {
        (void)snprintf(reason, LAC_FORECAST_TEXT, "%s", o->verdict.trend.reason);
    } else if (is_out_of_range(m)) {
        (void)snprintf(reason, LAC_FORECAST_TEXT,
                       "out of range: velocities or displacements come above %.0e m/s or m, or all "
                       "stay below %.0e",
                       beyond, 1.0 / beyond);
    } else {
        sound = m->velocities > 0;
        if (!rising && (isnan(def->since) || !sound)) {
            (void)snprintf(reason, LAC_FORECAST_TEXT, "%s", none);
        } else if (!rising) {
            (void)is_curved(m, def->since, reason);
        }
    }
    o->asked = reason[0] == '\0';
    o->accelerating = rising && o->asked;
    return sound && !isnan(o->window_start);
}

lac_forecast_def lac_forecast_default(void)
{
    return (lac_forecast_def){.since = NAN,
                              .short_run = 3,
                              .long_run = 7,
                              .levels = lac_levels_default(),
                              .window_time = INFINITY};
}

static lac_status check(const lac_forecast_def *def, const lac_readings *readings, lac_error *err)
{
    LAC_FAIL_IF(readings->n == 0, err, LAC_EINPUT, "there is no reading to forecast from");
    LAC_FAIL_IF(def->short_run < 1 || def->long_run <= def->short_run ||
                    def->long_run > LONGEST_RUN,
                err, LAC_EINPUT,
                "the means of the onset must be of 1 or more velocities, and of more, at most %d",
                (int)LONGEST_RUN);
    LAC_FAIL_IF(!(def->window_time > 0.0), err, LAC_EINPUT, "the window must be longer than 0 s");
    return LAC_OK;
}

// A method's answer, kept back where there is a reason.
static lac_status answer(const lac_forecast_def *def, const lac_forecast_set *o,
                         const lac_window *w, const char *reason, lac_forecast *f, lac_error *err)
{
    *f = (lac_forecast){
        .kind = f->kind,
        .issue_time = o->issue_time,
        .window_start = NAN,
        .time = NAN,
        .raw_time = NAN,
        .low50 = NAN,
        .high50 = NAN,
        .low90 = NAN,
        .high90 = NAN,
        .fit = {.remaining = NAN, .error = NAN, .rms = NAN, .misfit = NAN, .excess = NAN}};
    if (w != NULL) {
        LAC_TRY_RETURN(lac_forecast_ask(def, o->motion, w, f, err));
    }
    if (reason[0] != '\0') {
        f->issued = false;
        return lac_forecast_fit_refuse(&f->fit, "%s", reason);
    }
    if (f->issued && f->time <= o->issue_time) { // the last value is older than the time of issue
        f->issued = false;
        return lac_forecast_fit_refuse(
            &f->fit, "the time that it gives is over: no failure has come, or no value");
    }
    temper(o, f);
    return LAC_OK;
}

// Asks the methods of what came since `start`; a second time a model of its own, which knows no
// window, is not asked again.
static lac_status ask_all(const lac_forecast_def *def, lac_forecast_set *o, double start,
                          bool again, const char *reason, lac_error *err)
{
    lac_window *w = NULL;
    lac_status status = LAC_OK;
    if (!isnan(start)) {
        LAC_TRY_RETURN(lac_window_create(o->motion, start, &w, err));
    }
    for (size_t k = 0; k < o->count && status == LAC_OK; k++) {
        o->forecast[k].kind = lac_forecast_kind_of(def, k);
        if (!again || o->forecast[k].kind->fit != NULL) {
            status = answer(def, o, w, reason, &o->forecast[k], err);
        }
    }
    free(w);
    return status;
}

static size_t issued(const lac_forecast_set *o)
{
    size_t n = 0;
    for (size_t k = 0; k < o->count; k++) {
        n += o->forecast[k].issued && !o->forecast[k].kind->baseline ? 1 : 0;
    }
    return n;
}

// Near failure a window that begins long before is a bad fit: its last half is asked, and half of
// that, until as many methods issue as a pool needs; the first of those of which most do stays.
static lac_status ask_later(const lac_forecast_def *def, lac_forecast_set *o, lac_error *err)
{
    const lac_motion *m = o->motion;
    const size_t size = o->count * sizeof *o->forecast;
    size_t first = lac_first_at(m->n, m->time, o->window_start);
    size_t most = issued(o);
    lac_status status = LAC_OK;
    lac_forecast *best = malloc(size);
    LAC_FAIL_MEMORY_IF(best == NULL, err);
    memcpy(best, o->forecast, size);
    while (status == LAC_OK && most < LAC_POOLED && m->n - first >= 2 * LEAST_LATER) {
        first += (m->n - first) / 2;
        status = ask_all(def, o, m->time[first], true, "", err);
        if (status == LAC_OK && issued(o) > most) {
            most = issued(o);
            o->window_start = m->time[first];
            memcpy(best, o->forecast, size);
        }
    }
    memcpy(o->forecast, best, size);
    free(best);
    return status;
}

// Readings that fall and rise say nothing of a rate.
static lac_trend trend_of(const lac_motion *m)
{
    lac_trend t = lac_trend_find(m);
    if (m->disbelieved > 0) {
        t = (lac_trend){.p = NAN, .start = NAN, .rate = NAN, .rise = NAN, .error = NAN};
        (void)snprintf(t.reason, sizeof t.reason,
                       "falls and rises: %zu of %zu readings would be resets of the sensor, too "
                       "many to believe: --raw takes the readings as they are",
                       m->disbelieved, m->n);
    }
    return t;
}

static lac_status forecast(lac_forecast_set *o, const lac_forecast_def *def, lac_error *err)
{
    char reason[LAC_FORECAST_TEXT] = "";
    o->verdict.trend = trend_of(o->motion);
    const bool sound = pass_gates(def, o, reason);
    const bool ask = o->asked || (def->all && sound);
    LAC_TRY_RETURN(ask_all(def, o, ask ? o->window_start : (double)NAN, false, reason, err));
    if (o->asked && isnan(def->since) && !def->onset) {
        LAC_TRY_RETURN(ask_later(def, o, err));
    }
    lac_verdict_find(def, o);
    return LAC_OK;
}

lac_status lac_forecast_set_create(const lac_forecast_def *def, const lac_readings *readings,
                                   lac_forecast_set **out, lac_error *err)
{
    const size_t count = lac_forecast_count(def);
    lac_readings seen;
    lac_status status;
    *out = NULL;
    LAC_TRY_RETURN(check(def, readings, err));
    LAC_TRY_RETURN(lac_readings_recent(readings, def->window_count, def->window_time, &seen, err));
    lac_forecast_set *o = *out = calloc(1, sizeof *o + count * sizeof *o->forecast);
    LAC_FAIL_MEMORY_IF(o == NULL, err);
    o->count = count;
    o->forecast = (lac_forecast *)(o + 1);
    LAC_TRY(lac_motion_create(&def->motion, &seen, &o->motion, err));
    o->issue_time = seen.time[seen.n - 1];
    LAC_TRY(explain_all(def, o, err));
    LAC_TRY(forecast(o, def, err));
out:
    LAC_MADE(status, out, lac_forecast_set_free);
}

void lac_forecast_set_free(lac_forecast_set *forecasts)
{
    if (forecasts != NULL) {
        lac_motion_free(forecasts->motion);
        free_effects(forecasts);
        free(forecasts);
    }
}
