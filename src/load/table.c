// SPDX-License-Identifier: GPL-3.0-or-later
// Readings of one column of a file, in SI units and on the clock of the run, for loads to use.
#include "load/kinds.h"

#include <gsl/gsl_interp.h>

#include "base/units.h"
#include "series/series.h"

enum { LONGEST = 256 };

// "level:m" is a name and a unit, "level" a name alone. NULL, reported, where it is neither.
static lac_status split_column(const char *text, char name[LONGEST], const char **unit,
                               lac_error *err)
{
    size_t length = strlen(text);
    const char *colon = strrchr(text, ':');
    size_t end = colon != NULL ? (size_t)(colon - text) : length;
    LAC_FAIL_IF(end == 0 || length >= LONGEST, err, LAC_EINPUT,
                "\"%.40s\" must be a column and its unit such as \"level:m\"", text);
    memcpy(name, text, end);
    name[end] = '\0';
    *unit = colon != NULL && colon[1] != '\0' ? colon + 1 : NULL;
    return LAC_OK;
}

static lac_status blame_factor(const char *per, const char *unit, const char *si, lac_error *err)
{
    char *end = NULL;
    LAC_FAIL_IF(per == NULL, err, LAC_EINPUT, "the column's unit \"%s\" must be one such as \"%s\"",
                unit, si);
    (void)strtod(per, &end);
    LAC_FAIL_IF(end == per, err, LAC_EINPUT,
                "per: \"%s\" must be a number and a unit such as \"1 %s%s%s\"", per, si,
                unit != NULL ? "/" : "", unit != NULL ? unit : "");
    return lac_fail(
        err, LAC_EINPUT,
        "one unit of the column (\"%s\") times per (\"%s\") must be a quantity such as \"1 %s\"",
        unit != NULL ? unit : "", per, si);
}

// What one unit of the column comes to: "9810 Pa/m" and "m" are 9810 Pa.
static lac_status find_factor(const struct lac_units *units, const char *per, const char *unit,
                              const char *si, double *factor, lac_error *err)
{
    char product[LONGEST];
    int length = snprintf(product, sizeof product, "%s %s", per != NULL ? per : "1",
                          unit != NULL ? unit : "");
    lac_status status = LAC_EINPUT;
    if (length > 0 && (size_t)length < sizeof product) {
        status = lac_units_parse(units, product, si, factor, err);
    }
    // A column without a unit whose `per` has none either is SI.
    if (status == LAC_OK && unit == NULL && per == NULL) {
        *factor = 1.0;
    }
    return status == LAC_EINPUT ? blame_factor(per, unit, si, err) : status;
}

// Readings that are there, on the clock of the run.
static lac_status keep_readings(const lac_series *series, double shift, double factor,
                                lac_readings *out, lac_error *err)
{
    out->t = malloc(series->n * sizeof *out->t);
    out->value = malloc(series->n * sizeof *out->value);
    LAC_FAIL_MEMORY_IF(out->t == NULL || out->value == NULL, err);
    for (size_t i = 0; i < series->n; i++) {
        if (isnan(series->value[i])) {
            continue;
        }
        out->t[out->n] = series->time[i] - shift;
        out->value[out->n] = factor * series->value[i];
        out->n++;
    }
    return LAC_OK;
}

// Notes what is doubtful but for the units of the time, which are seconds by the load's own word,
// and of the column, where `per` says what one of it makes.
static lac_status note_doubts(const lac_readings_def *def, const char *name,
                              const lac_series *series, lac_load_files *files, lac_error *err)
{
    const char *said[] = {def->time, def->per != NULL ? name : def->time};
    lac_status status = LAC_OK;
    for (size_t i = 0; files != NULL && i < series->doubts && status == LAC_OK; i++) {
        bool wanted = true;
        for (size_t k = 0; k < 2; k++) {
            const size_t n = strlen(said[k]);
            wanted = wanted && (strncmp(series->doubt[i], said[k], n) != 0 ||
                                strncmp(series->doubt[i] + n, ": ", 2) != 0);
        }
        status = wanted ? lac_load_files_note(files, def->path, series->doubt[i], err) : LAC_OK;
    }
    return status;
}

// The numbers of the column are read as they stand; `factor` has their unit.
static lac_status read_column(const lac_readings_def *def, const char *name, const char *unit,
                              const lac_load_clock *clock, lac_readings *out, lac_error *err)
{
    lac_units *units = NULL;
    lac_series *series = NULL;
    double factor = 1.0;
    lac_status status;
    LAC_TRY(lac_units_create(&units, err));
    LAC_TRY(find_factor(units, def->per, unit, def->si, &factor, err));
    lac_series_def file = {.path = def->path,
                           .time = def->time,
                           .value = name,
                           .value_unit = unit,
                           .value_si = unit != NULL       ? unit
                                       : def->per != NULL ? "1"
                                                          : def->si};
    LAC_TRY(lac_series_read(&file, units, &series, err));
    LAC_TRY(note_doubts(def, name, series, clock->files, err));
    if (series->dated && !clock->dated) {
        LAC_TRY(
            lac_fail(err, LAC_EINPUT, "%s: has dates, so time.start must be a date", def->path));
    }
    double shift = (series->dated ? clock->start : 0.0) - def->offset;
    LAC_TRY(keep_readings(series, shift, factor, out, err));
out:
    lac_series_free(series);
    lac_units_free(units);
    return status;
}

lac_status lac_readings_load(const lac_readings_def *def, const lac_load_clock *clock,
                             lac_readings *out, lac_error *err)
{
    char name[LONGEST];
    const char *unit = NULL;
    *out = (lac_readings){0};
    lac_status status = split_column(def->column, name, &unit, err);
    if (status == LAC_OK) {
        status = read_column(def, name, unit, clock, out, err);
    }
    if (status != LAC_OK) {
        lac_readings_clear(out);
    }
    return status;
}

void lac_readings_clear(lac_readings *readings)
{
    free(readings->t);
    free(readings->value);
    *readings = (lac_readings){0};
}

lac_signal lac_readings_at(const lac_readings *r, double t)
{
    if (t < r->t[0] || t >= r->t[r->n - 1]) {
        return (lac_signal){r->value[t < r->t[0] ? 0 : r->n - 1], 0.0};
    }
    const size_t i = lac_readings_before(r->t, r->n, t);
    const double h = r->t[i + 1] - r->t[i];
    const double rise = r->value[i + 1] - r->value[i];
    return (lac_signal){r->value[i] + (t - r->t[i]) / h * rise, rise / h};
}

size_t lac_readings_before(const double *t, size_t n, double at)
{
    return n > 0 && t[0] <= at ? gsl_interp_bsearch(t, at, 0, n) : SIZE_MAX;
}

double lac_readings_next(const double *t, size_t n, double at)
{
    size_t next = lac_readings_before(t, n, at) + 1; // SIZE_MAX + 1 is 0
    return next < n ? t[next] : INFINITY;
}
