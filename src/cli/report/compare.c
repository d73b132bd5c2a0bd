// SPDX-License-Identifier: GPL-3.0-or-later
// Monitoring data beside a run: observed and modelled motion in tables, and how far they differ.
#include "cli/report/compare.h"

#include <math.h>
#include <stdlib.h>

#include "base/units.h"
#include "cli/common/words.h"
#include "cli/precursors/series.h"

enum { FEW_READINGS = 30 };

// A series on the run's clock: seconds as written count from the start of the run.
static lac_status read_one(const lac_case *c, size_t i, const lac_units *units, lac_series **out,
                           lac_error *err)
{
    const char *path = c->compare[i].path;
    lac_series_def def = c->compare[i].columns;
    def.path = path;
    const lac_status status = lac_series_read(&def, units, out, err);
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
    lac_units *units = NULL;
    lac_status status = LAC_OK;
    *compare = (cli_compare){.source = c};
    if (c->compare_count == 0) {
        return LAC_OK;
    }
    compare->series = calloc(c->compare_count, sizeof(lac_series *));
    LAC_FAIL_MEMORY_IF(compare->series == NULL, err);
    compare->count = c->compare_count;
    LAC_TRY(lac_units_create(&units, err));
    for (size_t i = 0; i < compare->count; i++) {
        LAC_TRY(read_one(c, i, units, &compare->series[i], err));
        cli_series_warn(request, c->compare[i].path, compare->series[i]);
    }
out:
    lac_units_free(units);
    return status;
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

static cli_text format_time(const cli_compare *compare, double t)
{
    return compare->source->dated ? cli_date(t) : cli_exact(t, "s");
}

// A line a reading: when, observed, modelled, their ratio. @param observed  NULL: none
static void print_column(const cli_compare *compare, const lac_series *series,
                         const lac_history *run, const double *observed, double offset)
{
    const bool rates = observed == series->velocity;
    const char *unit = rates ? "m/s" : "m";
    if (observed == NULL || series->n > FEW_READINGS) {
        return;
    }
    printf("    %-21s %-18s %-18s modelled/observed\n", compare->source->dated ? "date" : "time",
           rates ? "rate, observed" : "slip, observed", rates ? "modelled" : "modelled + offset");
    for (size_t k = 0; k < series->n; k++) {
        double slip = NAN, rate = NAN; // outside the run
        if (isnan(observed[k])) {
            continue;
        }
        (void)lac_history_eval(run, series->time[k], &slip, &rate);
        const double modelled = rates ? rate : slip + offset;
        const bool ratio = !isnan(modelled) && observed[k] != 0;
        printf("    %-21s %-18s %-18s %s\n", format_time(compare, series->time[k]).s,
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

static void print_one(const cli_compare *compare, size_t i, const lac_history *run)
{
    const lac_series *series = compare->series[i];
    lac_misfit misfit = {0};
    lac_series_compare(series, run, &misfit);
    printf("\n  beside %s%s\n", name_of(&compare->source->compare[i]),
           compare->source->fit.named ? "" : ": a scene with stated assumptions, not a fit");
    print_column(compare, series, run, series->displacement, misfit.displacement_offset);
    print_column(compare, series, run, series->velocity, 0.0);
    print_misfit(series, &misfit);
    if (series->attribution != NULL && series->attribution[0] != '\0') {
        cli_wrap("    ", series->attribution);
    }
}

void cli_compare_print(const cli_compare *compare, const lac_history *run)
{
    for (size_t i = 0; i < compare->count; i++) {
        print_one(compare, i, run);
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

static void write_misfit(lac_json *json, const lac_misfit *misfit)
{
    bool slips = misfit->displacement_count > 0, rates = misfit->velocity_count > 0;
    lac_json_integer(json, "slip_readings", (int64_t)misfit->displacement_count);
    lac_json_number(json, "slip_rms_m", slips ? misfit->displacement_rms : NAN);
    lac_json_number(json, "slip_offset_m", slips ? misfit->displacement_offset : NAN);
    lac_json_integer(json, "rate_readings", (int64_t)misfit->velocity_count);
    lac_json_number(json, "rate_rms_log10", rates ? misfit->log_rate_rms : NAN);
    lac_json_integer(json, "outside", (int64_t)misfit->outside);
}

static void write_one(lac_json *json, const cli_compare *compare, size_t i, const lac_history *run)
{
    const lac_compare_def *def = &compare->source->compare[i];
    const lac_series *series = compare->series[i];
    lac_misfit misfit = {0};
    lac_series_compare(series, run, &misfit);
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "label", name_of(def));
    lac_json_text(json, "path", def->path);
    write_misfit(json, &misfit);
    lac_json_integer(json, "missing", (int64_t)series->missing);
    lac_json_integer(json, "duplicates", (int64_t)series->duplicates);
    cli_series_warnings(json, series);
    write_readings(json, compare, series, run);
    lac_json_text(json, "attribution", series->attribution);
    lac_json_close(json, '}');
}

void cli_compare_json(lac_json *json, const cli_compare *compare, const lac_history *run)
{
    lac_json_open(json, "compare", '[');
    for (size_t i = 0; i < compare->count; i++) {
        write_one(json, compare, i, run);
    }
    lac_json_close(json, ']');
}
