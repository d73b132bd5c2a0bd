// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit came to, in words.
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/date.h"
#include "base/units.h"
#include "cli/common/words.h"
#include "cli/fit/fit.h"

static const char *when(const lac_case *c, double t, char *text, size_t size)
{
    if (isnan(t) || isinf(t)) {
        (void)snprintf(text, size, "%s", isnan(t) ? "-" : "not by time.end");
        return text;
    }
    return c->dated ? lac_date_format(c->start_date + t, text, size)
                    : cli_quantity(t, "s", text, size);
}

static void print_data(const lac_fit_result *r)
{
    cli_row("readings",
            "%zu displacements, %zu velocities; left out: %zu outside the run, %zu "
            "missing",
            r->displacements, r->velocities, r->outside, r->missing);
    if (r->not_positive > 0) {
        cli_row("", "%zu velocities <= 0 left out: they have no logarithm", r->not_positive);
    }
}

static void print_best(const lac_case *c, const lac_fit_result *r)
{
    char text[64], offset[64], error[64];
    if (r->displacements > 0) {
        cli_row("misfit", "rms %s after an offset of %s",
                cli_quantity(r->displacement_rms, "m", text, sizeof text),
                cli_quantity(r->offset, "m", offset, sizeof offset));
        cli_row("residuals",
                "%s: correlation of successive ones %.2f; the readings' own scatter %s",
                r->poor ? "the model fits badly, they are not noise" : "like noise",
                r->autocorrelation, cli_quantity(r->scatter, "m", text, sizeof text));
    }
    if (r->velocities > 0) {
        cli_row("misfit of rates", "rms of ln %.3g (a factor of %.2f)", r->log_rate_rms,
                exp(r->log_rate_rms));
    }
    if (isnan(r->failure)) {
        cli_row("failure, best fit", "not by time.end");
        return;
    }
    cli_row("failure, best fit", "%s +- %s", when(c, r->failure, text, sizeof text),
            cli_quantity(r->failure_error, "s", error, sizeof error));
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
        char best[32], middle[32], low[32], high[32];
        printf("  %-36s %-12s ", x->key, cli_quantity(x->best, x->unit, best, sizeof best));
        if (!r->sampled) {
            print_error(x);
            continue;
        }
        printf("%-12s %s to %s; %.3f, %.0f\n",
               cli_quantity(x->quantile[2], x->unit, middle, sizeof middle),
               cli_quantity(x->quantile[0], x->unit, low, sizeof low),
               cli_quantity(x->quantile[4], x->unit, high, sizeof high), x->converged.rhat,
               x->converged.ess);
    }
}

// What stands at the end of what was allowed is no estimate: the data want more of it.
static void print_ends(const lac_fit_result *r)
{
    char limit[32];
    for (size_t k = 0; k < r->unknowns; k++) {
        const lac_fit_unknown *x = &r->unknown[k];
        if (x->end != 0) {
            cli_row("at its end", "the best fit of %s stands at the %s end of its range, %s",
                    x->key, x->end < 0 ? "lower" : "upper",
                    cli_quantity(x->limit, x->unit, limit, sizeof limit));
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
    char text[3][32];
    puts("\n  what the data tell, and what not");
    print_pairs(r, verbose);
    if (r->parameters > 1) {
        print_axis("known best", r, &r->axis[r->parameters - 1]);
        print_axis("known least", r, &r->axis[0]);
    }
    if (r->one_block && r->sampled) {
        cli_row("(m/dc)(1-x^(m-1))", "%s, 90 %%: %s to %s, to a factor of %.3g",
                cli_quantity(r->shape.quantile[2], "m-1", text[0], sizeof text[0]),
                cli_quantity(r->shape.quantile[0], "m-1", text[1], sizeof text[1]),
                cli_quantity(r->shape.quantile[4], "m-1", text[2], sizeof text[2]),
                exp(r->shape_sigma));
    }
}

// From one time of failure to a later one; where the first is beyond the end, so is the second.
static void print_range(const char *share, double from, const char *low, const char *high)
{
    if (isinf(from)) {
        cli_row("", "%s: not by time.end", share);
    } else {
        cli_row("", "%s: %s to %s", share, low, high);
    }
}

static void print_posterior(const lac_case *c, const lac_fit_result *r)
{
    char text[LAC_FIT_QUANTILES][64];
    if (!r->sampled) {
        return;
    }
    cli_row("sampler", "%zu walkers, %zu steps kept after %zu, acceptance %.2f", r->chain->walkers,
            r->chain->steps, r->dropped, r->acceptance);
    if (!r->converged) {
        cli_row("", "has not converged (R-hat above %.2f): do not rely on the intervals",
                LAC_FIT_RHAT);
    }
    for (size_t q = 0; q < LAC_FIT_QUANTILES; q++) {
        (void)when(c, r->failures.quantile[q], text[q], sizeof text[q]);
    }
    cli_row("failure", "median %s; %.3g %% of %zu draws fail by time.end", text[2],
            100.0 * r->failing, r->draws);
    print_range("50 %", r->failures.quantile[1], text[1], text[3]);
    print_range("90 %", r->failures.quantile[0], text[0], text[4]);
}

void cli_fit_print(const cli_fit_view *view, bool verbose)
{
    const lac_fit_result *r = view->outcome.result;
    if (view->outcome.source->title != NULL) {
        puts(view->outcome.source->title);
    }
    cli_row("series", "%s", view->series);
    print_data(r);
    print_best(view->outcome.source, r);
    print_unknowns(r);
    print_ends(r);
    print_identifiability(r, verbose);
    puts("");
    print_posterior(view->outcome.source, r);
    cli_row("cost", "%" PRId64 " runs in %.3g s", r->runs, view->wall_time);
    cli_row("file", "%s", view->output);
    cli_row("fitted case", "%s", view->case_output);
}
