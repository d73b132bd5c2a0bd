// SPDX-License-Identifier: GPL-3.0-or-later
// netCDF: a variable over (y, x), as GMT writes it, or `heights` over (x, y), as SurfaceTopography.
#include <netcdf.h>
#include <netcdf_mem.h>
#include <strings.h>

#include "base/need.h"
#include "base/netcdf.h"
#include "surface/read.h"

typedef struct grid_file {
    const char *path;
    size_t most; ///< heights that the file can hold
    int id, var;
    int dim[2]; ///< of the variable, slowest first
    size_t length[2];
    bool transposed; ///< slowest is x
    char name[NC_MAX_NAME + 1];
} grid_file;

static bool is_netcdf(const lac_bytes *bytes)
{
    return lac_netcdf_begins(bytes->data, bytes->size);
}

static lac_status check(const grid_file *file, int code, const char *what, lac_error *err)
{
    return lac_netcdf_check(file->path, code, what, err);
}

// `heights` or `z` if there is one, else the only variable of two dimensions.
static lac_status find_variable(grid_file *file, lac_error *err)
{
    static const char *const preferred[] = {"heights", "z"};
    int vars = 0, found = 0;
    int dims[2];
    for (size_t i = 0; i < 2; i++) {
        if (nc_inq_varid(file->id, preferred[i], &file->var) == NC_NOERR &&
            lac_netcdf_runs_over(file->id, file->var, 2, file->dim)) {
            return LAC_OK;
        }
    }
    lac_status status = check(file, nc_inq_nvars(file->id, &vars), "the variables", err);
    for (int v = 0; status == LAC_OK && v < vars; v++) {
        if (lac_netcdf_runs_over(file->id, v, 2, dims)) {
            memcpy(file->dim, dims, sizeof dims);
            file->var = v;
            found++;
        }
    }
    if (status == LAC_OK && found != 1) {
        status = lac_fail(
            err, LAC_EINPUT,
            "%s: has %d variables of two dimensions; must have one, or one named heights or z",
            file->path, found);
    }
    return status;
}

static lac_status find_dimensions(grid_file *file, lac_error *err)
{
    char name[2][NC_MAX_NAME + 1];
    LAC_TRY_RETURN(check(file, nc_inq_varname(file->id, file->var, file->name), "a name", err));
    for (size_t k = 0; k < 2; k++) {
        LAC_TRY_RETURN(check(file, nc_inq_dim(file->id, file->dim[k], name[k], &file->length[k]),
                             file->name, err));
    }
    static const char *const along_y[] = {"y", "lat", "latitude"};
    for (size_t i = 0; i < 3; i++) {
        file->transposed = file->transposed || strcasecmp(name[1], along_y[i]) == 0;
    }
    return LAC_OK;
}

// CF says units, SurfaceTopography unit or, in old files, length_unit.
static void take_unit(const grid_file *file, int var, char *unit, size_t size)
{
    static const char *const names[] = {"units", "unit", "length_unit"};
    for (size_t i = 0; i < sizeof names / sizeof names[0] && unit[0] == '\0'; i++) {
        (void)lac_netcdf_text(file->id, var, names[i], unit, size);
    }
}

// The coordinate of a dimension. `spacing` is negative where it falls; NaN where there is none.
static lac_status take_axis(const grid_file *file, size_t k, double *first, double *spacing,
                            char *unit, lac_error *err)
{
    lac_status status = LAC_OK;
    char name[NC_MAX_NAME + 1] = "";
    double *x = NULL;
    int var = -1;
    size_t n = file->length[k];
    *spacing = (double)NAN;
    if (n < 2 || !lac_netcdf_axis(file->id, file->dim[k], name, &var)) {
        goto out;
    }
    x = malloc(n * sizeof *x);
    LAC_TRY(x != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_netcdf_values(file->path, file->id, var, name, n, x, err));
    *spacing = (x[n - 1] - x[0]) / (double)(n - 1);
    *first = fmin(x[0], x[n - 1]);
    for (size_t i = 0; i < n; i++) {
        double off = x[i] - (x[0] + (double)i * *spacing);
        LAC_LEAVE_IF(!(fabs(off) <= 0.01 * fabs(*spacing)) || !isnormal(*spacing), err, LAC_EINPUT,
                     "%s: %s[%zu] = %g; must be at a regular spacing, here %g", file->path, name, i,
                     x[i], *spacing);
    }
    take_unit(file, var, unit, sizeof((lac_height_map *)NULL)->lateral_unit);
out:
    free(x);
    return status;
}

static lac_status transpose(lac_height_map *map, lac_error *err)
{
    size_t n = map->nx * map->ny;
    double *turned = malloc(n * sizeof *turned);
    LAC_FAIL_MEMORY_IF(turned == NULL, err);
    for (size_t i = 0; i < n; i++) {
        turned[i] = map->heights[i % map->nx * map->ny + i / map->nx];
    }
    free(map->heights);
    map->heights = turned;
    return LAC_OK;
}

static void turn_row(double *row, size_t n)
{
    for (size_t a = 0, b = n - 1; a < b; a++, b--) {
        double swapped = row[a];
        row[a] = row[b];
        row[b] = swapped;
    }
}

// Heights in the order of rising x and y.
static lac_status arrange(const grid_file *file, lac_height_map *map, lac_error *err)
{
    LAC_TRY_RETURN(file->transposed ? transpose(map, err) : LAC_OK);
    if (map->dy < 0.0) {
        lac_map_flip(map);
    }
    for (size_t j = 0; map->dx < 0.0 && j < map->ny; j++) {
        turn_row(map->heights + j * map->nx, map->nx);
    }
    map->dx = fabs(map->dx);
    map->dy = fabs(map->dy);
    return LAC_OK;
}

static lac_status read_map(grid_file *file, lac_height_map *map, lac_error *err)
{
    char other[sizeof map->lateral_unit] = "";
    LAC_TRY_RETURN(find_variable(file, err));
    LAC_TRY_RETURN(find_dimensions(file, err));
    size_t x = file->transposed ? 0 : 1;
    LAC_TRY_RETURN(
        lac_map_size(map, file->path, file->length[x], file->length[1 - x], file->most, err));
    LAC_TRY_RETURN(take_axis(file, x, &map->x, &map->dx, map->lateral_unit, err));
    LAC_TRY_RETURN(take_axis(file, 1 - x, &map->y, &map->dy, other, err));
    bool one = map->lateral_unit[0] == '\0' || other[0] == '\0';
    LAC_FAIL_IF(!one && strcmp(map->lateral_unit, other) != 0 && strncmp(other, "degree", 6) != 0,
                err, LAC_EINPUT, "%s: x is in %s but y in %s; must be in one unit", file->path,
                map->lateral_unit, other);
    if (map->lateral_unit[0] == '\0') {
        memcpy(map->lateral_unit, other, sizeof other);
    }
    take_unit(file, file->var, map->height_unit, sizeof map->height_unit);
    if (map->height_unit[0] == '\0' && strcmp(file->name, "heights") == 0) {
        // old files of SurfaceTopography: one unit for all lengths, said with the coordinates
        memcpy(map->height_unit, map->lateral_unit, sizeof map->height_unit);
    }
    LAC_TRY_RETURN(lac_netcdf_values(file->path, file->id, file->var, file->name, map->nx * map->ny,
                                     map->heights, err));
    return arrange(file, map, err);
}

static lac_status read_netcdf(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    // compressed or never written data of netCDF-4 may be larger than the file: only the limit
    // of all files bounds them
    bool classic = lac_bytes_begin(bytes, "CDF");
    grid_file file = {.path = bytes->path, .most = classic ? bytes->size : SIZE_MAX};
    LAC_TRY_RETURN(lac_netcdf_check_header(bytes->path, bytes->data, bytes->size, err));
    LAC_TRY_RETURN(lac_need_netcdf(err));
    // netCDF does not write to memory opened for reading; its own name tells it nothing
    int code = nc_open_mem("heights", NC_NOWRITE, bytes->size, (void *)bytes->data, &file.id);
    if (code != NC_NOERR) {
        return check(&file, code, "the file", err);
    }
    lac_status status = read_map(&file, map, err);
    (void)nc_close(file.id);
    return status;
}

const lac_map_format lac_map_netcdf = {"netCDF", is_netcdf, read_netcdf};
