// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna fit CASE SERIES.csv: the fit, its file and the fitted case.
#include "cli/fit/fit.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hidden.h"
#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "cli/report/report.h"
#include "data/dataset.h"

enum { COLUMNS = 5 };

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
    double started;
} fit_job;

static void job_clear(fit_job *job)
{
    lac_fit_free(job->fit);
    lac_series_free(job->series);
    lac_case_free(job->source);
    lac_case_free(job->fitted);
    for (size_t i = 0; i < COLUMNS; i++) {
        free(job->column[i]);
    }
    free(job->overrides);
    free(job->path);
    free(job->case_path);
}

// A word as a YAML text in single quotes, within which only they themselves are doubled.
static char *quote(const char *word)
{
    char *text = malloc(2 * strlen(word) + 3);
    char *at = text;
    if (text == NULL) {
        return NULL;
    }
    *at++ = '\'';
    for (; *word != '\0'; word++) {
        *at++ = *word;
        if (*word == '\'') {
            *at++ = '\'';
        }
    }
    *at++ = '\'';
    *at = '\0';
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

static lac_status read_series(fit_job *job, lac_error *err)
{
    const char *path = job->request.argument[1];
    const lac_status status = lac_fit_series(job->source, path, &job->series, err);
    if (status == LAC_OK) {
        cli_series_warn(&job->request, path, job->series);
    }
    return status;
}

// OUT.yaml beside OUT.nc.
static lac_status name_case(fit_job *job, lac_error *err)
{
    size_t n = strlen(job->path);
    const char ending[] = ".yaml";
    if (n > 3 && strcmp(job->path + n - 3, ".nc") == 0) {
        n -= 3;
    }
    job->case_path = malloc(n + sizeof ending);
    LAC_FAIL_MEMORY_IF(job->case_path == NULL, err);
    memcpy(job->case_path, job->path, n);
    memcpy(job->case_path + n, ending, sizeof ending);
    return cli_output_check(&job->request, job->source, job->case_path, err);
}

static lac_status prepare(fit_job *job, lac_error *err)
{
    const int threads = job->request.threads > 0 ? job->request.threads : 1;
    lac_status status;
    lac_case_issues report = {0};
    const cli_request *request = &job->request;
    LAC_TRY(set_columns(job, err));
    LAC_TRY(cli_case_read(request, LAC_FOR_FIT, &job->source, NULL, err));
    LAC_TRY(cli_output_path(request, job->source, NULL, "-fit.nc", &job->path, err));
    LAC_TRY(name_case(job, err));
    LAC_TRY(read_series(job, err));
    status = lac_fit_create(job->source, job->series, threads, &job->fit, err);
    if (status != LAC_OK) {
        (void)lac_fail_within(err, status, "%s", request->argument[1]);
        goto out;
    }
    const lac_case_request how = {LAC_FOR_FIT, request->overrides, request->set_count};
    LAC_TRY(lac_case_read(request->argument[0], &how, &job->fitted, &report, err));
out:
    lac_case_issues_clear(&report);
    return status;
}

static void on_progress(void *context, const char *stage, size_t done, size_t total)
{
    cli_progress_stage(context, stage, done, total);
}

static lac_status compute(fit_job *job, lac_error *err)
{
    const lac_fit_watch watch = {cli_signals_stop, on_progress, &job->progress};
    cli_signals_hold();
    cli_progress_start(&job->progress, &job->request);
    lac_status status = lac_fit_run(job->fit, &watch, &job->result, err);
    cli_progress_clear(&job->progress);
    return cli_blame(job->source, status, err);
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

static lac_status write_whole(const char *path, const char *head, const char *text, lac_error *err)
{
    const size_t size = strlen(head) + strlen(text) + sizeof "\n";
    char *whole = malloc(size);
    LAC_FAIL_MEMORY_IF(whole == NULL, err);
    (void)snprintf(whole, size, "%s\n%s", head, text);
    const lac_status status = lac_write_text(path, whole, true, err); // asked for before the fit
    free(whole);
    return status;
}

// Whether YAML takes the character of so many bytes in the line of a comment.
static bool is_plain(const unsigned char *s, size_t length)
{
    const bool none = length == 3 && memcmp(s, "\xef\xbf", 2) == 0 && s[2] >= 0xbe; // of Unicode
    const bool plain = length > 1 ? !none && lac_hidden_length((const char *)s, length) == 0
                                  : length == 1 && *s >= 0x20 && *s < 0x7f;
    return plain;
}

// A file's name may hold what would end the comment: '?' instead.
static void make_plain(char *text)
{
    for (unsigned char *s = (unsigned char *)text; *s != '\0';) {
        const size_t length = lac_utf8_length(s);
        const size_t step = length > 0 ? length : 1;
        if (!is_plain(s, length)) {
            memset(s, '?', step);
        }
        s += step;
    }
}

// The case with the best fit in it, which runs as it is; its files are named from the folder that
// it stands in, or in full where that is another than the working folder.
static lac_status write_case(const fit_job *job, lac_error *err)
{
    char head[4 * PATH_MAX];
    lac_fit_apply(&job->result, job->fitted);
    lac_status status = move_case(job->case_path, job->fitted, err);
    if (status != LAC_OK) {
        return status;
    }
    char *text = lac_case_text(job->fitted);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    (void)snprintf(head, sizeof head,
                   "# %s fitted to %s by lacuna fit: the best fit; its uncertainty is in %s",
                   job->source->path, job->request.argument[1], job->path);
    make_plain(head);
    status = write_whole(job->case_path, head, text, err);
    free(text);
    return status;
}

static void print_json(const fit_job *job, const lac_dataset *dataset, double wall_time)
{
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    cli_series_warnings(&json, job->series);
    lac_dataset_json(dataset, &json);
    lac_json_number(&json, "wall_time_s", wall_time);
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_text(&json, "output", job->path);
    lac_json_text(&json, "case_output", job->case_path);
    lac_json_close(&json, '}');
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
    LAC_TRY(write_case(job, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        print_json(job, dataset, wall_time);
    } else {
        cli_fit_print(&outcome, request->argument[1], wall_time,
                      cli_given(request, CLI_OPT_VERBOSE));
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
    status = compute(&job, err);
    if (status == LAC_OK || (status == LAC_EINTERRUPT && job.result.times > 0)) {
        lac_status written = put_out(&job, status, status == LAC_OK ? err : NULL);
        status = status == LAC_OK ? written : status;
        if (status == LAC_OK) {
            status = lac_fit_trust(&job.result, err);
        } else if (status == LAC_EINTERRUPT) {
            status = lac_fail(err, status, "interrupted; %s holds the draws up to there", job.path);
        }
    }
out:
    job_clear(&job);
    return status;
}
