// SPDX-License-Identifier: GPL-3.0-or-later
// Monitoring files as the command line names them: columns with units, times; warns of doubts.
#include "cli/precursors/series.h"

#include <unistd.h>

#include "base/date.h"
#include "cli/common/words.h"
#include "store/store_cells.h"
#include "store/store_file.h"

enum { MOST_SKIPPED = 1000000 };

// Splits "column:unit", if given, at its last colon, in a copy.
static lac_status split(const char *option, const char *text, char **owned, const char **column,
                        const char **unit, lac_error *err)
{
    if (text == NULL) {
        return LAC_OK;
    }
    const char *colon = strrchr(text, ':');
    LAC_FAIL_IF(colon == text || (colon != NULL && colon[1] == '\0'), err, LAC_EINPUT,
                "--%s: \"%s\" must be COLUMN:UNIT, such as \"disp_mm:mm\"", option, text);
    *column = *owned = strdup(text);
    LAC_FAIL_MEMORY_IF(*owned == NULL, err);
    *unit = NULL;
    if (colon != NULL) {
        (*owned)[colon - text] = '\0';
        *unit = colon + 1;
    }
    return LAC_OK;
}

// A file that is not there, or is a damaged run, has no columns to be asked for. To ask a table for
// a column that none has is to be told which there are.
static lac_status ask_for_columns(const lac_series_def *def, const lac_units *units, lac_error *err)
{
    static const char before[] = "its columns are ";
    lac_series_def none = *def;
    lac_series *series = NULL;
    lac_error told = {""};
    LAC_FAIL_IF(access(def->path, R_OK) != 0, err, LAC_EIO, "%s: %s", def->path, strerror(errno));
    if (lac_stored_is_netcdf(def->path)) {
        lac_stored_file *file = NULL;
        LAC_TRY_RETURN(lac_stored_file_open(def->path, &file, err));
        lac_stored_file_close(file);
    } else {
        none.displacement = "\n";
        none.displacement_unit = "m";
        (void)lac_series_read(&none, units, &series, &told);
        lac_series_free(series);
    }
    const char *names = strstr(told.message, before);
    const char *end = names != NULL ? strchr(names, ']') : NULL; // of the first that has its unit
    const char *first = end;
    while (end != NULL && first > names + strlen(before) && strncmp(first - 2, ", ", 2) != 0) {
        first--;
    }
    return lac_fail(err, LAC_EINPUT,
                    "%s: which column is what? --displacement COLUMN:UNIT and/or --velocity "
                    "COLUMN:UNIT%s%s%s%.*s%s",
                    def->path, names != NULL ? "; " : "", names != NULL ? names : "",
                    end != NULL ? "; perhaps --displacement \"" : "",
                    end != NULL ? (int)(end + 1 - first) : 0, end != NULL ? first : "",
                    end != NULL ? "\"" : "");
}

// The words that are no columns of values.
static lac_status take_words(const cli_series_words *words, lac_series_def *def, lac_error *err)
{
    const struct {
        const char *word, **to;
    } texts[] = {{words->time, &def->time},
                 {words->time_format, &def->time_format},
                 {words->clock, &def->clock},
                 {words->components, &def->components},
                 {words->line_of_sight, &def->line_of_sight}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        *texts[i].to = texts[i].word != NULL ? texts[i].word : *texts[i].to;
    }
    if (words->skip != NULL) {
        char *end = NULL;
        def->skip = strtoll(words->skip, &end, 10);
        LAC_FAIL_IF(end == words->skip || *end != '\0' || def->skip < 0 || def->skip > MOST_SKIPPED,
                    err, LAC_EINPUT, "--skip: \"%s\" must be a number of lines, 0 to %d",
                    words->skip, (int)MOST_SKIPPED);
    }
    return LAC_OK;
}

// The main direction of motion is that of the readings that are used.
static lac_status project(const cli_request *request, const lac_units *units, lac_series *series,
                          lac_error *err)
{
    char sight[LAC_SERIES_DIRECTION];
    double until = INFINITY;
    size_t n = 0;
    if (series->component[0] == NULL || series->sighted) {
        return LAC_OK;
    }
    LAC_FAIL_IF(
        request->forecast.rolling != NULL, err, LAC_EINPUT,
        "--rolling: the main direction of motion is that of all readings, which is not known "
        "at each: --line-of-sight \"%s\" takes it as known",
        lac_series_direction(series, sight, sizeof sight));
    if (request->until != NULL) {
        LAC_TRY_RETURN(cli_series_time("until", request->until, series->dated, units, &until, err));
    }
    while (n < series->n && series->time[n] <= until) {
        n++;
    }
    lac_series_project(series, n);
    return LAC_OK;
}

bool cli_series_named(const cli_request *request)
{
    const cli_series_words *words = &request->series;
    return words->displacement != NULL || words->velocity != NULL || words->components != NULL;
}

lac_status cli_series_read(const cli_request *request, const lac_series_def *known,
                           const char *path, const lac_units *units, lac_series **out,
                           lac_error *err)
{
    const cli_series_words *words = &request->series;
    lac_series_def def = !cli_series_named(request) && known != NULL ? *known : (lac_series_def){0};
    char *owned[3] = {NULL};
    lac_status status;
    *out = NULL;
    def.path = path;
    LAC_TRY(take_words(words, &def, err));
    LAC_TRY(split("displacement", words->displacement, &owned[0], &def.displacement,
                  &def.displacement_unit, err));
    LAC_TRY(split("velocity", words->velocity, &owned[1], &def.velocity, &def.velocity_unit, err));
    if (def.displacement == NULL && def.velocity == NULL && def.components == NULL) {
        LAC_TRY(ask_for_columns(&def, units, err));
    }
    LAC_LEAVE_IF(words->sigma != NULL && def.displacement == NULL && def.components == NULL, err,
                 LAC_EINPUT, "--sigma: is of displacements: name --displacement too");
    LAC_TRY(split("sigma", words->sigma, &owned[2], &def.sigma, &def.sigma_unit, err));
    LAC_TRY(lac_series_read(&def, units, out, err));
    LAC_TRY(project(request, units, *out, err));
    cli_series_warn(request, path, *out);
out:
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) {
        free(owned[i]);
    }
    LAC_MADE(status, out, lac_series_free);
}

void cli_series_warn(const cli_request *request, const char *path, const lac_series *series)
{
    for (size_t i = 0; i < series->doubts && !cli_given(request, CLI_OPT_QUIET); i++) {
        cli_note("warning: %s: %s", path, series->doubt[i]);
    }
}

void cli_series_warnings(lac_json *json, const lac_series *series)
{
    lac_json_open(json, "warnings", '[');
    for (size_t i = 0; i < series->doubts; i++) {
        lac_json_text(json, NULL, series->doubt[i]);
    }
    lac_json_close(json, ']');
}

lac_status cli_series_time(const char *option, const char *text, bool dated, const lac_units *units,
                           double *time, lac_error *err)
{
    if (dated) {
        return lac_date_parse(text, time) ? LAC_OK
                                          : lac_fail(err, LAC_EINPUT,
                                                     "--%s: \"%s\" must be a date like 2015-07-02 "
                                                     "or 2015-07-02T10:07Z, for the file has dates",
                                                     option, text);
    }
    lac_status status = lac_units_parse(units, text, "s", time, err);
    return lac_fail_within(err, status, "--%s: \"%s\"", option, text);
}
