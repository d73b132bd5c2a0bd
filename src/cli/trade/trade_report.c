// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade came to, in words.
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
static cli_text run_text(const lac_trade_run *run)
{
    return cli_format("error %s +- %s, %s of CPU, %.3g MB", error_text(run->error).s,
                      error_text(run->uncertainty).s, cli_amount(run->m.cpu_time, "s").s,
                      run->m.memory / 1e6);
}

// "--set solver.rtol=0.001"; what is no run in time has its command named.
static cli_text choice_text(const lac_trade_run *run)
{
    char options[LAC_TEXT_ROOM];
    const char *command = lac_trade_command(run);
    if (*lac_trade_options(run, options) == '\0') {
        return cli_format("the case as it is");
    }
    return strcmp(command, "run") == 0 ? cli_format("%s", options)
                                       : cli_format("lacuna %s with %s", command, options);
}

void cli_trade_sentence(lac_trade *t, const lac_trade_request *ask)
{
    const size_t size = sizeof t->sentence;
    const cli_text asked = asked_text(ask, lac_quantities[t->quantity].unit);
    const lac_trade_run *run = t->recommended != NULL ? t->recommended : t->closest;
    int used = run == NULL ? snprintf(t->sentence, size, "Nothing tried has this quantity.")
                           : snprintf(t->sentence, size,
                                      run == t->recommended
                                          ? "For %s: %s (%s)."
                                          : "Nothing tried does for %s; the closest is %s (%s).",
                                      asked.s, choice_text(run).s, run_text(run).s);
    if (isnan(t->reference->uncertainty)) {
        (void)snprintf(t->sentence + used, size - (size_t)used,
                       " The reference's own error is not known: no coarser run was done.");
    }
}

// The settings of a run, or their names, as wide as the widest of the table.
static void print_dials(const lac_trade *t, const lac_trade_run *run)
{
    for (size_t d = 0; d < t->settings; d++) {
        const char *name = t->setting[d].setting->name;
        size_t width = strlen(name);
        for (size_t i = 0; i < t->rows; i++) {
            const size_t n = strlen(t->row[i]->label[d]);
            width = n > width ? n : width;
        }
        if (t->setting[d].shown > 0) {
            printf(" %-*s", (int)width, run != NULL ? run->label[d] : name);
        }
    }
}

static void print_row(const lac_trade *t, const lac_trade_run *run)
{
    const bool none = lac_trade_of_run(t, run) == LAC_OF_CASCADE; // it has no steps
    printf("%c ", run->on_front ? '*' : ' ');
    print_dials(t, run);
    if (run->end != LAC_TRADE_DONE) {
        printf("  %s: %s\n", lac_trade_end_name(run->end), run->message);
        return;
    }
    printf(" %9s +- %-7s %10s %10s %8.3g %9s\n", error_text(run->error).s,
           error_text(run->uncertainty).s, cli_amount(run->m.cpu_time, "s").s,
           cli_amount(run->m.wall_time, "s").s, run->m.memory / 1e6,
           none ? "-" : cli_format("%.0f", run->m.steps).s);
}

void cli_trade_print(const lac_trade *t, const cli_request *request)
{
    char settings[LAC_TEXT_ROOM];
    const lac_quantity_about *info = &lac_quantities[t->quantity];
    if (t->title != NULL) {
        puts(t->title);
    }
    cli_row(info->doc, "%s +- %s", cli_amount(t->reference->value, info->unit).s,
            error_text(t->reference->uncertainty).s);
    cli_row("reference", "%s", lac_trade_settings_text(t->reference, settings));
    printf("\n  ");
    print_dials(t, NULL);
    printf(" %9s    %-7s %10s %10s %8s %9s\n", "error", "", "CPU", "wall", "MB", "steps");
    for (size_t i = 0; i < t->rows; i++) {
        print_row(t, t->row[i]);
    }
    for (size_t i = 0; i < t->refusals; i++) {
        cli_say(request, "refused: %s", t->row[t->rows + i]->message);
    }
    printf("  * on the front: no other errs and costs less%s\n\n",
           t->refusals > 0 ? "; settings that do not go together were left out (-v)" : "");
    cli_wrap("", t->sentence);
    cli_row("file", "%s", t->path);
}
