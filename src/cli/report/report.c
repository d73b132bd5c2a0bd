// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the case of a command; errors and warnings are told by file, line and key.
#include "cli/report/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "base/units.h"
#include "cli/common/words.h"

// The issue as it was asked for: --accuracy sets a key that the user did not name.
static lac_case_issue as_given(const lac_case_issue *issue, const cli_request *request)
{
    static const char key[] = "solver.accuracy";
    lac_case_issue shown = *issue;
    if (issue->line > 0 || issue->key == NULL || strcmp(issue->key, key) != 0) {
        return shown;
    }
    for (size_t i = request->set_count; i-- > 0;) {
        if (strcmp(request->overrides[i].key, key) == 0) {
            if (request->overrides[i].value == request->accuracy) {
                shown.file = "--accuracy";
                shown.key = "";
            }
            break; // the last one counts
        }
    }
    return shown;
}

void cli_report_print_of(const lac_case_issues *report, const cli_request *request,
                         const char *section)
{
    for (size_t i = 0; i < report->count; i++) {
        const lac_case_issue *issue = &report->issue[i];
        const lac_case_issue shown = as_given(issue, request);
        char text[2000];
        bool wanted = !cli_given(request, CLI_OPT_QUIET) && issue->key != NULL &&
                      strncmp(issue->key, section, strlen(section)) == 0;
        if (!issue->warning || wanted) {
            cli_note("%s%s", issue->warning ? "warning: " : "",
                     lac_case_issue_format(&shown, text, sizeof text));
        }
    }
}

static void write_issue(lac_json *json, const lac_case_issue *issue)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "file", issue->file);
    if (issue->line > 0) {
        lac_json_integer(json, "line", (int64_t)issue->line);
    } else {
        lac_json_null(json, "line");
    }
    lac_json_text(json, "key", issue->key);
    lac_json_text(json, "value", issue->value);
    lac_json_text(json, "message", issue->message);
    lac_json_close(json, '}');
}

void cli_report_json(lac_json *json, const char *key, const lac_case_issues *report, bool warnings)
{
    lac_json_open(json, key, '[');
    for (size_t i = 0; i < report->count; i++) {
        if (report->issue[i].warning == warnings) {
            write_issue(json, &report->issue[i]);
        }
    }
    lac_json_close(json, ']');
}

lac_status cli_report_add(lac_case_issues *report, const lac_case *c, const char *key,
                          const char *message, bool warning, lac_error *err)
{
    lac_case_issue *grown = realloc(report->issue, (report->count + 1) * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    report->issue = grown;
    lac_case_issue *issue = &grown[report->count++];
    *issue = (lac_case_issue){.file = strdup(c->path),
                              .key = strdup(key),
                              .value = strdup(""),
                              .message = strdup(message),
                              .warning = warning};
    report->errors += warning ? 0 : 1;
    const bool whole = issue->file != NULL && issue->key != NULL && issue->value != NULL;
    return whole && issue->message != NULL ? LAC_OK : lac_fail_memory(err);
}

// Adds what the files of the loads leave open; one that cannot be read is told of by who needs it.
static lac_status ask_loads(const lac_case *c, lac_case_issues *report, lac_error *err)
{
    const lac_load_models models = {c->shear.item, c->shear.count, c->pore.item, c->pore.count};
    lac_load_files *files = NULL;
    lac_load_set loads;
    lac_status status = LAC_OK;
    if (!lac_load_models_need_files(&models)) {
        return LAC_OK;
    }
    LAC_TRY(lac_load_files_create(&files, err));
    const lac_load_clock clock = {c->dated, c->start_date, c->run.end, files};
    if (lac_load_set_create(&models, &clock, &loads, NULL) == LAC_OK) {
        lac_load_set_clear(&loads);
    }
    for (size_t i = 0; lac_load_files_doubt(files, i) != NULL; i++) {
        LAC_TRY(cli_report_add(report, c, "load", lac_load_files_doubt(files, i), true, err));
    }
out:
    lac_load_files_free(files);
    return status;
}

// Adds what a case asks of its run that a fit, and a forecast by it, does without.
static lac_status ask_fit(const lac_case *c, lac_case_issues *report, lac_error *err)
{
    const struct {
        bool named;
        const char *key, *message;
    } left_out[] = {
        {!isnan(c->run.stop_slip) || !isnan(c->run.stop_rate), "time.stop_when",
         "ends a run; a fit goes on to failure"},
        {c->run.fidelity == LAC_FIDELITY_ASYNC, "solver.fidelity",
         "is of a run; a fit takes all cells at every step"},
        {c->analysis.count > 0, "analysis", "is of a run; a fit follows no indicators"},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++) {
        if (left_out[i].named) {
            LAC_TRY(cli_report_add(report, c, left_out[i].key, left_out[i].message, true, err));
        }
    }
out:
    return status;
}

lac_status cli_case_read(const cli_request *request, lac_case_purpose purpose, lac_case **c,
                         lac_case_issues *report, lac_error *err)
{
    lac_case_issues own = {0};
    lac_case_issues *all = report != NULL ? report : &own;
    const lac_case_request how = {purpose, request->overrides, request->set_count};
    lac_status status = lac_case_read(request->argument[0], &how, c, all, err);
    const bool runs = purpose == LAC_FOR_RUN || purpose == LAC_FOR_FIT || purpose == LAC_FOR_CHECK;
    status = status == LAC_OK && runs ? ask_loads(*c, all, err) : status;
    status = status == LAC_OK && purpose == LAC_FOR_FIT ? ask_fit(*c, all, err) : status;
    cli_report_print_of(all, request, "");
    if (all->errors > 0) {
        err->message[0] = '\0'; // said already, line by line
    }
    lac_case_issues_clear(&own);
    if (status == LAC_OK) {
        (*c)->run.beyond = 0; // commands do what a case asks, or say that they do not
    }
    return status;
}

lac_status cli_parse_time(const char *text, const lac_case *c, double *time, lac_error *err)
{
    double date;
    if (c->dated && lac_date_parse(text, &date)) {
        *time = date - c->start_date;
        return LAC_OK;
    }
    lac_units *units = NULL;
    lac_status status = lac_units_create(&units, err);
    if (status == LAC_OK) {
        status = lac_units_parse(units, text, "s", time, err);
    }
    lac_units_free(units);
    return status;
}

lac_status cli_until(const cli_request *request, const lac_case *c, double *end, lac_error *err)
{
    const char *text = request->until;
    double until;
    if (text == NULL) {
        return LAC_OK;
    }
    const lac_status status = cli_parse_time(text, c, &until, err);
    if (status != LAC_OK) {
        return status == LAC_EINPUT ? lac_fail_within(err, status, "--until: \"%s\"", text)
                                    : status;
    }
    LAC_FAIL_IF(!(until > 0) || until > c->run.end, err, LAC_EINPUT,
                "--until: \"%s\" must be > 0 and <= time.end, %s", text,
                cli_exact(c->run.end, "s").s);
    *end = until;
    return LAC_OK;
}

lac_status cli_blame(const lac_case *c, lac_status status, lac_error *err)
{
    return status == LAC_OK || c == NULL ? status : lac_fail_within(err, status, "%s", c->path);
}
