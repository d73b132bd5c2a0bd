// SPDX-License-Identifier: GPL-3.0-or-later
// What the precursors command found, as tables.
#include "cli/precursors/precursors.h"

// The unit of times to failure, by how long the issue times span.
static const cli_time_unit *unit_of(const lac_rolling *roll)
{
    const double enough = 3.0;
    return cli_time_unit_of(
        roll->issues > 0 ? roll->issue_time[roll->issues - 1] - roll->issue_time[0] : 86400.0,
        enough);
}

static void print_input(const lac_forecast_outcome *of)
{
    const lac_readings *in = of->readings;
    const lac_forecast_set *o = of->forecasts;
    const lac_motion *m = o->motion;
    const lac_series *s = of->series;
    cli_row("readings", "%zu from %s", in->n,
            cli_watched_span(of, in->time[0], in->time[in->n - 1]).s);
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
    cli_row("issued", "%s", cli_watched_time(of, o->issue_time).s);
    if (o->asked && !o->accelerating) {
        cli_row("", "nothing says that it accelerates: --since runs the methods all the same");
    }
    if (o->asked) {
        cli_row("fitted since", "%s", cli_watched_time(of, o->window_start).s);
    }
}

static void print_forecast(const lac_forecast_outcome *of, const lac_forecast *f)
{
    printf("  %-12s %-17s ", f->kind->info.name, cli_watched_time(of, f->time).s);
    if (!f->issued) {
        printf("not issued: %s\n", f->fit.reason);
        return;
    }
    printf("%-36s %-36s %s\n", cli_watched_span(of, f->low50, f->high50).s,
           cli_watched_span(of, f->low90, f->high90).s,
           f->fit.rms_unit == NULL ? "-" : cli_format("%.3g %s", f->fit.rms, f->fit.rms_unit).s);
}

// What stands at the end of its range is no estimate; what fits badly is less sure than it says.
static void print_doubts(const lac_forecast_set *o)
{
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast_fit *fit = &o->forecast[k].fit;
        for (size_t i = 0; i < fit->ends; i++) {
            printf("  %-12s the best fit's %s stands at the end of its range, %.4g\n",
                   i == 0 ? o->forecast[k].kind->info.name : "", fit->end[i],
                   lac_forecast_fit_find(fit, fit->end[i]));
        }
        if (fit->poor && o->forecast[k].issued) {
            printf("  %-12s fits badly: its residuals are no noise; trust its interval less\n",
                   o->forecast[k].kind->info.name);
        }
    }
}

static void print_values(const lac_forecast_set *o)
{
    printf("\n");
    for (size_t k = 0; k < o->count; k++) {
        const lac_forecast *f = &o->forecast[k];
        if (f->fit.count == 0) {
            continue;
        }
        printf("  %-12s", f->kind->info.name);
        for (size_t i = 0; i < f->fit.count; i++) {
            printf(" %s %.4g", f->fit.value[i].key, f->fit.value[i].value);
        }
        printf(", %zu points, misfit %.2g, error %.2g\n", f->fit.points, f->fit.misfit,
               f->fit.error);
    }
}

static void print_indicators(size_t count, const lac_precursor *indicator)
{
    printf("\n  indicator\n");
    for (size_t k = 0; k < count; k++) {
        const lac_forecast_fit *found = &indicator[k].found;
        printf("  %-19s", indicator[k].kind->info.name);
        for (size_t i = 0; i < found->count; i++) {
            const double value = found->value[i].value;
            printf(isnan(value) ? " %s -" : " %s %.4g", found->value[i].key, value);
        }
        if (found->reason[0] != '\0') {
            printf("%s%s\n", found->count > 0 ? "; " : " none: ", found->reason);
        } else {
            printf(", %zu points\n", found->points);
        }
    }
}

// Time left by each method at each issue time; "." where none was issued.
static void print_lives(const lac_forecast_outcome *of)
{
    const lac_rolling *roll = of->rolling;
    const cli_time_unit *u = unit_of(roll);
    printf("\n  %-22s %s", cli_format("life expectancy (%s)", u->head).s,
           isfinite(of->failed_at) ? "     true" : "");
    for (size_t k = 0; k < roll->methods; k++) {
        printf(" %11s", roll->forecast[k].kind->info.name);
    }
    printf("\n");
    for (size_t i = 0; i < roll->issues; i++) {
        const lac_forecast *f = &roll->forecast[i * roll->methods];
        const double now = roll->issue_time[i];
        bool any = false;
        for (size_t k = 0; k + 1 < roll->methods; k++) {
            any = any || f[k].issued;
        }
        if (!any) {
            continue;
        }
        printf("  %-22s", cli_watched_time(of, now).s);
        if (isfinite(of->failed_at)) {
            printf(" %9.3g", (of->failed_at - now) / u->seconds);
        }
        for (size_t k = 0; k < roll->methods; k++) {
            const cli_text left = cli_format("%.3g", (f[k].time - now) / u->seconds);
            printf(" %11s", f[k].issued ? left.s : ".");
        }
        printf("\n");
    }
}

// The level wherever it changes.
static void print_levels(const lac_forecast_outcome *of)
{
    const lac_rolling *roll = of->rolling;
    printf("\n  %-22s %-8s rule\n", "levels", "level");
    for (size_t i = 0; i < roll->issues; i++) {
        const lac_verdict *v = &roll->verdict[i];
        if (i == 0 || v->level != roll->verdict[i - 1].level) {
            printf("  %-22s %-8s %s\n", cli_watched_time(of, roll->issue_time[i]).s,
                   lac_level_name(v->level), v->rule);
        }
    }
}

// What the table shows of an indicator at an issue time; NaN: it has nothing to say.
static double headline(const lac_indicator_series *indicator_series, size_t issue, size_t kind)
{
    const lac_precursor *p = &indicator_series->found[issue * indicator_series->kinds + kind];
    return lac_forecast_fit_find(&p->found, p->kind->value[p->kind->headline].key);
}

// One number of each indicator at each time of issue at which any has one.
static void print_course(const lac_forecast_outcome *of)
{
    const lac_indicator_series *indicator_series = of->indicator_series;
    size_t shown[LAC_PRECURSORS_MAX], count = 0;
    for (size_t k = 0; k < indicator_series->kinds; k++) {
        size_t i = 0;
        while (i < indicator_series->issues && isnan(headline(indicator_series, i, k))) {
            i++;
        }
        if (i < indicator_series->issues) {
            shown[count++] = k;
        }
    }
    if (count == 0) {
        return;
    }
    printf("\n  indicators            ");
    for (size_t k = 0; k < count; k++) {
        printf(" %18s", lac_precursor_kind_get(shown[k])->info.name);
    }
    printf("\n  %-22s", "");
    for (size_t k = 0; k < count; k++) {
        const lac_precursor_kind *kind = lac_precursor_kind_get(shown[k]);
        printf(" %18s", kind->value[kind->headline].key);
    }
    printf("\n");
    for (size_t i = 0; i < indicator_series->issues; i++) {
        bool any = false;
        for (size_t k = 0; k < count; k++) {
            any = any || !isnan(headline(indicator_series, i, shown[k]));
        }
        if (any) {
            printf("  %-22s", cli_watched_time(of, of->rolling->issue_time[i]).s);
        }
        for (size_t k = 0; k < count && any; k++) {
            const double value = headline(indicator_series, i, shown[k]);
            printf(" %18s%s", isnan(value) ? "." : cli_format("%.4g", value).s,
                   k + 1 == count ? "\n" : "");
        }
    }
}

// Of those that were issued; "-" where there is no skill to tell of.
static cli_text share(size_t part, const lac_skill *s)
{
    return isnan(s->crps) || s->issued == 0
               ? cli_format("-")
               : cli_format("%.0f %%", 100.0 * (double)part / (double)s->issued);
}

static cli_text number(double value) { return cli_format(isnan(value) ? "-" : "%.3g", value); }

static void print_skill(const lac_forecast_outcome *of)
{
    const cli_time_unit *u = unit_of(of->rolling);
    printf("\n  %-12s %7s %12s %10s %10s %10s %10s   %s\n", "skill", "issued",
           cli_format("error (%s)", u->name).s, "in 50 %", "in 90 %",
           cli_format("CRPS (%s)", u->name).s, "baseline", "alarms: hits, false, missed");
    for (const lac_skill *s = of->skill; s < of->skill + of->rolling->methods; s++) {
        printf("  %-12s %3zu/%-3zu %12s %10s %10s %10s %10s   %zu: %zu, %zu, %zu\n",
               s->kind->info.name, s->issued, s->asked, number(s->error / u->seconds).s,
               share(s->inside50, s).s, share(s->inside90, s).s, number(s->crps / u->seconds).s,
               number(s->persistence_crps / u->seconds).s, s->alarms, s->hits, s->false_alarms,
               s->misses);
    }
    printf("  An alarm: failure within %s with a chance of three in four.\n",
           cli_amount(of->horizon, "s").s);
}

void cli_precursors_print(const lac_forecast_outcome *of, bool verbose)
{
    const lac_forecast_set *o = of->forecasts;
    char text[LAC_VERDICT_LONGEST];
    printf("%s\n", of->source);
    for (size_t k = 0; k < LAC_VERDICT_LINES; k++) { // what an engineer is told first
        cli_row_wrap(lac_verdict_about[k], lac_verdict_line(of, k, text, sizeof text));
    }
    putchar('\n');
    print_input(of);
    if (o->asked) {
        printf("\n  %-12s %-17s %-36s %-36s %s\n", "method", "failure", "50 % interval",
               "90 % interval", "rms");
    } else {
        cli_row("no forecast", "%s", o->forecast[0].fit.reason);
    }
    for (size_t k = 0; o->asked && k < o->count; k++) {
        print_forecast(of, &o->forecast[k]);
    }
    print_doubts(o);
    cli_drivers_print(o);
    if (verbose) {
        print_values(o);
        printf("\n");
        for (size_t k = 0; k < o->count; k++) {
            const lac_forecast_kind *kind = o->forecast[k].kind;
            cli_wrap(
                "  ",
                cli_format("%s: %s; %s", kind->info.name, kind->estimator, kind->info.reference).s);
        }
    }
    print_indicators(of->indicators, of->indicator);
    if (of->rolling != NULL) {
        print_levels(of);
        print_lives(of);
        print_course(of);
    }
    if (of->skill != NULL) {
        print_skill(of);
    }
}
