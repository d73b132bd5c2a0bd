// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna report: a run as one page to look at.
#define _GNU_SOURCE // asprintf
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "cli/report/report.h"
#include "data/json.h"
#include "lacuna/version.h"
#include "report/report.h"
#include "store/store.h"
#include "store/store_file.h"

enum { LONGEST_CASE = 1 << 18 };

// -o, else RUN.html in this folder.
static char *output_path(const cli_request *request)
{
    if (request->output != NULL) {
        return strdup(request->output);
    }
    const char *name = lac_page_name(request->argument[0]);
    const size_t length = strlen(name);
    const size_t stem = length > 3 && strcmp(name + length - 3, ".nc") == 0 ? length - 3 : length;
    char *path;
    return asprintf(&path, "%.*s.html", (int)stem, name) >= 0 ? path : NULL;
}

// The case that a run's file holds; NULL where it holds none that can be read.
static lac_case *read_case(const char *run)
{
    const lac_case_request how = {.purpose = LAC_FOR_CELLS};
    lac_case_issues report = {0};
    lac_case *c = NULL;
    lac_error unsaid = {0};
    char *text = malloc(LONGEST_CASE);
    if (text != NULL &&
        lac_store_read_attribute(run, "case", text, LONGEST_CASE, &unsaid) == LAC_OK &&
        lac_case_read_text(run, text, strlen(text), &how, &c, &report, &unsaid) != LAC_OK) {
        lac_case_free(c);
        c = NULL;
    }
    lac_case_issues_clear(&report);
    free(text);
    return c;
}

// A series that the run's case lays beside it under the same file name: its columns are known.
static const lac_compare_def *find_compare(const lac_case *c, const char *path)
{
    for (size_t i = 0; c != NULL && i < c->compare_count; i++) {
        if (strcmp(lac_page_name(c->compare[i].path), lac_page_name(path)) == 0) {
            return &c->compare[i];
        }
    }
    return NULL;
}

static lac_status read_series(const cli_request *request, lac_series **out, lac_error *err)
{
    const bool named = request->series.displacement != NULL || request->series.velocity != NULL;
    lac_case *c = named ? NULL : read_case(request->argument[0]);
    const lac_compare_def *known = find_compare(c, request->compare);
    lac_units *units = NULL;
    lac_status status = lac_units_create(&units, err);
    if (status == LAC_OK) {
        status = cli_series_read(request, known != NULL ? &known->columns : NULL, request->compare,
                                 units, out, err);
    }
    lac_units_free(units);
    lac_case_free(c);
    return status;
}

// The name of a fit's variable, NULL where all of its values are missing.
static lac_status find_column(const lac_stored_file *file, const char *name, const char **out,
                              lac_error *err)
{
    lac_stored_values values = {0};
    const lac_status status = lac_stored_file_values(file, name, &values, err);
    *out = NULL;
    for (size_t i = 0; status == LAC_OK && values.value != NULL && i < values.n; i++) {
        *out = isfinite(values.value[i]) ? name : *out;
    }
    lac_stored_values_clear(&values);
    return status;
}

// The readings that a fit was made from, of the file that it left.
static lac_status read_fitted(const char *path, lac_series **out, lac_error *err)
{
    lac_series_def def = {.size = sizeof def, .path = path};
    lac_stored_file *file = NULL;
    lac_status status;
    LAC_TRY(lac_stored_file_open(path, &file, err));
    LAC_TRY(find_column(file, "reading_time", &def.time, err));
    LAC_TRY(find_column(file, "observed_displacement", &def.displacement, err));
    LAC_TRY(find_column(file, "observed_slip_rate", &def.velocity, err));
    LAC_LEAVE_IF(def.time == NULL || (def.displacement == NULL && def.velocity == NULL), err,
                 LAC_EIO, "%s: is not a file of lacuna fit", path);
    LAC_TRY(lac_series_create(&def, out, err));
out:
    lac_stored_file_close(file);
    return status;
}

// A fit or forecasts given in place of a run: what was meant.
static lac_status check_run(const char *path, lac_error *err)
{
    lac_stored_file *file = NULL;
    const char *readings = NULL, *issues = NULL;
    if (lac_stored_file_open(path, &file, NULL) == LAC_OK) {
        (void)find_column(file, "reading_time", &readings, NULL);
        (void)find_column(file, "issue_time", &issues, NULL);
    }
    lac_stored_file_close(file);
    LAC_FAIL_IF(readings != NULL && issues != NULL, err, LAC_EINPUT,
                "%s: holds forecasts, not a run: tools/plot/plot_precursors.py draws them; report "
                "shows a run, and forecasts of what is laid beside it",
                path);
    LAC_FAIL_IF(readings != NULL, err, LAC_EINPUT,
                "%s: is the file of a fit: run the case beside it and lay the fit on that: lacuna "
                "report RUN.nc --fit %s",
                path, path);
    return LAC_OK;
}

static lac_status read_beside(const cli_request *request, lac_series **out, lac_error *err)
{
    if (request->compare != NULL) {
        return read_series(request, out, err);
    }
    LAC_FAIL_IF(cli_given(request, CLI_OPT_SERIES), err, LAC_EINPUT,
                "--displacement, --velocity ... say how a series is read: name it with --compare "
                "SERIES.csv");
    return request->fit != NULL ? read_fitted(request->fit, out, err) : LAC_OK;
}

lac_status cli_report_page(const cli_request *request, lac_error *err)
{
    lac_series *series = NULL;
    char *path = output_path(request);
    lac_status status;
    LAC_TRY(path != NULL ? cli_output_check(request, NULL, path, err) : lac_fail_memory(err));
    LAC_TRY(check_run(request->argument[0], err));
    LAC_TRY(read_beside(request, &series, err));
    const char *name = request->compare != NULL ? request->compare : request->fit;
    const lac_page_def def = {.run = request->argument[0],
                              .series = series,
                              .series_name = series != NULL ? lac_page_name(name) : NULL,
                              .fit = request->fit,
                              .made_by = "lacuna " LACUNA_VERSION,
                              .now = (double)time(NULL)};
    LAC_TRY(lac_page_write(&def, path, cli_given(request, CLI_OPT_FORCE), err));
    if (cli_given(request, CLI_OPT_JSON)) {
        LAC_JSON_TEXTS(&(lac_json){.out = stdout}, "output", path);
    } else {
        cli_row("page", "%s", path);
    }
out:
    lac_series_free(series);
    free(path);
    return status;
}
