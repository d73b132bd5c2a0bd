// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the case of a command; errors and warnings are told by file, line and key. And monitoring
// data beside a run: observed and modelled motion in tables, and how far they differ.
#include "cli/report/report.h"

#include "base/date.h"
#include "cli/common/memory.h"
#include "cli/common/output.h"
#include "cli/common/words.h"
#include "cli/precursors/series.h"
#include "scene/estimate.h"
#include "store/past.h"
#include "store/store_cells.h"

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
    const lac_load_models models = lac_case_loads(c);
    lac_load_files *files = NULL;
    lac_load_set loads;
    lac_status status = LAC_OK;
    if (!lac_load_models_traits(&models).files) {
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
    for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++) {
        if (left_out[i].named) {
            LAC_TRY_RETURN(
                cli_report_add(report, c, left_out[i].key, left_out[i].message, true, err));
        }
    }
    return LAC_OK;
}

// The case of a command: of --from alone, that of the run's file.
static lac_status read_text(const cli_request *request, const lac_case_request *how, lac_case **c,
                            lac_case_issues *report, lac_error *err)
{
    lac_stored_past past;
    if (request->count > 0) {
        return lac_case_read(request->argument[0], how, c, report, err);
    }
    lac_status status = lac_stored_past_open(request->from, &past, err);
    if (status == LAC_OK) {
        const char *text = past.case_text;
        status = lac_case_read_text(request->from, text, strlen(text), how, c, report, err);
    }
    lac_stored_past_clear(&past);
    return status;
}

// --from and --at are initial.run.
static lac_status set_from(const cli_request *request, lac_case *c, lac_error *err)
{
    free(c->from.file);
    free(c->from.at);
    // a case elsewhere has its relative paths from there
    c->from.file = request->count > 0 ? realpath(request->from, NULL) : strdup(request->from);
    c->from.at = strdup(request->at != NULL ? request->at : "last");
    LAC_FAIL_IF(c->from.file == NULL, err, LAC_EIO, "%s: %s", request->from, strerror(errno));
    LAC_FAIL_MEMORY_IF(c->from.at == NULL, err);
    return LAC_OK;
}

// The system may end a process that takes more than there is, without a word. A grid of less than
// a GB is not asked about.
static lac_status ask_memory(const cli_request *request, const lac_case *c, lac_error *err)
{
    const lac_grid grid = lac_interface_grid(&c->interface);
    const double least = lac_estimate_least_memory(c);
    const double there = least > 1e9 ? (double)cli_memory_free("") : INFINITY;
    LAC_FAIL_IF(least > there, err, LAC_ENOMEM,
                "%s: interface: %zu x %zu cells take at least %.3g GB of memory, %.3g GB are free",
                request->count > 0 ? request->argument[0] : request->from, grid.nx, grid.ny,
                1e-9 * least, 1e-9 * there);
    return LAC_OK;
}

lac_status cli_case_read(const cli_request *request, lac_case_purpose purpose, lac_case **c,
                         lac_case_issues *report, lac_error *err)
{
    lac_case_issues own = {0};
    lac_case_issues *all = report != NULL ? report : &own;
    const lac_case_request how = {purpose, request->overrides, request->set_count};
    lac_status status = read_text(request, &how, c, all, err);
    if (status == LAC_OK && request->from != NULL) {
        status = set_from(request, *c, err);
    }
    const bool runs = purpose == LAC_FOR_RUN || purpose == LAC_FOR_FIT || purpose == LAC_FOR_CHECK;
    status = status == LAC_OK && runs ? ask_loads(*c, all, err) : status;
    status = status == LAC_OK && purpose == LAC_FOR_FIT ? ask_fit(*c, all, err) : status;
    cli_report_print_of(all, request, "");
    if (all->errors > 0) {
        err->message[0] = '\0'; // said already, line by line
    } else if (status == LAC_OK && purpose != LAC_FOR_CHECK) {
        status = ask_memory(request, *c, err);
    }
    lac_case_issues_clear(&own);
    return status;
}

lac_status cli_parse_quantity(const char *text, const char *unit, double *value, lac_error *err)
{
    lac_units *units = NULL;
    lac_status status = lac_units_create(&units, err);
    if (status == LAC_OK) {
        status = lac_units_parse(units, text, unit, value, err);
    }
    lac_units_free(units);
    return status;
}

lac_status cli_parse_time(const char *text, const lac_case *c, double *time, lac_error *err)
{
    double date;
    if (c->dated && lac_date_parse(text, &date)) {
        *time = date - c->start_date;
        return LAC_OK;
    }
    return cli_parse_quantity(text, "s", time, err);
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
    // of --from alone the case is in the file that many a message names
    const bool said = c != NULL && strncmp(err->message, c->path, strlen(c->path)) == 0;
    return status == LAC_OK || c == NULL || said ? status
                                                 : lac_fail_within(err, status, "%s", c->path);
}

enum { FEW_READINGS = 30 };

// A series on the run's clock: seconds as written count from the start of the run.
static lac_status read_one(const lac_case *c, size_t i, lac_series **out, lac_error *err)
{
    const char *path = c->compare[i].path;
    lac_series_def def = c->compare[i].columns;
    def.size = sizeof def;
    def.path = path;
    const lac_status status = lac_series_create(&def, out, err);
    LAC_FAIL_IF(status == LAC_OK && (*out)->dated && !c->dated, err, LAC_EINPUT,
                "%s: has dates, so time.start of %s must be a date to compare", path, c->path);
    for (size_t k = 0; status == LAC_OK && k < (*out)->n; k++) {
        (*out)->time[k] += c->dated && !(*out)->dated ? c->start_date : 0;
    }
    return status;
}

lac_status cli_compare_read(const cli_request *request, const lac_case *c, cli_compare *compare,
                            lac_error *err)
{
    *compare = (cli_compare){.source = c};
    if (c->compare_count == 0) {
        return LAC_OK;
    }
    compare->series = calloc(c->compare_count, sizeof(lac_series *));
    LAC_FAIL_MEMORY_IF(compare->series == NULL, err);
    compare->count = c->compare_count;
    for (size_t i = 0; i < compare->count; i++) {
        LAC_TRY_RETURN(read_one(c, i, &compare->series[i], err));
        cli_series_warn(request, c->compare[i].path, compare->series[i]);
    }
    return LAC_OK;
}

void cli_compare_clear(cli_compare *compare)
{
    for (size_t i = 0; i < compare->count; i++) {
        lac_series_free(compare->series[i]);
    }
    free(compare->series);
    *compare = (cli_compare){0};
}

static const char *name_of(const lac_compare_def *def)
{
    return def->label != NULL ? def->label : def->path;
}

// A line a reading: when, observed, modelled, their ratio. @param observed  NULL: none
static void print_column(const cli_compare *compare, const lac_series *series,
                         const lac_history *run, const double *observed, double offset)
{
    const bool rates = observed == series->velocity, dated = compare->source->dated;
    const char *unit = rates ? "m/s" : "m";
    if (observed == NULL || series->n > FEW_READINGS) {
        return;
    }
    printf("    %-21s %-18s %-18s modelled/observed\n", dated ? "date" : "time",
           rates ? "rate, observed" : "slip, observed", rates ? "modelled" : "modelled + offset");
    for (size_t k = 0; k < series->n; k++) {
        double slip = NAN, rate = NAN; // outside the run
        if (isnan(observed[k])) {
            continue;
        }
        (void)lac_history_eval(run, series->time[k], &slip, &rate);
        const double modelled = rates ? rate : slip + offset;
        const bool ratio = !isnan(modelled) && observed[k] != 0;
        const double t = series->time[k];
        printf("    %-21s %-18s %-18s %s\n", (dated ? cli_date(t) : cli_exact(t, "s")).s,
               cli_amount(observed[k], unit).s,
               isnan(modelled) ? "- (outside)" : cli_amount(modelled, unit).s,
               ratio ? cli_format("%.2g", modelled / observed[k]).s : "-");
    }
}

static void print_misfit(const lac_series *series, const lac_misfit *misfit)
{
    if (misfit->displacement_count > 0) {
        cli_row("  slip misfit", "rms %s over %zu readings, after an offset of %s",
                cli_amount(misfit->displacement_rms, "m").s, misfit->displacement_count,
                cli_amount(misfit->displacement_offset, "m").s);
    }
    if (misfit->velocity_count > 0) {
        cli_row("  rate misfit", "rms of log10 %.3g over %zu readings (a factor of %.2g)",
                misfit->log_rate_rms, misfit->velocity_count, pow(10, misfit->log_rate_rms));
    }
    if (misfit->displacement_count + misfit->velocity_count == 0) {
        cli_row("  misfit", "none: no reading lies within the run");
    }
    cli_row("  left out", "%zu outside the run, %zu missing, %zu duplicates", misfit->outside,
            series->missing, series->duplicates);
}

// What a series is laid beside: the joint, or the point that it is of.
static lac_history beside(const cli_compare *compare, size_t i, const cli_kept *kept)
{
    const char *name = compare->source->compare[i].point;
    const size_t point = name != NULL ? lac_case_point(compare->source, name) : SIZE_MAX;
    const double *slip = kept->values, *first = kept->values;
    if (first != NULL) {
        slip += (point < kept->points ? 3 + 2 * point : 1) * kept->room;
    }
    return (lac_history){kept->n, first, slip, first != NULL ? slip + kept->room : NULL};
}

void cli_compare_print(const cli_compare *compare, const cli_kept *kept)
{
    for (size_t i = 0; i < compare->count; i++) {
        const lac_series *series = compare->series[i];
        const lac_compare_def *def = &compare->source->compare[i];
        const lac_history history = beside(compare, i, kept), *run = &history;
        lac_misfit misfit = {0};
        lac_series_compare(series, run, &misfit);
        printf("\n  beside %s%s%s%s\n", name_of(def), def->point != NULL ? ", at point " : "",
               def->point != NULL ? def->point : "",
               compare->source->fit.named ? "" : ": a scene with stated assumptions, not a fit");
        print_column(compare, series, run, series->displacement, misfit.displacement_offset);
        print_column(compare, series, run, series->velocity, 0.0);
        print_misfit(series, &misfit);
        if (series->attribution != NULL && series->attribution[0] != '\0') {
            cli_wrap("    ", series->attribution);
        }
    }
}

static void write_readings(lac_json *json, const cli_compare *compare, const lac_series *series,
                           const lac_history *run)
{
    lac_json_open(json, "readings", '[');
    for (size_t k = 0; k < series->n && series->n <= FEW_READINGS; k++) {
        double slip = NAN, rate = NAN; // outside the run
        (void)lac_history_eval(run, series->time[k], &slip, &rate);
        lac_json_open(json, NULL, '{');
        if (compare->source->dated) {
            lac_json_text(json, "date", cli_date(series->time[k]).s);
        }
        lac_json_number(json, "time_s", series->time[k] - compare->source->start_date);
        lac_json_number(json, "observed_slip_m",
                        series->displacement != NULL ? series->displacement[k] : NAN);
        lac_json_number(json, "observed_slip_rate_m_s",
                        series->velocity != NULL ? series->velocity[k] : NAN);
        lac_json_number(json, "modelled_slip_m", slip);
        lac_json_number(json, "modelled_slip_rate_m_s", rate);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}

void cli_compare_json(lac_json *json, const cli_compare *compare, const cli_kept *kept)
{
    lac_json_open(json, "compare", '[');
    for (size_t i = 0; i < compare->count; i++) {
        const lac_compare_def *def = &compare->source->compare[i];
        const lac_series *series = compare->series[i];
        const lac_history history = beside(compare, i, kept), *run = &history;
        lac_misfit misfit = {0};
        lac_series_compare(series, run, &misfit);
        lac_json_open(json, NULL, '{');
        lac_json_text(json, "label", name_of(def));
        if (def->point != NULL) {
            lac_json_text(json, "point", def->point);
        }
        lac_json_text(json, "path", def->path);
        bool slips = misfit.displacement_count > 0, rates = misfit.velocity_count > 0;
        lac_json_integer(json, "slip_readings", (int64_t)misfit.displacement_count);
        lac_json_number(json, "slip_rms_m", slips ? misfit.displacement_rms : NAN);
        lac_json_number(json, "slip_offset_m", slips ? misfit.displacement_offset : NAN);
        lac_json_integer(json, "rate_readings", (int64_t)misfit.velocity_count);
        lac_json_number(json, "rate_rms_log10", rates ? misfit.log_rate_rms : NAN);
        lac_json_integer(json, "outside", (int64_t)misfit.outside);
        lac_json_integer(json, "missing", (int64_t)series->missing);
        lac_json_integer(json, "duplicates", (int64_t)series->duplicates);
        cli_series_warnings(json, series);
        write_readings(json, compare, series, run);
        lac_json_text(json, "attribution", series->attribution);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}
