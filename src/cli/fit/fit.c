// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna fit CASE SERIES.csv: the fit, its file and the fitted case, and what it came to in words.
#define _GNU_SOURCE // asprintf
#include <unistd.h>

#include "base/hidden.h"
#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/pool.h"
#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "cli/report/report.h"
#include "fit/fit.h"

enum { COLUMNS = 9 };

// Everything that a fit holds.
typedef struct fit_job {
    cli_request request; // its options for the columns are settings of the case
    lac_override *overrides;
    char *column[COLUMNS];
    lac_case *source, *fitted;
    lac_series *series;
    lac_fit *fit;
    lac_fit_result result;
    cli_progress progress;
    char *path, *case_path;
    char *kept_path; // OUT.nc.chains beside OUT.nc
    lac_kept *kept;
    double started;
} fit_job;

// A word as a YAML text in single quotes, within which only they themselves are doubled.
static char *quote(const char *word)
{
    char *text = calloc(2 * strlen(word) + 3, 1), *at = text;
    if (text != NULL) {
        *at++ = '\'';
        for (; *word != '\0'; word++) {
            *at++ = *word;
            if (*word == '\'') {
                *at++ = '\'';
            }
        }
        *at = '\'';
    }
    return text;
}

// --time, --displacement ... become settings of the case's section fit, so that they are checked
// there and stand in the files that are written.
static lac_status set_columns(fit_job *job, lac_error *err)
{
    cli_request *request = &job->request;
    const cli_series_words *words = &request->series;
    const struct {
        const char *key, *word;
    } given[COLUMNS] = {{"fit.time", words->time},
                        {"fit.time_format", words->time_format},
                        {"fit.clock", words->clock},
                        {"fit.skip", words->skip},
                        {"fit.components", words->components},
                        {"fit.line_of_sight", words->line_of_sight},
                        {"fit.displacement", words->displacement},
                        {"fit.velocity", words->velocity},
                        {"fit.sigma", words->sigma}};
    job->overrides = calloc(request->set_count + COLUMNS, sizeof *job->overrides);
    LAC_FAIL_MEMORY_IF(job->overrides == NULL, err);
    if (request->set_count > 0) {
        memcpy(job->overrides, request->overrides, request->set_count * sizeof *job->overrides);
    }
    for (size_t i = 0; i < COLUMNS; i++) {
        if (given[i].word == NULL) {
            continue;
        }
        job->column[i] = quote(given[i].word);
        LAC_FAIL_MEMORY_IF(job->column[i] == NULL, err);
        job->overrides[request->set_count++] = (lac_override){given[i].key, job->column[i]};
    }
    request->overrides = job->overrides;
    return LAC_OK;
}

// OUT.yaml beside OUT.nc.
static lac_status name_case(fit_job *job, lac_error *err)
{
    char *path = NULL;
    LAC_FAIL_MEMORY_IF(asprintf(&path, "%.*s.yaml", (int)cli_stem(job->path, ".nc"), job->path) < 0,
                       err);
    job->case_path = path;
    const lac_status status = cli_output_check(&job->request, job->source, job->case_path, err);
    return lac_fail_within(err, status, "the case beside it");
}

static lac_status prepare(fit_job *job, lac_error *err)
{
    int threads;
    lac_status status;
    lac_case_issues report = {0};
    const cli_request *request = &job->request;
    const bool resume = cli_given(&job->request, CLI_OPT_RESUME);
    job->request = cli_request_anew(request, true);
    LAC_TRY(cli_pool_threads(request, &threads, err));
    LAC_TRY(set_columns(job, err));
    LAC_TRY(cli_case_read(request, LAC_FOR_FIT, &job->source, NULL, err));
    LAC_TRY(cli_output_path(request, job->source, NULL, "-fit.nc", &job->path, err));
    LAC_TRY(name_case(job, err));
    LAC_TRY(lac_fit_series(job->source, request->argument[1], &job->series, err));
    cli_series_warn(request, request->argument[1], job->series);
    status = lac_fit_create(job->source, job->series, threads, &job->fit, err);
    LAC_TRY(lac_fail_within(err, status, "%s", request->argument[1]));
    const lac_case_request how = {LAC_FOR_FIT, request->overrides, request->set_count};
    LAC_TRY(lac_case_read(request->argument[0], &how, &job->fitted, &report, err));
    job->kept_path = lac_text_join(job->path, "", ".chains");
    LAC_TRY(job->kept_path != NULL ? LAC_OK : lac_fail_memory(err));
    if (job->source->fit.steps > 0 || resume) { // the sampler's steps, until the fit is done
        LAC_TRY(
            lac_kept_open(job->kept_path, "fit", lac_fit_sum(job->fit), resume, &job->kept, err));
    }
out:
    lac_case_issues_clear(&report);
    return status;
}

static void on_progress(void *context, const char *stage, size_t done, size_t total)
{
    cli_progress_stage(context, stage, done, total);
}

// Files of the case named so that they are found from the folder that the fitted case stands in.
static lac_status move_case(const char *path, lac_case *c, lac_error *err)
{
    char folder[PATH_MAX + 1];
    char *name = strdup(path);
    LAC_FAIL_MEMORY_IF(name == NULL, err);
    free(c->path);
    c->path = name;
    free(c->output_file); // the original's, which a run of this one must not write
    c->output_file = NULL;
    if (strchr(path, '/') == NULL) {
        return LAC_OK;
    }
    LAC_FAIL_IF(getcwd(folder, sizeof folder - 1) == NULL, err, LAC_EIO,
                "the working folder has no name: %s", strerror(errno));
    size_t n = strlen(folder);
    folder[n] = '/';
    folder[n + 1] = '\0';
    return lac_case_rebase(c, folder, err);
}

// A file's name may hold what would end the comment, or what YAML does not take: '?' instead.
static void make_plain(char *text)
{
    for (size_t step; *text != '\0'; text += step) {
        const unsigned char *s = (const unsigned char *)text;
        uint32_t code;
        const size_t n = lac_utf8_length(s, &code);
        const bool none = n == 3 && code >= 0xfffe; // of Unicode
        step = n > 0 ? n : 1;
        if (n > 1 ? none || lac_hidden_length(text, n) > 0 : n < 1 || *s < 0x20 || *s >= 0x7f) {
            memset(text, '?', step);
        }
    }
}

// The case with the best fit in it, which runs as it is; its files are named from the folder that
// it stands in, or in full where that is another than the working folder.
static lac_status write_case(const fit_job *job, lac_error *err)
{
    lac_fit_apply(&job->result, job->fitted);
    LAC_TRY_RETURN(move_case(job->case_path, job->fitted, err));
    char head[4 * PATH_MAX], *text = lac_case_text(job->fitted);
    (void)snprintf(head, sizeof head,
                   "# %s fitted to %s by lacuna fit: the best fit; its uncertainty is in %s",
                   job->source->path, job->request.argument[1], job->path);
    make_plain(head);
    char *whole = text != NULL ? lac_text_join(head, "\n", text) : NULL;
    const lac_status status = whole != NULL // asked for before the fit
                                  ? lac_write_text(job->case_path, whole, true, err)
                                  : lac_fail_memory(err);
    free(text);
    free(whole);
    return status;
}

static cli_text when(const lac_case *c, double t)
{
    if (!isfinite(t)) {
        return cli_format(isnan(t) ? "-" : "not by time.end");
    }
    return c->dated ? cli_date(c->start_date + t) : cli_amount(t, "s");
}

static void print_best(const lac_case *c, const lac_fit_result *r)
{
    const char *unit = r->friction ? "1" : "m";
    if (r->frictions > 0) {
        cli_row("misfit", "rms of friction %.3g", r->displacement_rms);
    } else if (r->displacements > 0) {
        cli_row("misfit", "rms %s after an offset of %s", cli_amount(r->displacement_rms, "m").s,
                cli_amount(r->offset, "m").s);
    }
    if (r->displacements + r->frictions > 0) {
        cli_row("residuals",
                "%s: correlation of successive ones %.2f; the readings' own scatter %s",
                r->falls  ? "bad: the readings fall, but slip only grows (give their negative)"
                : r->poor ? "the model fits badly, they are not noise"
                          : "like noise",
                r->autocorrelation, cli_amount(r->scatter, unit).s);
    }
    if (r->velocities > 0) {
        cli_row("misfit of rates", "rms of ln %.3g (a factor of %.2f)", r->log_rate_rms,
                exp(r->log_rate_rms));
    }
    if (isnan(r->evidence)) {
        cli_row("BIC", "%.1f", r->bic);
    } else {
        cli_row("evidence", "ln Z %.2f +- %.2f, BIC %.1f", r->evidence, r->evidence_error, r->bic);
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
        printf("not constrained by the data; by %s\n", by[x->by]);
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
        if (fabs(axis->power[k]) >= 0.1) {
            lac_append(text, sizeof text, "%s%s^%.2f", text[0] != '\0' ? " " : "",
                       r->unknown[k].key, axis->power[k]);
        }
    }
    if (axis->sigma < 10.0) {
        cli_row(label, "%s, to a factor of %.4g", text, exp(axis->sigma));
    } else {
        cli_row(label, "%s, not constrained by the data", text);
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
    puts("\n  what the data constrain, and what not");
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
    cli_row("failure", "median %s; %.3g %% of %zu draws fail by time.end", when(c, failure[2]).s,
            100.0 * r->failing, r->draws);
    print_range("50 %", c, failure[1], failure[3]);
    print_range("90 %", c, failure[0], failure[4]);
}

static void print_text(const lac_fit_outcome *outcome, const char *series, double wall_time,
                       bool verbose)
{
    const lac_fit_result *r = outcome->result;
    const lac_case *source = outcome->source;
    if (source->title != NULL) {
        puts(source->title);
    }
    lac_error why = {""};
    if (lac_fit_trust(r, &why) != LAC_OK) {
        cli_row("do not rely on it", "%s", why.message);
    }
    const char *point = source->fit.point;
    cli_row("series", "%s%s%s", series, point != NULL ? ", at point " : "",
            point != NULL ? point : "");
    cli_row("readings", "%zu %s, %zu velocities; left out: %zu outside the run, %zu missing",
            r->displacements + r->frictions,
            r->friction ? "friction coefficients" : "displacements", r->velocities, r->outside,
            r->missing);
    if (r->bounds > 0) {
        cli_row("", "%zu of the velocities are upper bounds", r->bounds);
    }
    if (r->not_positive > 0) {
        cli_row("", "%zu velocities <= 0 left out: they have no logarithm", r->not_positive);
    }
    print_best(source, r);
    print_unknowns(r);
    print_ends(r);
    print_identifiability(r, verbose);
    puts("");
    print_posterior(source, r);
    cli_row("cost", "%" PRId64 " runs in %.3g s", r->runs, wall_time);
}

// What was computed is written whole, also where it was interrupted.
static lac_status put_out(fit_job *job, lac_status computed, lac_error *err)
{
    const cli_request *request = &job->request;
    const lac_case *source = job->source;
    const double wall_time = cli_clock() - job->started;
    const lac_fit_outcome outcome = {source, &job->result,
                                     computed == LAC_OK ? "complete" : "interrupted"};
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(lac_fit_describe(&outcome, &dataset, err));
    LAC_TRY(cli_store_dataset(request, source, source->fit.seed, job->path, dataset, err));
    LAC_TRY(request->pipe == 0 ? write_case(job, err) : LAC_OK);
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        lac_json_open(&json, NULL, '{');
        cli_series_warnings(&json, job->series);
        lac_dataset_json(dataset, &json);
        lac_json_number(&json, "wall_time_s", wall_time);
        lac_json_number(&json, "cpu_time_s", cli_cpu_time());
        lac_json_text(&json, "output", job->path);
        lac_json_text(&json, "case_output", job->case_path);
        lac_json_close(&json, '}');
    } else {
        print_text(&outcome, request->argument[1], wall_time, cli_given(request, CLI_OPT_VERBOSE));
        cli_row("file", "%s", job->path);
        cli_row("fitted case", "%s", job->case_path);
    }
out:
    lac_dataset_free(dataset);
    return status;
}

lac_status cli_fit(const cli_request *request, lac_error *err)
{
    fit_job job = {.request = *request, .started = cli_clock()};
    lac_status status;
    LAC_TRY(prepare(&job, err));
    cli_say(request, "fitting %zu numbers of %s to %s", job.source->fit.count, request->argument[0],
            request->argument[1]);
    const lac_fit_watch watch = {cli_signals_stop, on_progress, &job.progress, job.kept};
    cli_signals_hold();
    cli_progress_start(&job.progress, request);
    status = lac_fit_run(job.fit, &watch, &job.result, err);
    cli_progress_clear(&job.progress);
    (void)cli_blame(job.source, status, err);
    if (status == LAC_OK || (status == LAC_EINTERRUPT && job.result.times > 0)) {
        lac_status written = put_out(&job, status, status == LAC_OK ? err : NULL);
        status = status == LAC_OK ? written : status;
        if (status == LAC_OK) { // draws that cannot be relied on stay what more rounds begin with
            lac_error why = {""};
            status = lac_fit_trust(&job.result, &why);
            LAC_TRY(status == LAC_OK
                        ? LAC_OK
                        : lac_fail(err, status,
                                   "%s; with --set fit.rounds=%" PRId64 " --resume goes on from %s",
                                   why.message, job.source->fit.rounds + 1, job.kept_path));
        } else if (status == LAC_EINTERRUPT) {
            status =
                lac_fail(err, status,
                         "interrupted; %s holds the draws up to there, --resume goes on", job.path);
        }
    }
out:
    lac_kept_close(job.kept, status == LAC_OK || lac_kept_has_none(job.kept));
    lac_fit_free(job.fit);
    lac_series_free(job.series);
    lac_case_free(job.source);
    lac_case_free(job.fitted);
    for (size_t i = 0; i < COLUMNS; i++) {
        free(job.column[i]);
    }
    free(job.overrides);
    free(job.path);
    free(job.case_path);
    free(job.kept_path);
    return status;
}
