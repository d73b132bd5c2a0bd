// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit came to, in words.
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/common/words.h"
#include "cli/fit/fit.h"

static cli_text when(const lac_case *c, double t)
{
    if (!isfinite(t)) {
        return cli_format(isnan(t) ? "-" : "not by time.end");
    }
    return c->dated ? cli_date(c->start_date + t) : cli_amount(t, "s");
}

static void print_data(const lac_fit_result *r)
{
    cli_row("readings",
            "%zu displacements, %zu velocities; left out: %zu outside the run, %zu missing",
            r->displacements, r->velocities, r->outside, r->missing);
    if (r->not_positive > 0) {
        cli_row("", "%zu velocities <= 0 left out: they have no logarithm", r->not_positive);
    }
}

static void print_best(const lac_case *c, const lac_fit_result *r)
{
    if (r->displacements > 0) {
        cli_row("misfit", "rms %s after an offset of %s", cli_amount(r->displacement_rms, "m").s,
                cli_amount(r->offset, "m").s);
        cli_row("residuals",
                "%s: correlation of successive ones %.2f; the readings' own scatter %s",
                r->poor ? "the model fits badly, they are not noise" : "like noise",
                r->autocorrelation, cli_amount(r->scatter, "m").s);
    }
    if (r->velocities > 0) {
        cli_row("misfit of rates", "rms of ln %.3g (a factor of %.2f)", r->log_rate_rms,
                exp(r->log_rate_rms));
    }
    if (isnan(r->failure)) {
        cli_row("failure, best fit", "not by time.end");
        return;
    }
    cli_row("failure, best fit", "%s +- %s", when(c, r->failure).s,
            cli_amount(r->failure_error, "s").s);
}

// The standard error of the least squares and how the derivatives were had.
static void print_error(const lac_fit_unknown *x)
{
    static const char *const by[] = {"sensitivities", "differences of runs", "-"};
    const double nothing = 10.0; // e-folds
    if (isnan(x->error)) {
        puts("-");
    } else if (x->log && !(x->error < nothing)) {
        printf("not told by the data; by %s\n", by[x->by]);
    } else {
        printf("%s %.3g; by %s\n", x->log ? "a factor of" : "+-", x->log ? exp(x->error) : x->error,
               by[x->by]);
    }
}

static void print_unknowns(const lac_fit_result *r)
{
    printf("\n  %-36s %-12s %-12s %s\n", "estimate", "best", "median",
           "90 % of the posterior; R-hat, ESS");
    for (size_t k = 0; k < r->unknowns; k++) {
        const lac_fit_unknown *x = &r->unknown[k];
        printf("  %-36s %-12s ", x->key, cli_amount(x->best, x->unit).s);
        if (!r->sampled) {
            print_error(x);
            continue;
        }
        printf("%-12s %s to %s; %.3f, %.0f\n", cli_amount(x->quantile[2], x->unit).s,
               cli_amount(x->quantile[0], x->unit).s, cli_amount(x->quantile[4], x->unit).s,
               x->converged.rhat, x->converged.ess);
    }
}

// What stands at the end of what was allowed is no estimate: the data want more of it.
static void print_ends(const lac_fit_result *r)
{
    for (size_t k = 0; k < r->unknowns; k++) {
        const lac_fit_unknown *x = &r->unknown[k];
        if (x->end != 0) {
            cli_row("at its end", "the best fit of %s stands at the %s end of its range, %s",
                    x->key, x->end < 0 ? "lower" : "upper", cli_amount(x->limit, x->unit).s);
        }
    }
}

static void print_axis(const char *label, const lac_fit_result *r, const lac_fit_combination *axis)
{
    char text[600] = "";
    for (size_t k = 0; k < r->parameters; k++) {
        size_t used = strlen(text);
        if (fabs(axis->power[k]) >= 0.1) {
            (void)snprintf(text + used, sizeof text - used, "%s%s^%.2f", used > 0 ? " " : "",
                           r->unknown[k].key, axis->power[k]);
        }
    }
    if (axis->sigma < 10.0) {
        cli_row(label, "%s, to a factor of %.4g", text, exp(axis->sigma));
    } else {
        cli_row(label, "%s, not told by the data", text);
    }
}

static void print_pairs(const lac_fit_result *r, bool all)
{
    for (size_t k = 0; k < r->parameters; k++) {
        for (size_t l = 0; l < k; l++) {
            double c = r->correlation[k][l];
            if (all || fabs(c) > 0.9) {
                cli_row(fabs(c) > 0.9 ? "trade off" : "", "%s and %s: correlation %.3f",
                        r->unknown[l].key, r->unknown[k].key, c);
            }
        }
    }
}

static void print_identifiability(const lac_fit_result *r, bool verbose)
{
    puts("\n  what the data tell, and what not");
    print_pairs(r, verbose);
    if (r->parameters > 1) {
        print_axis("known best", r, &r->axis[r->parameters - 1]);
        print_axis("known least", r, &r->axis[0]);
    }
    if (r->one_block && r->sampled) {
        cli_row("(m/dc)(1-x^(m-1))", "%s, 90 %%: %s to %s, to a factor of %.3g",
                cli_amount(r->shape.quantile[2], "m-1").s,
                cli_amount(r->shape.quantile[0], "m-1").s,
                cli_amount(r->shape.quantile[4], "m-1").s, exp(r->shape_sigma));
    }
}

// From one time of failure to a later one; where the first is beyond the end, so is the second.
static void print_range(const char *share, const lac_case *c, double from, double to)
{
    if (isinf(from)) {
        cli_row("", "%s: not by time.end", share);
    } else {
        cli_row("", "%s: %s to %s", share, when(c, from).s, when(c, to).s);
    }
}

static void print_posterior(const lac_case *c, const lac_fit_result *r)
{
    const double *failure = r->failures.quantile;
    if (!r->sampled) {
        return;
    }
    cli_row("sampler", "%zu walkers, %zu steps kept after %zu, acceptance %.2f", r->chain->walkers,
            r->chain->steps, r->dropped, r->acceptance);
    if (!r->converged) {
        cli_row("", "has not converged (R-hat above %.2f): do not rely on the intervals",
                LAC_FIT_RHAT);
    }
    cli_row("failure", "median %s; %.3g %% of %zu draws fail by time.end", when(c, failure[2]).s,
            100.0 * r->failing, r->draws);
    print_range("50 %", c, failure[1], failure[3]);
    print_range("90 %", c, failure[0], failure[4]);
}

void cli_fit_print(const lac_fit_outcome *outcome, const char *series, double wall_time,
                   bool verbose)
{
    const lac_fit_result *r = outcome->result;
    const lac_case *source = outcome->source;
    if (source->title != NULL) {
        puts(source->title);
    }
    cli_row("series", "%s", series);
    print_data(r);
    print_best(source, r);
    print_unknowns(r);
    print_ends(r);
    print_identifiability(r, verbose);
    puts("");
    print_posterior(source, r);
    cli_row("cost", "%" PRId64 " runs in %.3g s", r->runs, wall_time);
}
