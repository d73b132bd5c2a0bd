// SPDX-License-Identifier: GPL-3.0-or-later
// Fields over the cells of an interface, made elsewhere.
#include "store/store_cells.h"

#include <strings.h>

#include "base/netcdf.h"
#include "base/units.h"
#include "store/input.h"

// A variable of the file, and how it lies over the cells.
typedef struct field {
    int var, rank;
    int dim[2];
    size_t length[2];
    bool by_cell;    // over the contact cells, else over the grid
    bool transposed; // over the grid, x slowest
    char name[NC_MAX_NAME + 1];
} field;

typedef struct map_file {
    const lac_map_def *def;
    const lac_domain *domain;
    lac_stored_file *in;
} map_file;

// Whether the dimension of `k` is named so.
static bool named(const map_file *file, const field *at, int k, const char *name)
{
    char dim[NC_MAX_NAME + 1] = "";
    return nc_inq_dimname(file->in->id, at->dim[k], dim) == NC_NOERR && strcasecmp(dim, name) == 0;
}

// Whether a variable is numbers over the cells.
static bool fits(const map_file *file, field *at)
{
    const lac_grid *grid = &file->domain->grid;
    at->rank = lac_netcdf_runs_over(file->in->id, at->var, 1, at->dim) ? 1 : 2;
    if ((at->rank == 2 && !lac_netcdf_runs_over(file->in->id, at->var, 2, at->dim)) ||
        nc_inq_varname(file->in->id, at->var, at->name) != NC_NOERR) {
        return false;
    }
    for (int k = 0; k < at->rank; k++) {
        if (nc_inq_dimlen(file->in->id, at->dim[k], &at->length[k]) != NC_NOERR) {
            return false;
        }
    }
    if (at->rank == 1) {
        bool line = grid->nx == 1 || grid->ny == 1;
        at->by_cell = at->length[0] == file->domain->n;
        return at->by_cell || (line && at->length[0] == lac_grid_cells(grid));
    }
    at->transposed = named(file, at, 0, "x") && named(file, at, 1, "y");
    size_t rows = at->length[at->transposed ? 1 : 0];
    size_t columns = at->length[at->transposed ? 0 : 1];
    return rows == grid->ny && columns == grid->nx;
}

static lac_status misfit(const map_file *file, const field *at, lac_error *err)
{
    const lac_grid *grid = &file->domain->grid;
    return lac_fail(
        err, LAC_EINPUT,
        "%s: %s must be numbers over (y, x) = (%zu, %zu), the grid, or over %zu, the contact cells",
        file->def->path, at->name, grid->ny, grid->nx, file->domain->n);
}

static lac_status find_field(const map_file *file, field *at, lac_error *err)
{
    const char *name = file->def->variable;
    int vars = 0;
    size_t found = 0;
    *at = (field){0};
    if (name != NULL) {
        LAC_TRY_RETURN(lac_netcdf_find(file->def->path, file->in->id, name, &at->var, err));
        (void)nc_inq_varname(file->in->id, at->var, at->name);
        return fits(file, at) ? LAC_OK : misfit(file, at, err);
    }
    lac_status status = lac_nc_check(file->def->path, nc_inq_nvars(file->in->id, &vars), err,
                                     "read", "the variables");
    for (int v = 0; status == LAC_OK && v < vars; v++) {
        field candidate = {.var = v};
        // One that is named like its dimension holds coordinates.
        if (fits(file, &candidate) &&
            !(candidate.rank == 1 && named(file, &candidate, 0, candidate.name))) {
            *at = candidate;
            found++;
        }
    }
    if (status == LAC_OK && found != 1) {
        memcpy(at->name, "the field", sizeof "the field");
        return found == 0
                   ? misfit(file, at, err)
                   : lac_fail(err, LAC_EINPUT,
                              "%s: has %zu variables over the cells; variable must say which",
                              file->def->path, found);
    }
    return status;
}

// The grid counts cells from low x and y.
static lac_status check_axes(const map_file *file, const field *at, lac_error *err)
{
    for (int k = 0; k < at->rank && !at->by_cell; k++) {
        char name[NC_MAX_NAME + 1] = "";
        int var = -1;
        double first, last;
        size_t end = at->length[k] - 1;
        if (!lac_netcdf_axis(file->in->id, at->dim[k], name, &var) ||
            nc_get_var1_double(file->in->id, var, &(size_t){0}, &first) != NC_NOERR ||
            nc_get_var1_double(file->in->id, var, &end, &last) != NC_NOERR) {
            continue; // no coordinates
        }
        LAC_FAIL_IF(end > 0 && !(last > first), err, LAC_EINPUT,
                    "%s: %s goes from %g to %g; must rise", file->def->path, name, first, last);
    }
    return LAC_OK;
}

static lac_status find_unit(const map_file *file, const field *at, double *scale, double *offset,
                            lac_error *err)
{
    char unit[100];
    lac_units *units = NULL;
    lac_error why = {""};
    (void)lac_netcdf_text(file->in->id, at->var, "units", unit, sizeof unit);
    *scale = 1.0;
    *offset = 0.0;
    if (unit[0] == '\0') {
        return strcmp(file->def->unit, "1") == 0
                   ? LAC_OK
                   : lac_fail(err, LAC_EINPUT, "%s: %s has no units; must have some like %s",
                              file->def->path, at->name, file->def->unit);
    }
    lac_status status = lac_units_create(&units, err);
    if (status == LAC_OK &&
        lac_units_convert(units, unit, file->def->unit, scale, offset, &why) != LAC_OK) {
        status = lac_fail(err, LAC_EINPUT, "%s: the unit \"%s\" of %s %s", file->def->path, unit,
                          at->name, why.message);
    }
    lac_units_free(units);
    return status;
}

static size_t place_of(const map_file *file, const field *at, size_t cell)
{
    const lac_grid *grid = &file->domain->grid;
    size_t index = file->domain->index[cell];
    size_t turned = index % grid->nx * grid->ny + index / grid->nx;
    return at->by_cell ? cell : at->transposed ? turned : index;
}

static lac_status pick(const map_file *file, const field *at, const double *given, double *values,
                       lac_error *err)
{
    double scale, offset;
    lac_status status = find_unit(file, at, &scale, &offset, err);
    for (size_t i = 0; status == LAC_OK && i < file->domain->n; i++) {
        double value = given[place_of(file, at, i)];
        if (!isfinite(value)) {
            size_t index = file->domain->index[i], nx = file->domain->grid.nx;
            return lac_fail(err, LAC_EINPUT,
                            "%s: %s has no value at ix = %zu, iy = %zu, where the faces touch",
                            file->def->path, at->name, index % nx, index / nx);
        }
        values[i] = scale * value + offset;
    }
    return status;
}

lac_status lac_map_read(const lac_map_def *def, const lac_domain *domain, double *values,
                        lac_error *err)
{
    map_file file = {.def = def, .domain = domain};
    field at;
    double *stored = NULL;
    size_t length;
    lac_status status;
    LAC_TRY(lac_stored_file_open_any(def->path, &file.in, err));
    LAC_TRY(find_field(&file, &at, err));
    LAC_TRY(check_axes(&file, &at, err));
    // no more than the cells of the grid, whatever the file says
    length = at.length[0] * (at.rank == 2 ? at.length[1] : 1);
    stored = malloc(length * sizeof *stored);
    LAC_TRY(stored != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_nc_check(def->path, nc_get_var_double(file.in->id, at.var, stored), err, "read",
                         at.name));
    lac_netcdf_unpack(file.in->id, at.var, stored, length);
    LAC_TRY(pick(&file, &at, stored, values, err));
out:
    free(stored);
    lac_stored_file_close(file.in);
    return status;
}
