// SPDX-License-Identifier: GPL-3.0-or-later
// A monitoring series in netCDF: variables of one dimension that they share.
#include <float.h>
#include <math.h>
#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

#include "base/netcdf.h"
#include "base/units.h"
#include "series/text.h"

enum { LONGEST_UNIT = 128, MOST_READINGS = 100000000 };

typedef struct series_file {
    const char *path;
    int id;
    int dim; ///< that all columns share
    size_t n;
} series_file;

bool lac_series_is_netcdf(FILE *stream)
{
    if (fseek(stream, 0, SEEK_CUR) != 0) {
        return false; // a pipe: what is read of it is gone, and netCDF cannot read one
    }
    char head[4];
    const bool found = lac_netcdf_begins(head, fread(head, 1, sizeof head, stream));
    rewind(stream);
    return found;
}

static lac_status check(const series_file *file, int code, const char *what, lac_error *err)
{
    return lac_netcdf_check(file->path, code, what, err);
}

// The variable of a column: numbers over the one dimension.
static lac_status find_column(series_file *file, const char *name, int *var, lac_error *err)
{
    int dim = -1;
    LAC_FAIL_IF(nc_inq_varid(file->id, name, var) != NC_NOERR, err, LAC_EINPUT,
                "%s: has no variable \"%s\"", file->path, name);
    LAC_FAIL_IF(!lac_netcdf_runs_over(file->id, *var, 1, &dim), err, LAC_EINPUT,
                "%s: %s: must be numbers over one dimension", file->path, name);
    LAC_FAIL_IF(file->dim >= 0 && dim != file->dim, err, LAC_EINPUT,
                "%s: %s: must have the dimension of the time", file->path, name);
    file->dim = dim;
    return LAC_OK;
}

// The numbers of a variable, missing ones NaN, packed ones unpacked.
static lac_status read_numbers(const series_file *file, int var, const char *name, double **out,
                               lac_error *err)
{
    double *x = malloc((file->n > 0 ? file->n : 1) * sizeof *x);
    LAC_FAIL_MEMORY_IF(x == NULL, err);
    lac_status status = check(file, nc_get_var_double(file->id, var, x), name, err);
    if (status != LAC_OK) {
        free(x);
        return status;
    }
    lac_netcdf_unpack(file->id, var, x, file->n);
    *out = x;
    return LAC_OK;
}

// A variable without units may be SI.
static lac_status ask(const series_file *file, const char *name, const char *si,
                      const struct lac_units *units, lac_series *s, lac_error *err)
{
    bool known = false;
    const lac_status status = lac_series_ask(units, file->path, name, si, &known, err);
    if (status == LAC_OK && !known) {
        lac_series_doubt(s, "%.48s: no unit is named: taken as %s", name, si);
    }
    return status;
}

// What the last bit of a number counts before the unit's scale; 0: a double's.
static double last_bit(const series_file *file, int var, const double *x)
{
    nc_type type = NC_DOUBLE;
    double most = 0.0;
    (void)nc_inq_vartype(file->id, var, &type);
    if (type == NC_DOUBLE) {
        return 0.0;
    }
    for (size_t i = 0; i < file->n; i++) {
        most = x[i] > most || -x[i] > most ? fabs(x[i]) : most;
    }
    return type == NC_FLOAT ? (double)FLT_EPSILON * most
                            : fabs(lac_netcdf_number(file->id, var, "scale_factor", 1.0));
}

static lac_status read_time(series_file *file, const lac_series_def *def,
                            const struct lac_units *units, lac_series *s, lac_error *err)
{
    char unit[LONGEST_UNIT];
    int var = -1;
    double scale = 1.0;
    double offset = 0.0;
    lac_status status;
    const char *name = def->time != NULL ? def->time : "time";
    LAC_TRY(find_column(file, name, &var, err));
    LAC_TRY(check(file, nc_inq_dimlen(file->id, file->dim, &file->n), name, err));
    if (file->n == 0 || file->n > MOST_READINGS) {
        LAC_TRY(lac_fail(err, LAC_EINPUT, "%s: has %zu readings; must have 1 to %d", file->path,
                         file->n, MOST_READINGS));
    }
    (void)lac_netcdf_text(file->id, var, "units", unit, sizeof unit);
    if (unit[0] == '\0') {
        LAC_TRY(ask(file, name, "s", units, s, err));
    } else {
        status = lac_units_time(units, unit, &scale, &offset, &s->dated, err);
        if (status != LAC_OK) {
            (void)lac_fail_within(err, status, "%s: %s: units \"%s\"", file->path, name, unit);
            goto out;
        }
    }
    s->time_unit = s->dated ? 0.0 : scale;
    lac_time_unit_name(s->dated          ? ""
                       : unit[0] == '\0' ? "s"
                                         : unit,
                       s->time_name, sizeof s->time_name);
    LAC_TRY(read_numbers(file, var, name, &s->time, err));
    for (size_t i = 0; i < file->n; i++) {
        s->time[i] = scale * s->time[i] + offset;
        if (!isfinite(s->time[i]) || (i > 0 && !(s->time[i] > s->time[i - 1]))) {
            LAC_TRY(lac_fail(err, LAC_EINPUT,
                             "%s: %s[%zu] = %.17g s; must be later than the one before", file->path,
                             name, i, s->time[i]));
        }
    }
out:
    return status;
}

typedef struct column {
    const char *name, *unit, *si;
    double **values, *digit;
} column;

static lac_status read_column(series_file *file, const column *c, const struct lac_units *units,
                              lac_series *s, lac_error *err)
{
    char unit[LONGEST_UNIT];
    int var = -1;
    double scale = 1.0;
    double offset = 0.0;
    lac_status status;
    LAC_TRY(find_column(file, c->name, &var, err));
    (void)lac_netcdf_text(file->id, var, "units", unit, sizeof unit);
    const char *from = unit[0] != '\0' ? unit : c->unit;
    if (from == NULL) {
        LAC_TRY(ask(file, c->name, c->si, units, s, err));
    } else {
        status = lac_units_convert(units, from, c->si, &scale, &offset, err);
        if (status != LAC_OK) {
            (void)lac_fail_within(err, status, "%s: %s: unit \"%s\"", file->path, c->name, from);
            goto out;
        }
    }
    LAC_TRY(read_numbers(file, var, c->name, c->values, err));
    double *x = *c->values;
    *c->digit = fabs(scale) * last_bit(file, var, x);
    for (size_t i = 0; i < file->n; i++) {
        x[i] = scale * x[i] + offset;
        s->missing += isnan(x[i]) ? 1 : 0;
        if (isinf(x[i])) {
            LAC_TRY(lac_fail(err, LAC_EINPUT, "%s: %s[%zu] is infinite", file->path, c->name, i));
        }
    }
out:
    return status;
}

static lac_status read_all(series_file *file, const lac_series_def *def,
                           const struct lac_units *units, lac_series *s, lac_error *err)
{
    double unused = 0.0;
    const column columns[] = {
        {def->displacement, def->displacement_unit, "m", &s->displacement, &s->displacement_digit},
        {def->velocity, def->velocity_unit, "m/s", &s->velocity, &s->velocity_digit},
        {def->value, def->value_unit, def->value_si, &s->value, &unused},
        {def->sigma, def->sigma_unit, "m", &s->sigma, &unused},
    };
    lac_status status;
    LAC_TRY(read_time(file, def, units, s, err));
    s->n = file->n;
    s->line = malloc(s->n * sizeof *s->line);
    s->attribution = strdup("");
    if (s->line == NULL || s->attribution == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    for (size_t i = 0; i < s->n; i++) {
        s->line[i] = i + 1;
    }
    for (size_t c = 0; c < sizeof columns / sizeof columns[0]; c++) {
        if (columns[c].name != NULL) {
            LAC_TRY(read_column(file, &columns[c], units, s, err));
        }
    }
out:
    return status;
}

lac_status lac_series_read_netcdf(const lac_series_def *def, const struct lac_units *units,
                                  lac_series **out, lac_error *err)
{
    series_file file = {.path = def->path, .id = -1, .dim = -1};
    LAC_TRY_RETURN(check(&file, nc_open(def->path, NC_NOWRITE, &file.id), "the file", err));
    lac_series *s = calloc(1, sizeof *s);
    lac_status status = s == NULL ? lac_fail_memory(err) : read_all(&file, def, units, s, err);
    (void)nc_close(file.id);
    if (status != LAC_OK) {
        lac_series_free(s);
        return status;
    }
    *out = s;
    return LAC_OK;
}
