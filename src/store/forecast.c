// SPDX-License-Identifier: GPL-3.0-or-later
// The file of forecasts: the motion they saw, and what each method said at each issue time.
#include "lacuna/store_forecast.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "store/indicators.h"

enum { READING, VELOCITY, ISSUE, METHOD, DIMENSIONS, MEANINGS = 512 };

typedef struct writer {
    const lac_nc *file;
    const lac_forecast_file *content;
    int dim[DIMENSIONS];
    size_t length[DIMENSIONS];
    double *row;
} writer;

// A variable, its dimensions (-1 after the last), and one of its values.
typedef struct variable {
    const char *name, *unit, *long_name, *comment;
    bool is_time, fill;
    int dims[3];
    double (*value)(const writer *w, size_t i);
} variable;

// Forecast i of all issue times and methods.
static const lac_forecast *forecast(const writer *w, size_t i)
{
    const lac_forecast_file *c = w->content;
    return c->rolling != NULL ? &c->rolling->forecast[i] : &c->outlook->forecast[i];
}

static const lac_forecast *issue(const writer *w, size_t i)
{
    return forecast(w, i * w->length[METHOD]);
}

#define VALUE(name, expression) \
    static double name(const writer *w, size_t i) { return (expression); }
VALUE(reading_time, w->content->outlook->motion->time[i])
VALUE(displacement, w->content->outlook->motion->displacement[i])
VALUE(velocity_time, w->content->outlook->motion->velocity_time[i])
VALUE(velocity, w->content->outlook->motion->velocity[i])
VALUE(issue_time, issue(w, i)->issue_time)
VALUE(window_start, issue(w, i)->window_start)
VALUE(failure_time, forecast(w, i)->time)
VALUE(low50, forecast(w, i)->low50)
VALUE(high50, forecast(w, i)->high50)
VALUE(low90, forecast(w, i)->low90)
VALUE(high90, forecast(w, i)->high90)
VALUE(rms, forecast(w, i)->fit.rms)
VALUE(misfit, forecast(w, i)->fit.misfit)
VALUE(relative_error, forecast(w, i)->fit.error)
VALUE(issued, forecast(w, i)->issued ? 1.0 : 0.0)

static const variable variables[] = {
    {"reading_time", "s", "time of the reading", NULL, true, false, {READING, -1}, reading_time},
    {"displacement",
     "m",
     "displacement",
     "without outliers, resets of the sensor taken out; its negative where it falls (attribute "
     "falling); the integral of the velocity where only that was given",
     false,
     false,
     {READING, -1},
     displacement},
    {"velocity_time",
     "s",
     "time of the velocity",
     NULL,
     true,
     false,
     {VELOCITY, -1},
     velocity_time},
    {"velocity", "m s-1", "velocity", "looks back only", false, false, {VELOCITY, -1}, velocity},
    {"issue_time",
     "s",
     "time at which the forecasts are issued",
     "nothing later was known to them",
     true,
     false,
     {ISSUE, -1},
     issue_time},
    {"window_start",
     "s",
     "start of what was fitted",
     "missing where nothing was",
     true,
     true,
     {ISSUE, -1},
     window_start},
    {"failure_time",
     "s",
     "forecast time of failure",
     "also where it is not issued, as far as the fit went",
     true,
     true,
     {ISSUE, METHOD, -1},
     failure_time},
    {"failure_time_low50",
     "s",
     "lower end of the 50 % interval",
     NULL,
     true,
     true,
     {ISSUE, METHOD, -1},
     low50},
    {"failure_time_high50",
     "s",
     "upper end of the 50 % interval",
     NULL,
     true,
     true,
     {ISSUE, METHOD, -1},
     high50},
    {"failure_time_low90",
     "s",
     "lower end of the 90 % interval",
     NULL,
     true,
     true,
     {ISSUE, METHOD, -1},
     low90},
    {"failure_time_high90",
     "s",
     "upper end of the 90 % interval",
     NULL,
     true,
     true,
     {ISSUE, METHOD, -1},
     high90},
    {"issued",
     "1",
     "1 where the forecast is issued",
     NULL,
     false,
     false,
     {ISSUE, METHOD, -1},
     issued},
    {"rms",
     "1",
     "rms of the residuals",
     "in m, of inv8, inv and slo in s/m: the residuals of inverse velocity; of a case fitted to "
     "velocities in their logarithm",
     false,
     true,
     {ISSUE, METHOD, -1},
     rms},
    {"misfit",
     "1",
     "rms of the residuals over the range of what was fitted",
     NULL,
     false,
     true,
     {ISSUE, METHOD, -1},
     misfit},
    {"relative_error",
     "1",
     "standard error of the logarithm of the remaining time, by the fit",
     NULL,
     false,
     true,
     {ISSUE, METHOD, -1},
     relative_error},
};

static lac_status put(writer *w, const variable *v, lac_error *err)
{
    int dims[3];
    int rank = 0;
    int id = 0;
    size_t count = 1;
    const bool dated = v->is_time && w->content->dated;
    lac_status status;
    for (; v->dims[rank] >= 0; rank++) {
        dims[rank] = w->dim[v->dims[rank]];
        count *= w->length[v->dims[rank]];
    }
    const lac_nc_var var = {.name = v->name,
                            .unit = dated ? "seconds since 1970-01-01 00:00:00" : v->unit,
                            .long_name = v->long_name,
                            .standard_name = dated ? "time" : NULL,
                            .comment = v->comment,
                            .coordinates =
                                v->dims[0] == ISSUE && rank == 2 ? "issue_time method" : NULL,
                            .type = NC_DOUBLE,
                            .fill = v->fill};
    for (size_t i = 0; i < count; i++) {
        const double value = v->value(w, i);
        w->row[i] = isfinite(value) ? value : NC_FILL_DOUBLE;
    }
    LAC_TRY(lac_nc_reals(w->file, &var, rank, dims, 0, w->row, &id, err));
    LAC_TRY(lac_nc_text(w->file, id, "calendar", dated ? "proleptic_gregorian" : NULL, err));
out:
    return status;
}

// The methods as flags: readers of netCDF-3 and -4 alike take them.
static lac_status put_methods(const writer *w, lac_error *err)
{
    int values[64];
    char meanings[MEANINGS] = "";
    int id = 0;
    const lac_nc_var var = {
        .name = "method", .unit = "1", .long_name = "method of forecasting", .type = NC_INT};
    lac_status status;
    for (size_t k = 0; k < w->length[METHOD]; k++) {
        const size_t used = strlen(meanings);
        values[k] = (int)k;
        (void)snprintf(meanings + used, sizeof meanings - used, "%s%s", k > 0 ? " " : "",
                       forecast(w, k)->kind->about.name);
    }
    LAC_TRY(lac_nc_define(w->file, &var, 1, &w->dim[METHOD], NULL, 0, &id, err));
    LAC_TRY(lac_nc_check(
        w->file->path,
        nc_put_att_int(w->file->id, id, "flag_values", NC_INT, w->length[METHOD], values), err,
        "write", "method"));
    LAC_TRY(lac_nc_text(w->file, id, "flag_meanings", meanings, err));
    LAC_TRY(lac_nc_check(w->file->path, nc_put_var_int(w->file->id, id, values), err, "write",
                         "method"));
out:
    return status;
}

// Why each was not issued, as text that is as long as the longest needs.
static lac_status put_reasons(const writer *w, lac_error *err)
{
    const size_t count = w->length[ISSUE] * w->length[METHOD];
    const lac_nc_var var = {.name = "reason",
                            .long_name = "why the forecast is not issued",
                            .comment = "empty where it is",
                            .coordinates = "issue_time method",
                            .type = NC_CHAR};
    size_t longest = 1;
    int dims[] = {w->dim[ISSUE], w->dim[METHOD], 0};
    int id = 0;
    lac_status status;
    for (size_t i = 0; i < count; i++) {
        const size_t n = strlen(forecast(w, i)->fit.reason);
        longest = n > longest ? n : longest;
    }
    char *text = calloc(count, longest);
    LAC_TRY(text != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t i = 0; i < count; i++) {
        const char *reason = forecast(w, i)->fit.reason;
        for (size_t k = 0; reason[k] != '\0'; k++) {
            text[i * longest + k] = reason[k];
        }
    }
    LAC_TRY(lac_nc_dim(w->file, "reason_length", longest, &dims[2], err));
    LAC_TRY(lac_nc_define(w->file, &var, 3, dims, NULL, 1, &id, err));
    LAC_TRY(lac_nc_text(w->file, id, "_Encoding", "utf-8", err));
    errno = 0;
    LAC_TRY(lac_nc_check(w->file->path, nc_put_var_text(w->file->id, id, text), err, "write",
                         var.name));
out:
    free(text);
    return status;
}

static lac_status put_attributes(const writer *w, lac_error *err)
{
    const lac_forecast_file *c = w->content;
    const lac_motion *m = c->outlook->motion;
    char date[32] = "";
    lac_status status;
    LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "source_file", c->source, err));
    LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "source_attribution", c->attribution, err));
    if (isfinite(c->failed_at)) {
        LAC_TRY(lac_nc_real(w->file, NC_GLOBAL, "failed_at_s", c->failed_at, err));
        LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "failed_at_date",
                            c->dated ? lac_date_format(c->failed_at, date, sizeof date) : NULL,
                            err));
    }
    if (isfinite(m->noise)) {
        LAC_TRY(lac_nc_real(w->file, NC_GLOBAL, "noise_m", m->noise, err));
    }
    LAC_TRY(lac_nc_integer(w->file, NC_GLOBAL, "outliers", (long long)m->outliers, err));
    LAC_TRY(lac_nc_integer(w->file, NC_GLOBAL, "resets", (long long)m->resets, err));
    LAC_TRY(
        lac_nc_integer(w->file, NC_GLOBAL, "resets_disbelieved", (long long)m->disbelieved, err));
    LAC_TRY(lac_nc_integer(w->file, NC_GLOBAL, "falling", m->falling ? 1 : 0, err));
    LAC_TRY(lac_nc_integer(w->file, NC_GLOBAL, "gaps", (long long)m->gaps, err));
    LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "status", c->interrupted ? "interrupted" : "complete",
                        err));
out:
    return status;
}

static lac_status put_all(const lac_nc *file, void *context, lac_error *err)
{
    writer *w = context;
    w->file = file;
    static const char *const names[DIMENSIONS] = {"reading", "velocity_reading", "issue", "method"};
    lac_status status = LAC_OK;
    for (int i = 0; i < DIMENSIONS; i++) {
        LAC_TRY(lac_nc_dim(w->file, names[i], w->length[i], &w->dim[i], err));
    }
    LAC_TRY(put_methods(w, err));
    for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++) {
        LAC_TRY(put(w, &variables[i], err));
    }
    LAC_TRY(put_reasons(w, err));
    LAC_TRY(lac_nc_indicators(w->file, w->content, w->dim[ISSUE], w->length[ISSUE], err));
    LAC_TRY(put_attributes(w, err));
out:
    return status;
}

lac_status lac_store_forecast(const char *path, bool force, const lac_provenance *provenance,
                              const lac_forecast_file *content, lac_error *err)
{
    static const char *const summary =
        "Forecasts of the time of failure of a slope, by several methods, and indicators of it, "
        "from what was known at each issue time.";
    const lac_outlook *o = content->outlook;
    writer w = {.content = content,
                .length = {o->motion->n, o->motion->velocities,
                           content->rolling != NULL ? content->rolling->issues : 1, o->count}};
    size_t most = w.length[ISSUE] * w.length[METHOD];
    for (int i = 0; i < DIMENSIONS; i++) {
        most = w.length[i] > most ? w.length[i] : most;
    }
    w.row = malloc(most * sizeof *w.row);
    lac_status status = w.row != NULL
                            ? lac_nc_write(path, force, provenance, summary, put_all, &w, err)
                            : lac_fail_memory(err);
    free(w.row);
    return status;
}
