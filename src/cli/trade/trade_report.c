// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade came to, in words.
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/common/words.h"
#include "cli/trade/trade.h"

// "0.12 %", "3e-07"
static cli_text error_text(double error)
{
    return isnan(error)        ? cli_format("-")
           : error >= 9.995e-4 ? cli_format("%.2g %%", 100.0 * error)
                               : cli_format("%.1e", error);
}

static cli_text asked_text(const lac_trade_request *ask, const char *unit)
{
    cli_text error = {""};
    if (!isnan(ask->within)) {
        error = cli_exact(ask->within, unit);
    } else if (!isnan(ask->reach) || isnan(ask->budget)) {
        error = cli_format("%.3g %%", 100.0 * (isnan(ask->reach) ? 0.01 : ask->reach));
    }
    const bool both = error.s[0] != '\0' && !isnan(ask->budget);
    return cli_format("%s%s%s", error.s, both ? " within " : "",
                      isnan(ask->budget) ? "" : cli_amount(ask->budget, "s").s);
}

// "error 0.05 % +- 1e-07, 0.12 s of CPU, 24 MB"
static cli_text run_text(const lac_trade_outcome *o, size_t run)
{
    const lac_trade_measure *m = &o->measure[run];
    return cli_format("error %s +- %s, %s of CPU, %.3g MB", error_text(o->verdict->error[run]).s,
                      error_text(o->verdict->uncertainty).s, cli_amount(m->cpu_time, "s").s,
                      (double)m->memory / 1e6);
}

// "--set solver.rtol=0.001"; what is no run in time has its command named.
static cli_text choice_text(const lac_trade_outcome *o, size_t run)
{
    char options[LAC_TEXT_ROOM];
    const char *command = lac_trade_command(o->plan, run);
    if (*lac_trade_options(o, run, options) == '\0') {
        return cli_format("the case as it is");
    }
    return strcmp(command, "run") == 0 ? cli_format("%s", options)
                                       : cli_format("lacuna %s with %s", command, options);
}

void cli_trade_sentence(const lac_trade_outcome *o, const lac_trade_request *ask, char *text,
                        size_t size)
{
    const lac_trade_result *v = o->verdict;
    const cli_text asked = asked_text(ask, lac_quantity_about_of(v->quantity)->unit);
    const bool any = v->recommended != SIZE_MAX;
    const size_t run = any ? v->recommended : v->closest;
    int used = run == SIZE_MAX
                   ? snprintf(text, size, "Nothing tried has this quantity.")
                   : snprintf(text, size,
                              any ? "For %s: %s (%s)."
                                  : "Nothing tried does for %s; the closest is %s (%s).",
                              asked.s, choice_text(o, run).s, run_text(o, run).s);
    if (isnan(v->uncertainty)) {
        (void)snprintf(text + used, size - (size_t)used,
                       " The reference's own error is not known: no coarser run was done.");
    }
}

// The settings of a run, or their names, as wide as the widest of the table.
static void print_dials(const lac_trade_outcome *o, const lac_trade_settings *settings)
{
    for (size_t d = 0; d < o->plan->settings; d++) {
        const lac_trade_setting *setting = &o->plan->setting[d];
        size_t width = strlen(setting->setting->name);
        for (size_t i = 0; i < o->rows; i++) {
            const size_t n = strlen(o->settings[o->row[i].run].label[d]);
            width = n > width ? n : width;
        }
        if (setting->shown > 0) {
            printf(" %-*s", (int)width,
                   settings != NULL ? settings->label[d] : setting->setting->name);
        }
    }
}

static void print_row(const lac_trade_outcome *o, size_t run)
{
    const lac_trade_measure *m = &o->measure[run];
    const bool none = lac_trade_of_run(o->plan, run) == LAC_OF_CASCADE; // it has no steps
    printf("%c ", o->verdict->on_front[run] ? '*' : ' ');
    print_dials(o, &o->settings[run]);
    if (m->end != LAC_TRADE_DONE) {
        printf("  %s: %s\n", lac_trade_end_name(m->end), m->message);
        return;
    }
    printf(" %9s +- %-7s %10s %10s %8.3g %9s\n", error_text(o->verdict->error[run]).s,
           error_text(o->verdict->uncertainty).s, cli_amount(m->cpu_time, "s").s,
           cli_amount(m->wall_time, "s").s, (double)m->memory / 1e6,
           none ? "-" : cli_format("%" PRId64, m->steps).s);
}

void cli_trade_print(const lac_trade_outcome *o, const cli_request *request)
{
    char settings[LAC_TEXT_ROOM];
    const lac_trade_result *v = o->verdict;
    const lac_quantity_about *info = lac_quantity_about_of(v->quantity);
    if (o->title != NULL) {
        puts(o->title);
    }
    cli_row(info->doc, "%s +- %s", cli_amount(v->value, info->unit).s,
            error_text(v->uncertainty).s);
    cli_row("reference", "%s", lac_trade_settings_text(o, v->reference, settings));
    printf("\n  ");
    print_dials(o, NULL);
    printf(" %9s    %-7s %10s %10s %8s %9s\n", "error", "", "CPU", "wall", "MB", "steps");
    for (size_t i = 0; i < o->rows; i++) {
        print_row(o, o->row[i].run);
    }
    for (size_t i = 0; i < o->refusals; i++) {
        cli_say(request, "refused: %s", o->measure[o->refused[i]].message);
    }
    printf("  * on the front: no other errs and costs less%s\n\n",
           o->refusals > 0 ? "; settings that do not go together were left out (-v)" : "");
    cli_wrap("", o->sentence);
}
