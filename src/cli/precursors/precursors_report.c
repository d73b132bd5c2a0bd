// SPDX-License-Identifier: GPL-3.0-or-later
// What the precursors command found, as tables.
#include <math.h>
#include <stdio.h>

#include "cli/common/words.h"
#include "cli/precursors/precursors.h"

// A unit of times to failure, by how long the issue times span.
typedef struct unit {
    double seconds;
    const char *head, *name;
} unit;

static const unit units[] = {
    {86400.0, "days", "day"}, {3600.0, "hour", "hour"}, {60.0, "min", "min"}, {1.0, "s", "s"}};

static const unit *unit_of(const lac_rolling *roll)
{
    const double span = roll->issues > 0 ? roll->issue_time[roll->issues - 1] - roll->issue_time[0]
                                         : units[0].seconds;
    const double enough = 3.0;
    const unit *u = units;
    while (span < enough * u->seconds && u + 1 < units + sizeof units / sizeof *units) {
        u++;
    }
    return u;
}

static const char *when(const cli_precursors_result *r, double t, char *text, size_t size)
{
    return cli_watched_time(r->watched, t, text, size);
}

static void print_input(const cli_precursors_result *r)
{
    const lac_readings *in = &r->watched->readings;
    const lac_motion *m = r->outlook->motion;
    const lac_series *s = r->watched->series;
    char first[40], last[40];
    printf("%s\n", r->watched->path);
    cli_row("readings", "%zu from %s to %s", in->n, when(r, in->time[0], first, sizeof first),
            when(r, in->time[in->n - 1], last, sizeof last));
    if (s != NULL) {
        cli_row("  of which", "%zu missing, %zu duplicates dropped, %zu out of order", s->missing,
                s->duplicates, s->disordered);
    }
    if (isfinite(m->interval)) { // of two readings and more
        cli_row("  intervals", "%s (median), longest %s, %zu gaps", cli_amount(m->interval, "s").s,
                cli_amount(m->longest_gap, "s").s, m->gaps);
    }
    cli_row("  cleaned", "%zu outliers dropped, %zu resets of the sensor taken out", m->outliers,
            m->resets);
    if (m->falling) {
        cli_row("  direction",
                "falls (settlement, line of sight): what follows is of its negative");
    }
    if (isfinite(m->noise)) {
        cli_row_quantity("  noise", m->noise, "m");
    }
    cli_row("issued", "%s", when(r, r->outlook->issue_time, first, sizeof first));
    if (r->outlook->asked && !r->outlook->accelerating) {
        cli_row("", "it does not accelerate: --since has the methods asked all the same");
    }
    if (r->outlook->asked) {
        cli_row("fitted since", "%s", when(r, r->outlook->window_start, first, sizeof first));
    }
}

static void print_forecast(const cli_precursors_result *r, const lac_forecast *f)
{
    char time[40], low[40], high[40], range[90], rms[32];
    (void)snprintf(rms, sizeof rms, "%.3g %s", f->fit.rms,
                   f->fit.rms_unit != NULL ? f->fit.rms_unit : "");
    if (f->fit.rms_unit == NULL) {
        (void)snprintf(rms, sizeof rms, "-");
    }
    if (!f->issued) {
        printf("  %-12s %-17s not issued: %s\n", f->kind->about.name,
               when(r, f->time, time, sizeof time), f->fit.reason);
        return;
    }
    (void)snprintf(range, sizeof range, "%s to %s", when(r, f->low50, low, sizeof low),
                   when(r, f->high50, high, sizeof high));
    printf("  %-12s %-17s %-36s ", f->kind->about.name, when(r, f->time, time, sizeof time), range);
    (void)snprintf(range, sizeof range, "%s to %s", when(r, f->low90, low, sizeof low),
                   when(r, f->high90, high, sizeof high));
    printf("%-36s %s\n", range, rms);
}

static double value_of(const lac_finding *fit, const char *key)
{
    double value = NAN;
    for (size_t i = 0; i < fit->count; i++) {
        value = fit->value[i].key == key ? fit->value[i].value : value;
    }
    return value;
}

// What stands at the end of its range is no estimate.
static void print_ends(const lac_outlook *o)
{
    for (size_t k = 0; k < o->count; k++) {
        const lac_finding *fit = &o->forecast[k].fit;
        for (size_t i = 0; i < fit->ends; i++) {
            printf("  %-12s the best fit's %s stands at the end of its range, %.4g\n",
                   i == 0 ? o->forecast[k].kind->about.name : "", fit->end[i],
                   value_of(fit, fit->end[i]));
        }
    }
}

// Calibrated intervals know how late or early a method is.
static void print_beside(const lac_outlook *o)
{
    bool beside = false;
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        beside = beside || (f->issued && !(f->low50 <= f->time && f->time <= f->high50));
    }
    if (beside) {
        printf(
            "  A time beside its 50 %% interval: by so much the method is late, or early, where it "
            "was calibrated.\n");
    }
}

static void print_values(const lac_outlook *o)
{
    printf("\n");
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        if (f->fit.count == 0) {
            continue;
        }
        printf("  %-12s", f->kind->about.name);
        for (size_t i = 0; i < f->fit.count; i++) {
            printf(" %s %.4g", f->fit.value[i].key, f->fit.value[i].value);
        }
        printf(", %zu points, misfit %.2g, error %.2g\n", f->fit.points, f->fit.misfit,
               f->fit.error);
    }
}

// What is computed, and what to cite.
static void print_methods(const lac_outlook *o)
{
    char text[600];
    printf("\n");
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast_kind *kind = o->forecast[k].kind;
        (void)snprintf(text, sizeof text, "%s: %s; %s", kind->about.name, kind->estimator,
                       kind->about.reference);
        cli_wrap("  ", text);
    }
}

// Time left by each method at each issue time; "." where none was issued.
static void print_lives(const cli_precursors_result *r)
{
    const lac_rolling *roll = r->rolling;
    const unit *u = unit_of(roll);
    char text[40];
    (void)snprintf(text, sizeof text, "life expectancy (%s)", u->head);
    printf("\n  %-22s %s", text, isfinite(r->watched->failed_at) ? "     true" : "");
    for (size_t k = 0; k < roll->methods; k++) {
        printf(" %11s", roll->forecast[k].kind->about.name);
    }
    printf("\n");
    for (size_t i = 0; i < roll->issues; i++) {
        const double now = roll->issue_time[i];
        bool any = false;
        for (size_t k = 0; k + 1 < roll->methods; k++) {
            any = any || roll->forecast[i * roll->methods + k].issued;
        }
        if (!any) {
            continue;
        }
        printf("  %-22s", when(r, now, text, sizeof text));
        if (isfinite(r->watched->failed_at)) {
            printf(" %9.3g", (r->watched->failed_at - now) / u->seconds);
        }
        for (size_t k = 0; k < roll->methods; k++) {
            const lac_forecast *f = &roll->forecast[i * roll->methods + k];
            if (f->issued) {
                printf(" %11.3g", (f->time - now) / u->seconds);
            } else {
                printf(" %11s", ".");
            }
        }
        printf("\n");
    }
}

static const char *share(size_t part, size_t all, char *text, size_t size)
{
    if (all == 0) {
        return "-";
    }
    (void)snprintf(text, size, "%.0f %%", 100.0 * (double)part / (double)all);
    return text;
}

static const char *number(double value, char *text, size_t size)
{
    (void)snprintf(text, size, isnan(value) ? "-" : "%.3g", value);
    return text;
}

static void print_skill(const cli_precursors_result *r)
{
    const unit *u = unit_of(r->rolling);
    char a[16], b[16], c[16], d[16], e[16];
    (void)snprintf(a, sizeof a, "error (%s)", u->name);
    (void)snprintf(b, sizeof b, "CRPS (%s)", u->name);
    printf("\n  %-12s %7s %12s %10s %10s %10s %10s   %s\n", "skill", "issued", a, "in 50 %",
           "in 90 %", b, "baseline", "alarms: hits, false, missed");
    for (size_t k = 0; k < r->rolling->methods; k++) {
        const lac_skill *s = &r->skill[k];
        printf("  %-12s %3zu/%-3zu %12s %10s %10s %10s %10s   %zu: %zu, %zu, %zu\n",
               s->kind->about.name, s->issued, s->asked, number(s->error / u->seconds, a, sizeof a),
               share(s->inside50, isnan(s->crps) ? 0 : s->issued, b, sizeof b),
               share(s->inside90, isnan(s->crps) ? 0 : s->issued, c, sizeof c),
               number(s->crps / u->seconds, d, sizeof d),
               number(s->persistence_crps / u->seconds, e, sizeof e), s->alarms, s->hits,
               s->false_alarms, s->misses);
    }
    printf("  An alarm: failure within %s with a chance of three in four.\n",
           cli_amount(r->plan->horizon, "s").s);
}

void cli_precursors_print(const cli_precursors_result *r, bool verbose)
{
    print_input(r);
    if (r->outlook->asked) {
        printf("\n  %-12s %-17s %-36s %-36s %s\n", "method", "failure", "50 % interval",
               "90 % interval", "rms");
    } else {
        cli_row("no forecast", "%s", r->outlook->forecast[0].fit.reason);
    }
    for (size_t k = 0; r->outlook->asked && k < r->outlook->count; k++) {
        print_forecast(r, &r->outlook->forecast[k]);
    }
    print_beside(r->outlook);
    print_ends(r->outlook);
    if (verbose) {
        print_values(r->outlook);
        print_methods(r->outlook);
    }
    cli_indicators_print(r->indicators, r->indicator);
    if (r->rolling != NULL) {
        print_lives(r);
        cli_course_print(r);
    }
    if (r->skill != NULL) {
        print_skill(r);
    }
    if (r->output != NULL) {
        printf("\n");
        cli_row("file", "%s", r->output);
    }
}
