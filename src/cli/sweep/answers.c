// SPDX-License-Identifier: GPL-3.0-or-later
// What an ensemble says, in words: how likely it fails, when, and what decides.
#include "cli/sweep/answers.h"

#include "cli/common/words.h"

enum { SHOWN = 12 }; // parameters that are told of

static cli_text percent(double share)
{
    return cli_format(share > 0.0 && share < 0.001 ? "%.2g" : "%.3g", 100.0 * share);
}

static cli_text amount(double value, const char *unit)
{
    return isnan(value)   ? cli_format("?")
           : isinf(value) ? cli_format("never")
                          : cli_amount(value, unit != NULL ? unit : "1");
}

static void print_chance(const lac_answers *a)
{
    const lac_chance *c = &a->chance;
    const size_t all = c->known + c->unknown;
    if (all == 0) {
        cli_row("fails", "not known: all %zu members are broken", a->members);
        return;
    }
    cli_row("fails", "within %s in %s %% (%s to %s %%) of %zu members", amount(c->by, "s").s,
            isnan(c->share) ? "?" : percent(c->share).s, percent(c->low).s, percent(c->high).s,
            all);
    if (c->unknown > 0) {
        cli_row("", "%zu ended before without failure: the interval holds both", c->unknown);
    }
}

static void print_quantiles(const lac_answers *a)
{
    static const char *const label[] = {"5 % fail within", "25 %", "50 %", "75 %", "95 %"};
    for (size_t q = 0; q < LAC_ANSWERS_QUANTILES && a->counted > 0; q++) {
        const lac_quantile_answer *one = &a->quantile[q];
        if (isinf(one->low)) {
            cli_row(label[q], "never");
            continue;
        }
        cli_row(label[q], "%-12s (%s to %s)", amount(one->value, a->unit).s,
                amount(one->low, a->unit).s, amount(one->high, a->unit).s);
    }
}

static cli_text index_text(double value, double error)
{
    return isnan(value) ? cli_format("-") : cli_format("%.2f +- %.2f", value + 0.0, error);
}

static void print_influence(const lac_answers *a, const lac_influence *one)
{
    const bool total = !isnan(one->total);
    const char *sign = isnan(one->rank) || fabs(one->rank) < 0.05 ? ""
                       : one->rank < 0.0                          ? ", more of it: sooner"
                                                                  : ", more of it: later";
    printf("    %s\n", one->key != NULL ? one->key : "?");
    cli_row("", "first %s%s%s%s", index_text(one->first, one->first_error).s,
            total ? ", total " : "", total ? index_text(one->total, one->total_error).s : "", sign);
    (void)a;
}

static void print_influences(const lac_answers *a)
{
    const lac_influence *first = a->influence;
    if (a->params == 0 || a->counted == 0) {
        return;
    }
    if (isnan(first->first)) {
        cli_row("what decides", "not known: %s",
                a->rows < 2 ? "too few members" : "it is the same in all members");
        return;
    }
    cli_row("what decides", "part of the variance of %s, alone%s",
            a->of_chance ? "whether it fails by then" : "when it fails",
            isnan(first->total) ? "" : " (first) and with the others (total)");
    for (size_t p = 0; p < a->params && p < SHOWN; p++) {
        print_influence(a, &a->influence[p]);
    }
    if (a->params > SHOWN) {
        cli_row("", "and %zu less than these", a->params - SHOWN);
    }
}

static cli_text said(const char *word, double value, const char *unit)
{
    return word != NULL ? cli_format("%s", word) : amount(value, unit);
}

static void print_swings(const lac_answers *a)
{
    cli_row("as it stands", "%s %s", isinf(a->base) ? "fails" : "fails after",
            amount(a->base, a->unit).s);
    cli_row("one at a time", "%-28s %s", "low: fails after", "high: fails after");
    for (size_t p = 0; p < a->params; p++) {
        const lac_swing *s = &a->swing[p];
        printf("    %s\n", s->key != NULL ? s->key : "?");
        cli_row("", "%-28s %s",
                cli_format("%s: %s", said(s->low_word, s->low, s->unit).s,
                           amount(s->result_low, a->unit).s)
                    .s,
                cli_format("%s: %s", said(s->high_word, s->high, s->unit).s,
                           amount(s->result_high, a->unit).s)
                    .s);
    }
}

void cli_answers_print(const lac_answers *a)
{
    cli_row("members", "%zu, of which %zu %s not fail within their time, %zu broken", a->members,
            a->never, a->never == 1 ? "does" : "do", a->broken);
    if (a->tornado) {
        print_swings(a);
        return;
    }
    print_chance(a);
    print_quantiles(a);
    print_influences(a);
}
