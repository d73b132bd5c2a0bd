// SPDX-License-Identifier: GPL-3.0-or-later
// A quantity over a plane and maybe over time, from netCDF: its values, and where and when they
// stand.
#include <netcdf.h>

#include "base/netcdf.h"
#include "base/units.h"
#include "series/field.h"

enum { LONGEST_UNIT = 128, MOST_VALUES = 1000000000 };

typedef struct source {
    const char *path;
    int id;
    const struct lac_units *units;
} source;

static lac_status unit_of(const source *file, int var, const char *name, const char *like,
                          char unit[LONGEST_UNIT], lac_error *err)
{
    (void)lac_netcdf_text(file->id, var, "units", unit, LONGEST_UNIT);
    LAC_FAIL_IF(unit[0] == '\0', err, LAC_EINPUT, "%s: %s has no units; must have some like %s",
                file->path, name, like);
    return LAC_OK;
}

// The numbers of a variable, in SI units. @param length  how many
static lac_status read_numbers(const source *file, int var, const char *name, const char *si,
                               size_t length, double *x, lac_error *err)
{
    char unit[LONGEST_UNIT];
    double scale = 1.0, offset = 0.0;
    LAC_TRY_RETURN(unit_of(file, var, name, si, unit, err));
    lac_status status = lac_units_convert(file->units, unit, si, &scale, &offset, err);
    LAC_TRY_RETURN(lac_fail_within(err, status, "%s: %s: unit \"%s\"", file->path, name, unit));
    LAC_TRY_RETURN(lac_netcdf_values(file->path, file->id, var, name, length, x, err));
    for (size_t i = 0; i < length; i++) {
        x[i] = scale * x[i] + offset;
    }
    return LAC_OK;
}

// The coordinates of a dimension: their variable, and room for them.
static lac_status find_axis(const source *file, int dim, const char *what, size_t *n, double **x,
                            char name[NC_MAX_NAME + 1], int *var, lac_error *err)
{
    bool found = lac_netcdf_axis(file->id, dim, name, var);
    LAC_FAIL_IF(!found || nc_inq_dimlen(file->id, dim, n) != NC_NOERR, err, LAC_EINPUT,
                "%s: the dimension \"%s\" has no coordinates: must have a variable of its name, "
                "the %s",
                file->path, name, what);
    LAC_FAIL_IF(*n == 0, err, LAC_EINPUT, "%s: %s is empty", file->path, name);
    *x = *n <= MOST_VALUES ? malloc(*n * sizeof **x) : NULL;
    return *x != NULL ? LAC_OK : lac_fail_memory(err);
}

static lac_status check_rising(const source *file, const char *name, const double *x, size_t n,
                               lac_error *err)
{
    for (size_t i = 0; i < n; i++) {
        LAC_FAIL_IF(!isfinite(x[i]) || (i > 0 && !(x[i] > x[i - 1])), err, LAC_EINPUT,
                    "%s: %s[%zu] = %g; must be a number, and above the one before", file->path,
                    name, i, x[i]);
    }
    return LAC_OK;
}

static lac_status read_place(const source *file, int dim, const char *what, const char *other,
                             size_t *n, double **x, lac_error *err)
{
    char name[NC_MAX_NAME + 1] = "";
    int var = -1;
    LAC_TRY_RETURN(find_axis(file, dim, what, n, x, name, &var, err));
    LAC_FAIL_IF(strcmp(name, other) == 0, err, LAC_EINPUT,
                "%s: has \"%s\" where %s must be: the order must be (y, x) or (time, y, x)",
                file->path, name, what);
    LAC_TRY_RETURN(read_numbers(file, var, name, "m", *n, *x, err));
    return check_rising(file, name, *x, *n, err);
}

static lac_status read_times(const source *file, int dim, lac_field *out, lac_error *err)
{
    char name[NC_MAX_NAME + 1] = "";
    char unit[LONGEST_UNIT];
    double scale = 1.0, offset = 0.0;
    int var = -1;
    LAC_TRY_RETURN(find_axis(file, dim, "time", &out->nt, &out->t, name, &var, err));
    LAC_TRY_RETURN(unit_of(file, var, name, "s, or days since 2015-06-07", unit, err));
    lac_status status = lac_units_time(file->units, unit, &scale, &offset, &out->dated, err);
    LAC_TRY_RETURN(lac_fail_within(err, status, "%s: %s: units \"%s\"", file->path, name, unit));
    LAC_TRY_RETURN(lac_netcdf_values(file->path, file->id, var, name, out->nt, out->t, err));
    for (size_t i = 0; i < out->nt; i++) {
        out->t[i] = scale * out->t[i] + offset;
    }
    return check_rising(file, name, out->t, out->nt, err);
}

static lac_status read_all(const source *file, const char *variable, const char *si, lac_field *out,
                           lac_error *err)
{
    int var = -1;
    int dims[3];
    LAC_TRY_RETURN(lac_netcdf_find(file->path, file->id, variable, &var, err));
    bool timed = lac_netcdf_runs_over(file->id, var, 3, dims);
    LAC_FAIL_IF(!timed && !lac_netcdf_runs_over(file->id, var, 2, dims), err, LAC_EINPUT,
                "%s: %s must be numbers over (y, x) or (time, y, x)", file->path, variable);
    if (timed) {
        LAC_TRY_RETURN(read_times(file, dims[0], out, err));
    }
    LAC_TRY_RETURN(read_place(file, dims[timed ? 1 : 0], "y", "x", &out->ny, &out->y, err));
    LAC_TRY_RETURN(read_place(file, dims[timed ? 2 : 1], "x", "y", &out->nx, &out->x, err));
    size_t maps = timed ? out->nt : 1;
    bool fits = out->nx <= MOST_VALUES / out->ny && maps <= MOST_VALUES / (out->nx * out->ny);
    size_t length = maps * out->ny * out->nx;
    out->value = fits ? malloc(length * sizeof *out->value) : NULL;
    LAC_FAIL_MEMORY_IF(out->value == NULL, err);
    return read_numbers(file, var, variable, si, length, out->value, err);
}

lac_status lac_field_read(const char *path, const char *variable, const char *si,
                          const struct lac_units *units, lac_field *out, lac_error *err)
{
    source file = {path, -1, units};
    *out = (lac_field){0};
    LAC_TRY_RETURN(lac_netcdf_open(path, &file.id, err));
    lac_status status = read_all(&file, variable, si, out, err);
    (void)nc_close(file.id);
    if (status != LAC_OK) {
        lac_field_clear(out);
    }
    return status;
}

void lac_field_clear(lac_field *field)
{
    free(field->t);
    free(field->y);
    free(field->x);
    free(field->value);
    *field = (lac_field){0};
}
