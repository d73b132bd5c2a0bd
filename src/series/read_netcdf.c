// SPDX-License-Identifier: GPL-3.0-or-later
// A monitoring series in netCDF: variables of one dimension that they share.
#include <netcdf.h>

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
    LAC_TRY_RETURN(lac_netcdf_find(file->path, file->id, name, var, err));
    LAC_FAIL_IF(!lac_netcdf_runs_over(file->id, *var, 1, &dim), err, LAC_EINPUT,
                "%s: %s: must be numbers over one dimension", file->path, name);
    LAC_FAIL_IF(file->dim >= 0 && dim != file->dim, err, LAC_EINPUT,
                "%s: %s: must have the dimension of the time", file->path, name);
    file->dim = dim;
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

static lac_status read_time(const series_file *file, int var, const char *name,
                            const struct lac_units *units, lac_series *s, lac_error *err)
{
    char unit[LONGEST_UNIT];
    double scale = 1.0, offset = 0.0;
    (void)lac_netcdf_text(file->id, var, "units", unit, sizeof unit);
    if (unit[0] == '\0') {
        LAC_TRY_RETURN(ask(file, name, "s", units, s, err));
    } else {
        lac_status read = lac_units_time(units, unit, &scale, &offset, &s->dated, err);
        LAC_TRY_RETURN(lac_fail_within(err, read, "%s: %s: units \"%s\"", file->path, name, unit));
    }
    s->time_unit = s->dated ? 0.0 : scale;
    if (s->dated || strlen(unit) < sizeof s->time_name) {
        (void)snprintf(s->time_name, sizeof s->time_name, "%s",
                       s->dated          ? "UTC"
                       : unit[0] == '\0' ? "s"
                                         : unit);
    }
    LAC_TRY_RETURN(lac_netcdf_values(file->path, file->id, var, name, file->n, s->time, err));
    for (size_t i = 0; i < file->n; i++) {
        s->time[i] = scale * s->time[i] + offset;
        LAC_FAIL_IF(!isfinite(s->time[i]) || (i > 0 && !(s->time[i] > s->time[i - 1])), err,
                    LAC_EINPUT, "%s: %s[%zu] = %.17g s; must be later than the one before",
                    file->path, name, i, s->time[i]);
    }
    return LAC_OK;
}

typedef struct column {
    const char *name, *unit, *si;
    double *values, *digit;
} column;

static lac_status read_column(series_file *file, const column *c, const struct lac_units *units,
                              lac_series *s, lac_error *err)
{
    char unit[LONGEST_UNIT];
    int var = -1;
    double scale = 1.0, offset = 0.0;
    const double rounding = 1e-12;
    LAC_TRY_RETURN(find_column(file, c->name, &var, err));
    (void)lac_netcdf_text(file->id, var, "units", unit, sizeof unit);
    const char *from = unit[0] != '\0' ? unit : c->unit;
    // what drives a slope is turned into the unit that was named
    LAC_FAIL_IF(from == unit && c->unit != NULL && c->values != s->value &&
                    (lac_units_convert(units, unit, c->unit, &scale, &offset, NULL) != LAC_OK ||
                     fabs(scale - 1.0) > rounding || offset != 0.0),
                err, LAC_EINPUT,
                "%s: %s: the file says %s, and %s was named: which is it? name the file's",
                file->path, c->name, unit, c->unit);
    if (from == NULL) {
        LAC_TRY_RETURN(ask(file, c->name, c->si, units, s, err));
    } else {
        lac_status read = lac_units_convert(units, from, c->si, &scale, &offset, err);
        LAC_TRY_RETURN(
            lac_fail_within(err, read, "%s: %s: unit \"%s\"", file->path, c->name, from));
    }
    double *x = c->values;
    LAC_TRY_RETURN(lac_netcdf_values(file->path, file->id, var, c->name, file->n, x, err));
    *c->digit = fabs(scale) * last_bit(file, var, x);
    const lac_column all = {.n = file->n, .first = x, .stride = sizeof *x, .scale = 1.0};
    double code = 0.0;
    size_t count = 0;
    const size_t at = lac_series_find_code(&all, &code, &count);
    LAC_FAIL_IF(at < file->n, err, LAC_EINPUT, "%s: %s[%zu] = %.9g " LAC_CODE_IS, file->path,
                c->name, at, code, count, file->n);
    for (size_t i = 0; i < file->n; i++) {
        x[i] = scale * x[i] + offset;
        s->missing += isnan(x[i]) ? 1 : 0;
        LAC_FAIL_IF(isinf(x[i]), err, LAC_EINPUT, "%s: %s[%zu] is infinite", file->path, c->name,
                    i);
        LAC_FAIL_IF(c->si[0] == 'm' && fabs(x[i]) > LAC_SERIES_MOST, err, LAC_EINPUT,
                    "%s: %s[%zu] = %g %s is too large: at most 1e9 %s", file->path, c->name, i,
                    x[i], c->si, c->si);
    }
    return LAC_OK;
}

static lac_status read_all(series_file *file, const lac_series_def *def, const lac_components *axes,
                           const struct lac_units *units, lac_series **out, lac_error *err)
{
    const char *name = def->time != NULL ? def->time : "time";
    double unused = 0.0, finest[LAC_SERIES_AXES] = {0.0};
    int var = -1;
    LAC_TRY_RETURN(find_column(file, name, &var, err));
    LAC_TRY_RETURN(check(file, nc_inq_dimlen(file->id, file->dim, &file->n), name, err));
    LAC_FAIL_IF(file->n == 0 || file->n > MOST_READINGS, err, LAC_EINPUT,
                "%s: has %zu readings; must have 1 to %d", file->path, file->n, MOST_READINGS);
    LAC_TRY_RETURN(lac_series_new(def, axes, file->n, "", out, err));
    lac_series *s = *out;
    s->displacement_digits = s->velocity_digits = NULL; // a type's are all the same
    const column columns[] = {
        {def->displacement, def->displacement_unit, "m", s->displacement, &s->displacement_digit},
        {def->velocity, def->velocity_unit, "m/s", s->velocity, &s->velocity_digit},
        {def->value, def->value_unit, def->value_si, s->value, &unused},
        {def->sigma, def->sigma_unit, "m", s->sigma, &unused},
        {axes->name[0], axes->unit[0], "m", s->component[0], &finest[0]},
        {axes->name[1], axes->unit[1], "m", s->component[1], &finest[1]},
        {axes->name[2], axes->unit[2], "m", s->component[2], &finest[2]},
        {def->velocity_sigma, def->velocity_sigma_unit, "1", s->velocity_sigma, &unused},
        {def->velocity_most, def->velocity_most_unit, "m/s", s->velocity_most, &unused},
        {def->within, def->within_unit, "s", s->within, &unused},
    };
    LAC_TRY_RETURN(read_time(file, var, name, units, s, err));
    for (size_t i = 0; i < s->n; i++) {
        s->line[i] = i + 1;
    }
    for (size_t c = 0; c < sizeof columns / sizeof columns[0]; c++) {
        if (columns[c].name != NULL) {
            LAC_TRY_RETURN(read_column(file, &columns[c], units, s, err));
        }
    }
    for (size_t k = 0; k < axes->count; k++) {
        s->displacement_digit = fmax(s->displacement_digit, finest[k]);
    }
    return LAC_OK;
}

lac_status lac_series_read_netcdf(const lac_series_def *def, const struct lac_units *units,
                                  lac_series **out, lac_error *err)
{
    series_file file = {.path = def->path, .id = -1, .dim = -1};
    LAC_TRY_RETURN(lac_netcdf_open(def->path, &file.id, err));
    lac_components axes;
    lac_status status = lac_components_read(def, &axes, err);
    if (status == LAC_OK) {
        status = read_all(&file, def, &axes, units, out, err);
    }
    free(axes.owned);
    (void)nc_close(file.id);
    return status;
}
