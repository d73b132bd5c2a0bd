// SPDX-License-Identifier: GPL-3.0-or-later
// What an ensemble says, in words: how likely it fails, when, and what decides.
#include "cli/sweep/answers.h"

#include "cli/common/words.h"
#include "cli/report/report.h"

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
        cli_row(a->plain ? "values" : "fails", "not known: %s",
                a->missing > 0 ? "no member has one" : "all members are broken");
        return;
    }
    if (a->plain && !a->of_chance) {
        return; // nobody asked how likely
    }
    cli_row(a->plain ? "at most" : "fails", "%s%s in %s %% (%s to %s %%) of %zu member%s",
            a->plain ? "" : "within ", amount(c->by, a->unit).s,
            isnan(c->share) ? "?" : percent(c->share).s, percent(c->low).s, percent(c->high).s, all,
            all == 1 ? "" : "s");
    if (c->unknown > 0) {
        cli_row("", "%zu ended before without failure: the interval holds both", c->unknown);
    }
}

static void print_quantiles(const lac_answers *a)
{
    static const char *const label[] = {"5 % fail within", "25 %", "50 %", "75 %", "95 %"};
    bool open = false;
    for (size_t q = 0; q < LAC_ANSWERS_QUANTILES && a->counted > 0; q++) {
        const lac_quantile_answer *one = &a->quantile[q];
        const char *name = q == 0 && a->plain ? "5 % are below" : label[q];
        if (isinf(one->low)) {
            cli_row(name, "never");
            continue;
        }
        cli_row(name, "%-12s (%s to %s)", amount(one->value, a->unit).s,
                amount(one->low, a->unit).s, amount(one->high, a->unit).s);
        open = open || isnan(one->low) || isnan(one->high);
    }
    if (open) {
        cli_row("", "?: so few members leave that end of the interval open");
    }
}

static cli_text index_text(double value, double error)
{
    return isnan(value) ? cli_format("-") : cli_format("%.2f +- %.2f", value + 0.0, error);
}

static void print_influence(const lac_answers *a, const lac_influence *one)
{
    static const char *const ends[2][2] = {{", more of it: sooner", ", more of it: later"},
                                           {", more of it: less", ", more of it: more"}};
    const bool total = !isnan(one->total), told = !isnan(one->rank) && fabs(one->rank) >= 0.05;
    const char *sign = told ? ends[a->plain][one->rank > 0.0] : "";
    printf("    %s\n", one->key != NULL ? one->key : "?");
    cli_row("", "first %s%s%s%s", index_text(one->first, one->first_error).s,
            total ? ", total " : "", total ? index_text(one->total, one->total_error).s : "", sign);
}

static void print_influences(const lac_answers *a)
{
    const lac_influence *first = a->influence;
    if (a->params == 0 || a->counted == 0) {
        return;
    }
    if (isnan(first->first)) { // what is known stands before what is not
        cli_row("what decides", "not known: %s",
                a->rows < 2 ? "too few members"
                : a->alike  ? "it is the same in all members"
                            : "too few members of like values to compare");
        return;
    }
    cli_row("what decides", "part of the variance of %s, alone%s",
            a->plain       ? (a->of_chance ? "whether it is that little" : a->name)
            : a->of_chance ? "whether it fails by then"
                           : "when it fails",
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
    const char *what = a->plain ? a->name : "fails after";
    cli_row("as it stands", "%s %s", isinf(a->base) ? "fails" : what, amount(a->base, a->unit).s);
    cli_row("one at a time", "%-28s %s", cli_format("low: %s", what).s,
            cli_format("high: %s", what).s);
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
    if (a->plain) {
        cli_row("result", "%s, %s", a->name, a->about);
        cli_row("members", "%zu, of which %zu have no such result, %zu broken", a->members,
                a->missing, a->broken);
    } else {
        cli_row("members", "%zu, of which %zu %s not fail within their time, %zu broken",
                a->members, a->never, a->never == 1 ? "does" : "do", a->broken);
    }
    if (a->tornado) {
        print_swings(a);
        return;
    }
    print_chance(a);
    print_quantiles(a);
    print_influences(a);
}

lac_status cli_question_read(const cli_request *request, const lac_case *c, size_t extras,
                             const lac_ensemble_extra *extra, cli_question *out, lac_error *err)
{
    const char *by = request->sweep.by;
    *out = (cli_question){.by = NAN};
    LAC_TRY_RETURN(lac_ensemble_result_find(request->sweep.of, extras, extra, &out->of, err));
    const char *unit = out->of.unit != NULL ? out->of.unit : "1";
    const lac_status status = by == NULL     ? LAC_OK
                              : out->of.time ? cli_parse_time(by, c, &out->by, err)
                                             : cli_parse_quantity(by, unit, &out->by, err);
    return status == LAC_EINPUT ? lac_fail_within(err, status, "--by: \"%s\"", by) : status;
}
