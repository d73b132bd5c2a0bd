// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna report: a run, or readings and their forecasts, as one page to look at.
#include <time.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/precursors/precursors.h"
#include "cli/sweep/answers.h"
#include "lacuna/version.h"
#include "report/report.h"
#include "store/store_cells.h"
#include "store/store_file.h"
#include "sweep/ensemble.h"

enum { LONGEST_CASE = 1 << 18 };

// The case that a run's file holds; NULL where it holds none that can be read.
static lac_case *read_case(const char *run)
{
    const lac_case_request how = {.purpose = LAC_FOR_CELLS};
    lac_case *c = NULL;
    lac_error unsaid = {0};
    char *text = malloc(LONGEST_CASE);
    if (text != NULL &&
        lac_store_read_attribute(run, "case", text, LONGEST_CASE, &unsaid) == LAC_OK &&
        lac_case_read_text(run, text, strlen(text), &how, &c, NULL, &unsaid) != LAC_OK) {
        lac_case_free(c);
        c = NULL;
    }
    free(text);
    return c;
}

// A series that the run's case lays beside it under the same file name: its columns are known.
// @param point  that it is of; NULL: of any
static const lac_compare_def *find_compare(const lac_case *c, const char *path, const char *point)
{
    for (size_t i = 0; c != NULL && i < c->compare_count; i++) {
        const lac_compare_def *def = &c->compare[i];
        const bool of = point == NULL || (def->point != NULL && strcmp(def->point, point) == 0);
        if (of && strcmp(lac_path_last(def->path), lac_path_last(path)) == 0) {
            return def;
        }
    }
    return NULL;
}

// @param point  of the run that it is of, to be freed; NULL: of the whole joint
static lac_status read_series(const cli_request *request, lac_series **out, char **point,
                              lac_error *err)
{
    lac_case *c = cli_series_named(request) ? NULL : read_case(request->argument[0]);
    const lac_compare_def *known = find_compare(c, request->compare, request->point);
    const char *of = request->point == NULL && known != NULL ? known->point : request->point;
    *point = of != NULL ? strdup(of) : NULL;
    lac_units *units = NULL;
    lac_status status = of != NULL && *point == NULL ? lac_fail_memory(err) : LAC_OK;
    status = status == LAC_OK ? lac_units_create(&units, err) : status;
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
// @param point  as in read_series
static lac_status read_fitted(const char *path, lac_series **out, char **point, lac_error *err)
{
    char name[100];
    lac_series_def def = {.size = sizeof def, .path = path};
    lac_stored_file *file = NULL;
    lac_status status;
    LAC_TRY(lac_stored_file_open(path, &file, err));
    LAC_TRY(find_column(file, "reading_time", &def.time, err));
    LAC_TRY(find_column(file, "observed_displacement", &def.displacement, err));
    LAC_TRY(find_column(file, "observed_slip_rate", &def.velocity, err));
    LAC_LEAVE_IF(def.time == NULL || (def.displacement == NULL && def.velocity == NULL), err,
                 LAC_EIO, "%s: is not a file of lacuna fit", path);
    if (lac_stored_file_text(file, NULL, "point", name, sizeof name)) {
        *point = strdup(name);
        LAC_TRY(*point != NULL ? LAC_OK : lac_fail_memory(err));
    }
    LAC_TRY(lac_series_create(&def, out, err));
out:
    lac_stored_file_close(file);
    return status;
}

typedef enum input { RUN, FORECASTS, SERIES, ENSEMBLE } input;

// What the argument is, and whether the options go with it; a fit given in place of a run: what was
// meant.
static lac_status look_at(const cli_request *request, input *out, lac_error *err)
{
    const char *path = request->argument[0], *readings = NULL, *issues = NULL;
    const bool columns = cli_series_named(request);
    lac_stored_file *file = NULL;
    const bool known = lac_stored_file_open(path, &file, NULL) == LAC_OK;
    if (known) {
        (void)find_column(file, "reading_time", &readings, NULL);
        (void)find_column(file, "issue_time", &issues, NULL);
    }
    lac_stored_file_close(file);
    if (known && lac_ensemble_is(path)) {
        *out = ENSEMBLE;
        LAC_FAIL_IF(cli_given(request, CLI_OPT_COMPARE | CLI_OPT_SERIES | CLI_OPT_FORECAST |
                                           CLI_OPT_DRIVER | CLI_OPT_UNTIL | CLI_OPT_SET),
                    err, LAC_EINPUT, "%s: is the file of a sweep: it is shown alone", path);
        return LAC_OK;
    }
    LAC_FAIL_IF(request->sweep.by != NULL || request->sweep.of != NULL, err, LAC_EINPUT,
                "--by and --of: are of the file of a sweep, which %s is not", path);
    const bool netcdf = lac_stored_is_netcdf(path) || path[cli_stem(path, ".nc")] != '\0';
    *out = known ? (readings != NULL && issues != NULL ? FORECASTS : RUN)
                 : (netcdf && !columns ? RUN : SERIES);
    LAC_FAIL_IF(request->displacements.n > 1, err, LAC_EINPUT,
                "--displacement: report takes one column, and %zu were named",
                request->displacements.n);
    LAC_FAIL_IF(*out == RUN && readings != NULL, err, LAC_EINPUT,
                "%s: is the file of a fit: run the case beside it and lay the fit on that: lacuna "
                "report RUN.nc --fit %s",
                path, path);
    LAC_FAIL_IF(
        *out != RUN && (request->compare != NULL || request->fit != NULL || request->point != NULL),
        err, LAC_EINPUT,
        "%s: holds readings: --compare, --point and --fit lay something beside a run", path);
    LAC_FAIL_IF(*out == FORECASTS && cli_given(request, CLI_OPT_SERIES), err, LAC_EINPUT,
                "%s: holds forecasts, which were made from its readings: --displacement, "
                "--velocity ... say how a series is read",
                path);
    LAC_FAIL_IF(*out != SERIES && cli_given(request, CLI_OPT_FORECAST | CLI_OPT_DRIVER |
                                                         CLI_OPT_UNTIL | CLI_OPT_SET),
                err, LAC_EINPUT,
                "%s: is no series of readings: --failed-at, --since, --until ... say how its "
                "forecasts are made; lacuna precursors takes them",
                path);
    return LAC_OK;
}

static lac_status read_beside(const cli_request *request, lac_series **out, char **point,
                              lac_error *err)
{
    if (request->compare != NULL) {
        return read_series(request, out, point, err);
    }
    LAC_FAIL_IF(request->point != NULL, err, LAC_EINPUT,
                "--point says where a series was read: name it with --compare SERIES.csv");
    LAC_FAIL_IF(cli_given(request, CLI_OPT_SERIES), err, LAC_EINPUT,
                "--displacement, --velocity ... say how a series is read: name it with --compare "
                "SERIES.csv");
    return request->fit != NULL ? read_fitted(request->fit, out, point, err) : LAC_OK;
}

// The page of a sweep, which needs no series.
static lac_status write_ensemble(const cli_request *request, const char *path, lac_error *err)
{
    const char *file = request->argument[0];
    lac_case *c = read_case(file);
    lac_ensemble *e = NULL;
    lac_answers *answers = NULL;
    lac_sample sample;
    cli_question question;
    lac_status status;
    LAC_LEAVE_IF(request->sweep.by != NULL && c == NULL, err, LAC_EIO,
                 "%s: holds no case that could be read", file);
    LAC_TRY(lac_ensemble_read(file, &e, err));
    LAC_TRY(cli_question_read(request, c, e->extras, e->extra, &question, err));
    LAC_TRY(lac_ensemble_sample(e, &question.of, question.by, &sample, err));
    LAC_TRY(lac_answers_create(&sample, &answers, err));
    const lac_page_ensemble shown = {.sample = &sample,
                                     .answers = answers,
                                     .records = e->axis == LAC_SERIES_RATE ? 0 : e->records,
                                     .place = e->place,
                                     .label = e->axis == LAC_SERIES_LEFT ? "time left [s]" : NULL,
                                     .rate = e->rate};
    const lac_page_def def = {.run = file,
                              .ensemble = &shown,
                              .made_by = "lacuna " LACUNA_VERSION,
                              .now = (double)time(NULL)};
    LAC_TRY(lac_page_write(&def, path, cli_given(request, CLI_OPT_FORCE), err));
out:
    lac_answers_free(answers);
    lac_ensemble_free(e);
    lac_case_free(c);
    return status;
}

static lac_status write_page(const cli_request *request, input what, const char *path,
                             lac_error *err)
{
    const char *name = request->compare != NULL ? request->compare : request->fit;
    lac_series *series = NULL;
    char *forecasts = NULL, *point = NULL;
    lac_status status;
    if (what == RUN) {
        LAC_TRY(read_beside(request, &series, &point, err));
    } else if (what == SERIES) {
        // its forecasts lie beside the page while it is made, by the name of its part: what a
        // killed process leaves is taken away by the next one
        forecasts = lac_temp_file_name(path);
        LAC_TRY(forecasts != NULL ? LAC_OK : lac_fail_memory(err));
        (void)unlink(forecasts); // of a process of this number that is no more
        LAC_TRY(cli_precursors_file(request, forecasts, err));
    }
    const lac_page_def def = {.run = forecasts != NULL ? forecasts : request->argument[0],
                              .name = request->argument[0],
                              .series = series,
                              .series_name = series != NULL ? lac_path_last(name) : NULL,
                              .point = point,
                              .fit = request->fit,
                              .made_by = "lacuna " LACUNA_VERSION,
                              .now = (double)time(NULL)};
    LAC_TRY(lac_page_write(&def, path, cli_given(request, CLI_OPT_FORCE), err));
out:
    if (forecasts != NULL) {
        (void)unlink(forecasts);
    }
    free(forecasts);
    free(point);
    lac_series_free(series);
    return status;
}

lac_status cli_report_page(const cli_request *request, lac_error *err)
{
    char *path = request->output != NULL ? strdup(request->output)
                                         : cli_name_after(request->argument[0], ".html");
    input what = RUN;
    lac_status status;
    LAC_TRY(path != NULL ? cli_output_check(request, NULL, path, err) : lac_fail_memory(err));
    LAC_TRY(look_at(request, &what, err));
    LAC_TRY(what == ENSEMBLE ? write_ensemble(request, path, err)
                             : write_page(request, what, path, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        LAC_JSON_TEXTS(&(lac_json){.out = stdout}, "output", path);
    } else {
        cli_row("page", "%s", path);
    }
out:
    free(path);
    return status;
}
