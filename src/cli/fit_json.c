// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit came to, as JSON.
#include <math.h>

#include "base/date.h"
#include "cli/fit.h"
#include "cli/json.h"
#include "cli/run_outcome.h"
#include "cli/series.h"

// The middle half or nine tenths of the posterior.
static void put_interval(cli_json *json, const char *key, const double *quantile, size_t from)
{
    cli_json_open(json, key, '[');
    cli_json_number(json, NULL, quantile[from]);
    cli_json_number(json, NULL, quantile[LAC_FIT_QUANTILES - 1 - from]);
    cli_json_close(json, ']');
}

static void put_unknowns(cli_json *json, const lac_fit_result *r)
{
    static const char *const by[] = {"sensitivities", "runs", NULL};
    static const char *const ends[] = {"low", NULL, "high"};
    cli_json_open(json, "parameters", '[');
    for (size_t k = 0; k < r->unknowns; k++) {
        const lac_fit_unknown *x = &r->unknown[k];
        cli_json_open(json, NULL, '{');
        cli_json_text(json, "key", x->key);
        cli_json_text(json, "unit", x->unit);
        cli_json_number(json, "best", x->best);
        cli_json_text(json, "at_end_of_range", ends[x->end + 1]);
        cli_json_number(json, "end_of_range", x->limit);
        cli_json_number(json, x->log ? "error_of_logarithm" : "error", x->error);
        cli_json_text(json, "derivatives", by[x->by]);
        cli_json_number(json, "median", x->quantile[2]);
        put_interval(json, "interval50", x->quantile, 1);
        put_interval(json, "interval90", x->quantile, 0);
        cli_json_number(json, "rhat", x->converged.rhat);
        cli_json_number(json, "ess", x->converged.ess);
        cli_json_number(json, "autocorrelation_steps", x->converged.time);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}

static void put_axis(cli_json *json, const char *key, const lac_fit_result *r,
                     const lac_fit_combination *axis)
{
    cli_json_open(json, key, '{');
    cli_json_open(json, "powers", '{');
    for (size_t k = 0; k < r->parameters; k++) {
        cli_json_number(json, r->unknown[k].key, axis->power[k]);
    }
    cli_json_close(json, '}');
    cli_json_number(json, "sigma_of_logarithm", axis->sigma);
    cli_json_close(json, '}');
}

static void put_identifiability(cli_json *json, const lac_fit_result *r)
{
    cli_json_open(json, "correlation", '[');
    for (size_t k = 0; k < r->parameters; k++) {
        cli_json_open(json, NULL, '[');
        for (size_t l = 0; l < r->parameters; l++) {
            cli_json_number(json, NULL, r->correlation[k][l]);
        }
        cli_json_close(json, ']');
    }
    cli_json_close(json, ']');
    put_axis(json, "known_best", r, &r->axis[r->parameters - 1]);
    put_axis(json, "known_least", r, &r->axis[0]);
    if (!r->one_block) {
        cli_json_null(json, "shape");
        return;
    }
    cli_json_open(json, "shape", '{');
    cli_json_text(json, "formula", "(m/dc)(1 - x^(m-1))");
    cli_json_number(json, "median_1_m", r->shape.quantile[2]);
    put_interval(json, "interval50_1_m", r->shape.quantile, 1);
    put_interval(json, "interval90_1_m", r->shape.quantile, 0);
    cli_json_number(json, "sigma_of_logarithm", r->shape_sigma);
    cli_json_close(json, '}');
}

static void put_date(cli_json *json, const char *key, const lac_case *c, double t)
{
    char date[32] = "";
    bool known = c->dated && isfinite(t);
    cli_json_text(json, key, known ? lac_date_format(c->start_date + t, date, sizeof date) : NULL);
}

static void put_failure(cli_json *json, const cli_fit_view *view)
{
    const lac_fit_result *r = view->result;
    cli_json_number(json, "best_failure_time_s", r->failure);
    cli_json_number(json, "best_failure_error_s", r->failure_error);
    put_date(json, "best_failure_date", view->source, r->failure);
    cli_json_number(json, "tc_s", r->failures.quantile[2]);
    put_date(json, "tc_date", view->source, r->failures.quantile[2]);
    put_interval(json, "interval50_s", r->failures.quantile, 1);
    put_interval(json, "interval90_s", r->failures.quantile, 0);
    cli_json_number(json, "share_failing", r->failing);
}

static void put_sampler(cli_json *json, const cli_fit_view *view)
{
    const lac_chain *chain = view->result->chain;
    if (chain == NULL) {
        cli_json_null(json, "sampler");
        return;
    }
    cli_json_open(json, "sampler", '{');
    cli_json_integer(json, "walkers", (int64_t)chain->walkers);
    cli_json_integer(json, "steps", (int64_t)chain->steps);
    cli_json_integer(json, "burn", (int64_t)view->result->dropped);
    cli_json_integer(json, "seed", view->source->fit.seed);
    cli_json_boolean(json, "converged", view->result->converged);
    cli_json_number(json, "acceptance", view->result->acceptance);
    cli_json_close(json, '}');
}

void cli_fit_json(const cli_fit_view *view)
{
    const lac_fit_result *r = view->result;
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    cli_json_text(&json, "status", view->status);
    cli_series_warnings(&json, view->readings);
    cli_json_integer(&json, "displacements", (int64_t)r->displacements);
    cli_json_integer(&json, "velocities", (int64_t)r->velocities);
    cli_json_integer(&json, "outside", (int64_t)r->outside);
    cli_json_integer(&json, "missing", (int64_t)r->missing);
    cli_json_integer(&json, "not_positive", (int64_t)r->not_positive);
    cli_json_number(&json, "rms_m", r->displacement_rms);
    cli_json_number(&json, "rms_ln_rate", r->log_rate_rms);
    cli_json_number(&json, "offset_m", r->offset);
    cli_json_number(&json, "log_likelihood", r->log_likelihood);
    cli_json_number(&json, "bic", r->bic);
    cli_json_number(&json, "residual_autocorrelation", r->autocorrelation);
    cli_json_number(&json, "scatter_m", r->scatter);
    cli_json_boolean(&json, "fits_badly", r->poor);
    put_unknowns(&json, r);
    put_identifiability(&json, r);
    put_failure(&json, view);
    put_sampler(&json, view);
    cli_json_integer(&json, "runs", r->runs);
    cli_json_number(&json, "wall_time_s", view->wall_time);
    cli_json_number(&json, "cpu_time_s", cli_cpu_time());
    cli_json_text(&json, "output", view->output);
    cli_json_text(&json, "case_output", view->case_output);
    cli_json_close(&json, '}');
}
