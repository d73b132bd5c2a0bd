// SPDX-License-Identifier: GPL-3.0-or-later
// The contact cells of a file of a run or a contact, with the tractions of one snapshot.
#include "store/store_cells.h"

#include "base/netcdf.h"
#include "store/input.h"

enum { RANK = 3 };

void lac_stored_cells_clear(lac_stored_cells *cells)
{
    lac_domain_free(cells->domain);
    free(cells->shear);
    free(cells->case_text);
    *cells = (lac_stored_cells){0};
}

static lac_status fail_damaged(const lac_stored_file *in, const char *name, lac_error *err)
{
    return lac_fail(err, LAC_EIO, "%s: is damaged: its %s makes no sense", in->path, name);
}

// Length of a dimension; 0 where there is none, or more than the file can hold.
static size_t length_of(const lac_stored_file *in, const char *name)
{
    int id = 0;
    size_t length = 0;
    bool there = nc_inq_dimid(in->id, name, &id) == NC_NOERR &&
                 nc_inq_dimlen(in->id, id, &length) == NC_NOERR;
    return there && lac_input_may_hold(in, length) ? length : 0;
}

static bool has_variable(const lac_stored_file *in, const char *name)
{
    int id = 0;
    return nc_inq_varid(in->id, name, &id) == NC_NOERR;
}

// The reals of a variable, or of one place along its first dimension; NaN where nothing was
// written. @param count  that there must be  @param out  the caller frees
static lac_status read_reals(const lac_stored_file *in, const char *name, ptrdiff_t row,
                             size_t count, double **out, lac_error *err)
{
    lac_stored_values values = {0};
    int id = 0;
    nc_type type = NC_NAT;
    const int code = nc_inq_varid(in->id, name, &id);
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    (void)nc_inq_vartype(in->id, id, &type);
    lac_status status = lac_stored_file_row(in, name, row, &values, err);
    if (status == LAC_OK &&
        (values.n * values.width != count || (type != NC_DOUBLE && type != NC_FLOAT))) {
        status = fail_damaged(in, name, err);
    }
    if (status != LAC_OK) {
        lac_stored_values_clear(&values);
    }
    free(*out);
    *out = values.value;
    return status;
}

// Refuses pressures that do not say the unit that files of ours have them in.
static lac_status check_unit(const lac_stored_file *in, const char *name, lac_error *err)
{
    char found[32];
    int id = 0;
    if (nc_inq_varid(in->id, name, &id) != NC_NOERR) {
        return LAC_OK; // said where it is read
    }
    (void)lac_netcdf_text(in->id, id, "units", found, sizeof found);
    LAC_FAIL_IF(strcmp(found, "Pa") != 0, err, LAC_EINPUT, "%s: its %s is in \"%s\": must be in Pa",
                in->path, name, found);
    return LAC_OK;
}

// --- The file of a run: cells listed in hierarchy order on a grid that the attributes give.

static lac_status read_grid(const lac_stored_file *in, lac_grid *grid, lac_error *err)
{
    const double nx = lac_netcdf_number(in->id, NC_GLOBAL, "grid_nx", NAN);
    const double ny = lac_netcdf_number(in->id, NC_GLOBAL, "grid_ny", NAN);
    *grid = (lac_grid){.dx = lac_netcdf_number(in->id, NC_GLOBAL, "grid_dx_m", NAN),
                       .dy = lac_netcdf_number(in->id, NC_GLOBAL, "grid_dy_m", NAN),
                       .periodic = lac_input_says(in, "boundary", "periodic")};
    if (!(nx >= 1.0 && ny >= 1.0 && nx * ny < UINT32_MAX && grid->dx > 0.0 && grid->dy > 0.0 &&
          isfinite(grid->dx) && isfinite(grid->dy))) {
        return fail_damaged(in, "grid", err);
    }
    grid->nx = (size_t)nx;
    grid->ny = (size_t)ny;
    return LAC_OK;
}

// From the places of the cells; each Morton code above the one before: in order, and none twice.
static bool place_cells(lac_domain *domain, const double *x, const double *y)
{
    const lac_grid *grid = &domain->grid;
    uint64_t before = 0;
    for (size_t i = 0; i < domain->n; i++) {
        double column = floor(x[i] / grid->dx), row = floor(y[i] / grid->dy);
        if (!(column >= 0.0 && column < (double)grid->nx && row >= 0.0 && row < (double)grid->ny)) {
            return false;
        }
        uint64_t code = lac_morton((uint32_t)column, (uint32_t)row);
        if (i > 0 && code <= before) {
            return false;
        }
        before = code;
        domain->index[i] = (uint32_t)row * (uint32_t)grid->nx + (uint32_t)column;
    }
    return true;
}

static lac_status read_domain(const lac_stored_file *in, lac_domain **out, lac_error *err)
{
    double *x = NULL, *y = NULL;
    lac_status status;
    const size_t n = length_of(in, "cell");
    lac_domain *domain = calloc(1, sizeof *domain);
    *out = domain;
    LAC_FAIL_MEMORY_IF(domain == NULL, err);
    LAC_TRY(read_grid(in, &domain->grid, err));
    LAC_TRY(n == 0 || n > lac_grid_cells(&domain->grid) ? fail_damaged(in, "number of cells", err)
                                                        : LAC_OK);
    domain->n = n;
    domain->index = malloc(n * sizeof *domain->index);
    LAC_TRY(domain->index != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(read_reals(in, "x", LAC_INPUT_ALL, n, &x, err));
    LAC_TRY(read_reals(in, "y", LAC_INPUT_ALL, n, &y, err));
    LAC_TRY(check_unit(in, "pressure", err));
    LAC_TRY(read_reals(in, "pressure", LAC_INPUT_ALL, n, &domain->pressure, err));
    LAC_TRY(place_cells(domain, x, y) ? LAC_OK : fail_damaged(in, "list of cells", err));
    for (size_t i = 0; i < n; i++) {
        const bool pressed = domain->pressure[i] > 0.0 && isfinite(domain->pressure[i]);
        LAC_TRY(pressed ? LAC_OK : fail_damaged(in, "pressure", err));
    }
out:
    free(x);
    free(y);
    return status;
}

// The tractions of one snapshot; `whole` false where something is missing.
static lac_status read_tractions(const lac_stored_file *in, size_t index, lac_stored_cells *out,
                                 bool *whole, lac_error *err)
{
    const ptrdiff_t row = (ptrdiff_t)index;
    double *time = NULL;
    lac_status status;
    LAC_TRY(read_reals(in, "cell_traction", row, out->domain->n, &out->shear, err));
    LAC_TRY(read_reals(in, "snapshot_time", row, 1, &time, err));
    out->time = *time;
    *whole = isfinite(out->time);
    for (size_t i = 0; i < out->domain->n; i++) {
        *whole = *whole && isfinite(out->shear[i]);
    }
    out->index = index;
out:
    free(time);
    return status;
}

static lac_status fail_choice(const lac_stored_file *in, size_t snapshots, lac_error *err)
{
    return snapshots == 0 ? lac_fail(err, LAC_EINPUT, "%s: holds no snapshot yet", in->path)
                          : lac_fail(err, LAC_EINPUT, "%s: has no such snapshot: they are 0 to %zu",
                                     in->path, snapshots - 1);
}

// The last of the whole snapshots that is not later than a time.
static lac_status find_time(const lac_stored_file *in, size_t snapshots, double time, size_t *index,
                            lac_error *err)
{
    double *times = NULL;
    size_t found = 0;
    lac_status status;
    LAC_TRY(read_reals(in, "snapshot_time", LAC_INPUT_ALL, length_of(in, "snapshot"), &times, err));
    while (found < snapshots && times[found] <= time) {
        found++;
    }
    if (found == 0) {
        status = lac_fail(err, LAC_EINPUT, "%s: its first snapshot, at %g s, is later than %g s",
                          in->path, times[0], time);
    }
    *index = found - 1;
out:
    free(times);
    return status;
}

static lac_status read_run(const lac_stored_file *in, const lac_snapshot_choice *choice,
                           lac_stored_cells *out, lac_error *err)
{
    bool whole = false;
    size_t index = 0;
    out->kind = LAC_STORED_RUN;
    LAC_FAIL_IF(!has_variable(in, "cell_traction"), err, LAC_EINPUT,
                "%s: holds no tractions of cells: run the case with output.fields: [traction]",
                in->path);
    LAC_TRY_RETURN(read_domain(in, &out->domain, err));
    out->snapshots = length_of(in, "snapshot");
    // The last ones of a run that was killed may be torn.
    while (out->snapshots > 0 && !whole) {
        LAC_TRY_RETURN(read_tractions(in, out->snapshots - 1, out, &whole, err));
        LAC_TRY_RETURN(whole || lac_input_says(in, "status", "running")
                           ? LAC_OK
                           : fail_damaged(in, "last snapshot", err));
        out->snapshots -= whole ? 0 : 1;
    }
    index = choice->by == LAC_SNAPSHOT_INDEX ? choice->index : out->snapshots - 1;
    LAC_TRY_RETURN(out->snapshots == 0 || index >= out->snapshots
                       ? fail_choice(in, out->snapshots, err)
                       : LAC_OK);
    if (choice->by == LAC_SNAPSHOT_TIME) {
        LAC_TRY_RETURN(find_time(in, out->snapshots, choice->time, &index, err));
    }
    if (index + 1 < out->snapshots) {
        LAC_TRY_RETURN(read_tractions(in, index, out, &whole, err));
    }
    return whole ? LAC_OK : fail_damaged(in, "snapshot", err);
}

// --- The file of a contact: maps over the interface.

// A map, or that of a step where it has steps.
static lac_status read_map(const lac_stored_file *in, const char *name, size_t step,
                           const lac_grid *grid, double **map, lac_error *err)
{
    int id = 0, rank = 0;
    const bool steps = nc_inq_varid(in->id, name, &id) == NC_NOERR &&
                       nc_inq_varndims(in->id, id, &rank) == NC_NOERR && rank == RANK;
    lac_status status = read_reals(in, name, steps ? (ptrdiff_t)step : LAC_INPUT_ALL,
                                   grid->nx * grid->ny, map, err);
    for (size_t i = 0; status == LAC_OK && i < grid->nx * grid->ny; i++) {
        if (!isfinite((*map)[i])) {
            status = lac_fail(err, LAC_EINPUT,
                              "%s: not all of the map %s is there: its writer was stopped before "
                              "it came to it, or the file is damaged",
                              in->path, name);
        }
    }
    return status;
}

static lac_status read_axis(const lac_stored_file *in, const char *name, size_t *n, double *side,
                            lac_error *err)
{
    double *first = NULL;
    const lac_status status = read_reals(in, name, 0, 1, &first, err);
    if (status == LAC_OK) {
        *n = length_of(in, name);
        *side = 2.0 * *first; // the centre of the first cell
    }
    free(first);
    return status;
}

// Which step; the maps of a history that kept only its last one have no steps.
static lac_status choose_step(const lac_stored_file *in, const lac_snapshot_choice *choice,
                              lac_stored_cells *out, lac_error *err)
{
    int id = 0, rank = 0;
    out->kind = LAC_STORED_HISTORY;
    LAC_FAIL_IF(nc_inq_varid(in->id, "traction_x", &id) != NC_NOERR ||
                    nc_inq_varndims(in->id, id, &rank) != NC_NOERR,
                err, LAC_EINPUT,
                "%s: holds no tractions of cells: solve the case with load.history.fields: all",
                in->path);
    LAC_FAIL_IF(choice->by == LAC_SNAPSHOT_TIME, err, LAC_EINPUT,
                "%s: its steps have no times: give a number", in->path);
    out->snapshots = rank == RANK ? length_of(in, "step") : 1;
    out->index = choice->by == LAC_SNAPSHOT_INDEX ? choice->index : out->snapshots - 1;
    return out->index < out->snapshots ? LAC_OK : fail_choice(in, out->snapshots, err);
}

// The cascade knows the shear along x alone; a y force of 1e-3 of the normal force is none.
static lac_status check_along_x(const lac_stored_file *in, double **map,
                                const lac_stored_cells *out, lac_error *err)
{
    const lac_domain *domain = out->domain;
    double across = 0.0, normal = 0.0;
    lac_status status;
    LAC_TRY(read_map(in, "traction_y", out->index, &domain->grid, map, err));
    for (size_t i = 0; i < domain->n; i++) {
        across += (*map)[domain->index[i]];
        normal += domain->pressure[i];
    }
    if (fabs(across) > 1e-3 * normal) {
        status = lac_fail(err, LAC_EINPUT,
                          "%s: step %zu carries %.3g of its normal force along y: the cascade "
                          "knows shear along x only",
                          in->path, out->index, across / normal);
    }
out:
    return status;
}

static lac_status read_shear(const lac_stored_file *in, lac_stored_cells *out, lac_error *err)
{
    const lac_domain *domain = out->domain;
    double *map = NULL;
    lac_status status = LAC_OK;
    out->shear = calloc(domain->n, sizeof *out->shear);
    LAC_TRY(out->shear != NULL ? LAC_OK : lac_fail_memory(err));
    if (out->kind == LAC_STORED_HISTORY) {
        LAC_TRY(check_along_x(in, &map, out, err));
        LAC_TRY(read_map(in, "traction_x", out->index, &domain->grid, &map, err));
    }
    for (size_t i = 0; map != NULL && i < domain->n; i++) {
        out->shear[i] = map[domain->index[i]];
    }
out:
    free(map);
    return status;
}

// The cells that are pressed in the map of a contact, or of a step where steps kept theirs.
static lac_status read_pressed(const lac_stored_file *in, size_t step, lac_domain **domain,
                               lac_error *err)
{
    lac_grid grid = {.periodic = lac_input_says(in, "boundary", "periodic")};
    double *map = NULL;
    const char *name = has_variable(in, "step_pressure") ? "step_pressure" : "pressure";
    lac_status status;
    LAC_TRY(read_axis(in, "x", &grid.nx, &grid.dx, err));
    LAC_TRY(read_axis(in, "y", &grid.ny, &grid.dy, err));
    LAC_TRY(grid.nx == 0 || grid.ny == 0 || !lac_input_may_hold(in, grid.nx * grid.ny)
                ? fail_damaged(in, "grid", err)
                : LAC_OK);
    LAC_TRY(check_unit(in, name, err));
    LAC_TRY(read_map(in, name, step, &grid, &map, err));
    status = lac_domain_create(&grid, map, domain, err);
    if (status != LAC_OK) {
        status = lac_fail_within(err, status, "%s", in->path);
    }
out:
    free(map);
    return status;
}

static lac_status read_contact(const lac_stored_file *in, const lac_snapshot_choice *choice,
                               lac_stored_cells *out, lac_error *err)
{
    out->kind = LAC_STORED_CONTACT;
    out->snapshots = 1;
    out->time = NAN;
    if (has_variable(in, "step")) {
        LAC_TRY_RETURN(choose_step(in, choice, out, err));
    } else {
        LAC_FAIL_IF(choice->by != LAC_SNAPSHOT_LAST, err, LAC_EINPUT,
                    "%s: is a contact, which has no snapshots", in->path);
    }
    LAC_TRY_RETURN(read_pressed(in, out->index, &out->domain, err));
    LAC_TRY_RETURN(read_shear(in, out, err));
    return LAC_OK;
}

// Whether it is a run, else a contact.
static lac_status tell_run(const lac_stored_file *in, bool *run, lac_error *err)
{
    int grid = 0;
    *run = nc_inq_attid(in->id, NC_GLOBAL, "grid_nx", &grid) == NC_NOERR;
    LAC_FAIL_IF(!*run && (length_of(in, "x") == 0 || length_of(in, "y") == 0), err, LAC_EIO,
                "%s: is neither a run nor a contact", in->path);
    return LAC_OK;
}

lac_status lac_stored_domain_read(const char *path, lac_domain **domain, lac_error *err)
{
    lac_stored_file *in = NULL;
    lac_status status;
    size_t steps;
    bool run;
    *domain = NULL;
    LAC_TRY(lac_stored_file_open(path, &in, err));
    LAC_TRY(tell_run(in, &run, err));
    steps = has_variable(in, "step_pressure") ? length_of(in, "step") : 0;
    LAC_TRY(run ? read_domain(in, domain, err)
                : read_pressed(in, steps > 0 ? steps - 1 : 0, domain, err));
out:
    lac_stored_file_close(in);
    LAC_MADE(status, domain, lac_domain_free);
}

lac_status lac_stored_cells_read(const char *path, const lac_snapshot_choice *choice,
                                 lac_stored_cells *out, lac_error *err)
{
    lac_stored_file *in = NULL;
    lac_status status;
    bool run;
    *out = (lac_stored_cells){0};
    LAC_TRY(lac_stored_file_open(path, &in, err));
    (void)lac_netcdf_text(in->id, NC_GLOBAL, "status", out->status, sizeof out->status);
    out->case_text = lac_nc_text_of(in->id, "case", in->size);
    LAC_TRY(out->case_text != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_LEAVE_IF(*out->case_text == '\0', err, LAC_EIO, "%s: holds no case", in->path);
    LAC_TRY(tell_run(in, &run, err));
    LAC_TRY(run ? read_run(in, choice, out, err) : read_contact(in, choice, out, err));
out:
    lac_stored_file_close(in);
    return status;
}
