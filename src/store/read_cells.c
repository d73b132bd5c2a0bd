// SPDX-License-Identifier: GPL-3.0-or-later
// The contact cells of a file of a run or a contact, with the tractions of one snapshot.
#include "store/store_cells.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store/input.h"

enum { RANK = 3 };

void lac_stored_cells_clear(lac_stored_cells *cells)
{
    lac_domain_free(cells->domain);
    free(cells->shear);
    free(cells->case_text);
    *cells = (lac_stored_cells){0};
}

static lac_status fail_damaged(const lac_input *in, const char *name, lac_error *err)
{
    return lac_fail(err, LAC_EIO, "%s: is damaged: its %s makes no sense", in->path, name);
}

// Length of a dimension; 0 where there is none, or more than the file can hold.
static size_t length_of(const lac_input *in, const char *name)
{
    int id = 0;
    size_t length = 0;
    bool there = nc_inq_dimid(in->id, name, &id) == NC_NOERR &&
                 nc_inq_dimlen(in->id, id, &length) == NC_NOERR;
    return there && lac_input_may_hold(in, length) ? length : 0;
}

static bool has_variable(const lac_input *in, const char *name)
{
    int id = 0;
    return nc_inq_varid(in->id, name, &id) == NC_NOERR;
}

// `count` reals of a variable from `start` on; NaN where nothing was written.
static lac_status read_part(const lac_input *in, const char *name, int rank, const size_t *start,
                            const size_t *count, double *values, lac_error *err)
{
    int id = 0;
    int found = 0;
    nc_type type = NC_NAT;
    int code = nc_inq_varid(in->id, name, &id);
    code = code == NC_NOERR ? nc_inq_varndims(in->id, id, &found) : code;
    code = code == NC_NOERR ? nc_inq_vartype(in->id, id, &type) : code;
    if (code == NC_NOERR && (found != rank || (type != NC_DOUBLE && type != NC_FLOAT))) {
        return fail_damaged(in, name, err);
    }
    code = code == NC_NOERR ? nc_get_vara_double(in->id, id, start, count, values) : code;
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    double fill = lac_input_fill(in, id, type);
    size_t n = 1;
    for (int i = 0; i < rank; i++) {
        n *= count[i];
    }
    for (size_t i = 0; i < n; i++) {
        values[i] = values[i] == fill ? NAN : values[i];
    }
    return LAC_OK;
}

static lac_status read_all(const lac_input *in, const char *name, size_t n, double *values,
                           lac_error *err)
{
    const size_t start = 0;
    return read_part(in, name, 1, &start, &n, values, err);
}

static lac_status new_doubles(size_t n, double **out, lac_error *err)
{
    *out = calloc(n + 1, sizeof **out);
    return *out != NULL ? LAC_OK : lac_fail_memory(err);
}

static bool text_is(const lac_input *in, const char *name, const char *expected)
{
    char text[16] = "";
    size_t length = 0;
    return nc_inq_attlen(in->id, NC_GLOBAL, name, &length) == NC_NOERR && length < sizeof text &&
           nc_get_att_text(in->id, NC_GLOBAL, name, text) == NC_NOERR &&
           strcmp(text, expected) == 0;
}

static lac_status read_provenance(const lac_input *in, lac_stored_cells *out, lac_error *err)
{
    static const char *const known[] = {"running", "complete", "failed", "interrupted"};
    size_t length = 0;
    nc_type type = NC_NAT;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (lac_input_has_status(in, known[i])) {
            (void)snprintf(out->status, sizeof out->status, "%s", known[i]);
        }
    }
    if (nc_inq_att(in->id, NC_GLOBAL, "case", &type, &length) != NC_NOERR || type != NC_CHAR ||
        length > in->size) {
        return lac_fail(err, LAC_EIO, "%s: holds no case", in->path);
    }
    out->case_text = calloc(length + 1, 1);
    if (out->case_text == NULL) {
        return lac_fail_memory(err);
    }
    int code = nc_get_att_text(in->id, NC_GLOBAL, "case", out->case_text);
    return code == NC_NOERR ? LAC_OK : lac_input_fail(in, code, err, "case");
}

// --- The file of a run: cells listed in hierarchy order on a grid that the attributes give.

static lac_status read_grid(const lac_input *in, lac_grid *grid, lac_error *err)
{
    double nx = 0.0;
    double ny = 0.0;
    bool there = lac_input_number(in, NC_GLOBAL, "grid_nx", &nx) &&
                 lac_input_number(in, NC_GLOBAL, "grid_ny", &ny) &&
                 lac_input_number(in, NC_GLOBAL, "grid_dx_m", &grid->dx) &&
                 lac_input_number(in, NC_GLOBAL, "grid_dy_m", &grid->dy);
    bool sound = nx >= 1.0 && ny >= 1.0 && nx * ny < UINT32_MAX && grid->dx > 0.0 &&
                 grid->dy > 0.0 && isfinite(grid->dx) && isfinite(grid->dy);
    if (!there || !sound) {
        return fail_damaged(in, "grid", err);
    }
    grid->nx = (size_t)nx;
    grid->ny = (size_t)ny;
    grid->periodic = text_is(in, "boundary", "periodic");
    return LAC_OK;
}

// From the places of the cells; each Morton code above the one before: in order, and none twice.
static bool place_cells(lac_domain *domain, const double *x, const double *y)
{
    const lac_grid *grid = &domain->grid;
    uint64_t before = 0;
    for (size_t i = 0; i < domain->n; i++) {
        double column = floor(x[i] / grid->dx);
        double row = floor(y[i] / grid->dy);
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

static bool all_pressed(const lac_domain *domain)
{
    for (size_t i = 0; i < domain->n; i++) {
        if (!(domain->pressure[i] > 0.0 && isfinite(domain->pressure[i]))) {
            return false;
        }
    }
    return true;
}

static lac_status read_domain(const lac_input *in, lac_domain **out, lac_error *err)
{
    double *place = NULL;
    lac_status status = LAC_OK;
    const size_t n = length_of(in, "cell");
    lac_domain *domain = calloc(1, sizeof *domain);
    *out = domain;
    if (domain == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(read_grid(in, &domain->grid, err));
    if (n == 0 || n > lac_grid_cells(&domain->grid)) {
        LAC_TRY(fail_damaged(in, "number of cells", err));
    }
    domain->n = n;
    domain->index = malloc(n * sizeof *domain->index);
    LAC_TRY(new_doubles(n, &domain->pressure, err));
    LAC_TRY(new_doubles(2 * n, &place, err));
    status = domain->index != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    LAC_TRY(read_all(in, "x", n, place, err));
    LAC_TRY(read_all(in, "y", n, place + n, err));
    LAC_TRY(lac_input_must_be(in, "pressure", "Pa", err));
    LAC_TRY(read_all(in, "pressure", n, domain->pressure, err));
    if (!place_cells(domain, place, place + n)) {
        LAC_TRY(fail_damaged(in, "list of cells", err));
    }
    if (!all_pressed(domain)) {
        LAC_TRY(fail_damaged(in, "pressure", err));
    }
out:
    free(place);
    return status;
}

// The tractions of one snapshot; `whole` false where something is missing.
static lac_status read_tractions(const lac_input *in, size_t index, lac_stored_cells *out,
                                 bool *whole, lac_error *err)
{
    const size_t start[2] = {index, 0};
    const size_t count[2] = {1, out->domain->n};
    const size_t one = 1;
    lac_status status;
    LAC_TRY(read_part(in, "cell_traction", 2, start, count, out->shear, err));
    LAC_TRY(read_part(in, "snapshot_time", 1, &index, &one, &out->time, err));
    *whole = isfinite(out->time);
    for (size_t i = 0; i < out->domain->n; i++) {
        *whole = *whole && isfinite(out->shear[i]);
    }
    out->index = index;
out:
    return status;
}

static lac_status fail_choice(const lac_input *in, size_t snapshots, lac_error *err)
{
    return snapshots == 0 ? lac_fail(err, LAC_EINPUT, "%s: holds no snapshot yet", in->path)
                          : lac_fail(err, LAC_EINPUT, "%s: has no such snapshot: they are 0 to %zu",
                                     in->path, snapshots - 1);
}

// The last snapshot that is not later than a time.
static lac_status find_time(const lac_input *in, size_t snapshots, double time, size_t *index,
                            lac_error *err)
{
    double *times = NULL;
    size_t found = 0;
    lac_status status;
    LAC_TRY(new_doubles(snapshots, &times, err));
    LAC_TRY(read_all(in, "snapshot_time", snapshots, times, err));
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

static lac_status read_run(const lac_input *in, const lac_snapshot_choice *choice,
                           lac_stored_cells *out, lac_error *err)
{
    bool whole = false;
    lac_status status = LAC_OK;
    size_t index = 0;
    out->kind = LAC_STORED_RUN;
    if (!has_variable(in, "cell_traction")) {
        return lac_fail(err, LAC_EINPUT,
                        "%s: holds no tractions of cells: run the case with output.fields: "
                        "[traction]",
                        in->path);
    }
    LAC_TRY(read_domain(in, &out->domain, err));
    LAC_TRY(new_doubles(out->domain->n, &out->shear, err));
    out->snapshots = length_of(in, "snapshot");
    // The last ones of a run that was killed may be torn.
    while (out->snapshots > 0 && !whole) {
        LAC_TRY(read_tractions(in, out->snapshots - 1, out, &whole, err));
        if (!whole && !lac_input_has_status(in, "running")) {
            LAC_TRY(fail_damaged(in, "last snapshot", err));
        }
        out->snapshots -= whole ? 0 : 1;
    }
    index = choice->by == LAC_SNAPSHOT_INDEX ? choice->index : out->snapshots - 1;
    if (out->snapshots == 0 || index >= out->snapshots) {
        LAC_TRY(fail_choice(in, out->snapshots, err));
    }
    if (choice->by == LAC_SNAPSHOT_TIME) {
        LAC_TRY(find_time(in, out->snapshots, choice->time, &index, err));
    }
    if (index + 1 < out->snapshots) {
        LAC_TRY(read_tractions(in, index, out, &whole, err));
    }
    if (!whole) {
        LAC_TRY(fail_damaged(in, "snapshot", err));
    }
out:
    return status;
}

// --- The file of a contact: maps over the interface.

// A map, or that of a step where it has steps.
static lac_status read_map(const lac_input *in, const char *name, size_t step, const lac_grid *grid,
                           double *map, lac_error *err)
{
    const size_t start[RANK] = {step, 0, 0};
    const size_t count[RANK] = {1, grid->ny, grid->nx};
    int id = 0;
    int rank = 0;
    int code = nc_inq_varid(in->id, name, &id);
    code = code == NC_NOERR ? nc_inq_varndims(in->id, id, &rank) : code;
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    const int skip = rank == RANK ? 0 : 1;
    lac_status status = read_part(in, name, RANK - skip, start + skip, count + skip, map, err);
    for (size_t i = 0; status == LAC_OK && i < grid->nx * grid->ny; i++) {
        if (!isfinite(map[i])) {
            status =
                lac_fail(err, LAC_EINPUT,
                         "%s: not all of the map %s is there: its writer was stopped before it "
                         "came to it, or the file is damaged",
                         in->path, name);
        }
    }
    return status;
}

static lac_status read_axes(const lac_input *in, lac_grid *grid, lac_error *err)
{
    const size_t first = 0;
    const size_t one = 1;
    lac_status status;
    *grid = (lac_grid){.nx = length_of(in, "x"), .ny = length_of(in, "y")};
    grid->periodic = text_is(in, "boundary", "periodic");
    LAC_TRY(read_part(in, "x", 1, &first, &one, &grid->dx, err));
    LAC_TRY(read_part(in, "y", 1, &first, &one, &grid->dy, err));
    grid->dx *= 2.0; // the first is the centre of the first cell
    grid->dy *= 2.0;
    if (grid->nx == 0 || grid->ny == 0 || !lac_input_may_hold(in, grid->nx * grid->ny)) {
        status = fail_damaged(in, "grid", err);
    }
out:
    return status;
}

// Which step; the maps of a history that kept only its last one have no steps.
static lac_status choose_step(const lac_input *in, const lac_snapshot_choice *choice,
                              lac_stored_cells *out, lac_error *err)
{
    int id = 0;
    int rank = 0;
    out->kind = LAC_STORED_HISTORY;
    if (nc_inq_varid(in->id, "traction_x", &id) != NC_NOERR ||
        nc_inq_varndims(in->id, id, &rank) != NC_NOERR) {
        return lac_fail(err, LAC_EINPUT,
                        "%s: holds no tractions of cells: solve the case with "
                        "load.history.fields: all",
                        in->path);
    }
    if (choice->by == LAC_SNAPSHOT_TIME) {
        return lac_fail(err, LAC_EINPUT, "%s: its steps have no times: give a number", in->path);
    }
    out->snapshots = rank == RANK ? length_of(in, "step") : 1;
    out->index = choice->by == LAC_SNAPSHOT_INDEX ? choice->index : out->snapshots - 1;
    return out->index < out->snapshots ? LAC_OK : fail_choice(in, out->snapshots, err);
}

// The cascade knows the shear along x alone; a y force of 1e-3 of the normal force is none.
static lac_status check_along_x(const lac_input *in, double *map, const lac_stored_cells *out,
                                lac_error *err)
{
    const lac_domain *domain = out->domain;
    double across = 0.0;
    double normal = 0.0;
    lac_status status;
    LAC_TRY(read_map(in, "traction_y", out->index, &domain->grid, map, err));
    for (size_t i = 0; i < domain->n; i++) {
        across += map[domain->index[i]];
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

static lac_status read_shear(const lac_input *in, double *map, lac_stored_cells *out,
                             lac_error *err)
{
    const lac_domain *domain = out->domain;
    lac_status status = LAC_OK;
    LAC_TRY(new_doubles(domain->n, &out->shear, err));
    if (out->kind == LAC_STORED_HISTORY) {
        LAC_TRY(check_along_x(in, map, out, err));
        LAC_TRY(read_map(in, "traction_x", out->index, &domain->grid, map, err));
    }
    for (size_t i = 0; i < domain->n; i++) {
        out->shear[i] = out->kind == LAC_STORED_HISTORY ? map[domain->index[i]] : 0.0;
    }
out:
    return status;
}

// The cells that are pressed in the map of a contact, or of a step where steps kept theirs.
static lac_status read_pressed(const lac_input *in, size_t step, lac_domain **domain,
                               lac_error *err)
{
    lac_grid grid;
    double *map = NULL;
    const char *name = has_variable(in, "step_pressure") ? "step_pressure" : "pressure";
    lac_status status;
    LAC_TRY(read_axes(in, &grid, err));
    LAC_TRY(new_doubles(lac_grid_cells(&grid), &map, err));
    LAC_TRY(lac_input_must_be(in, name, "Pa", err));
    LAC_TRY(read_map(in, name, step, &grid, map, err));
    status = lac_domain_create(&grid, map, domain, err);
    if (status != LAC_OK) {
        status = lac_fail_within(err, status, "%s", in->path);
    }
out:
    free(map);
    return status;
}

static lac_status read_contact(const lac_input *in, const lac_snapshot_choice *choice,
                               lac_stored_cells *out, lac_error *err)
{
    double *map = NULL;
    lac_status status = LAC_OK;
    out->kind = LAC_STORED_CONTACT;
    out->snapshots = 1;
    out->time = NAN;
    if (has_variable(in, "step")) {
        LAC_TRY(choose_step(in, choice, out, err));
    } else if (choice->by != LAC_SNAPSHOT_LAST) {
        LAC_TRY(lac_fail(err, LAC_EINPUT, "%s: is a contact, which has no snapshots", in->path));
    }
    LAC_TRY(read_pressed(in, out->index, &out->domain, err));
    LAC_TRY(new_doubles(lac_grid_cells(&out->domain->grid), &map, err));
    LAC_TRY(read_shear(in, map, out, err));
out:
    free(map);
    return status;
}

static bool is_run(const lac_input *in)
{
    int grid = 0;
    return nc_inq_attid(in->id, NC_GLOBAL, "grid_nx", &grid) == NC_NOERR;
}

static bool is_contact(const lac_input *in)
{
    return length_of(in, "x") > 0 && length_of(in, "y") > 0;
}

static lac_status fail_other(const lac_input *in, lac_error *err)
{
    return lac_fail(err, LAC_EIO, "%s: is neither a run nor a contact", in->path);
}

lac_status lac_stored_domain_read(const char *path, lac_domain **domain, lac_error *err)
{
    lac_input in;
    lac_status status;
    *domain = NULL;
    LAC_TRY(lac_input_open(&in, path, err));
    if (is_run(&in)) {
        LAC_TRY(read_domain(&in, domain, err));
    } else if (is_contact(&in)) {
        size_t steps = has_variable(&in, "step_pressure") ? length_of(&in, "step") : 0;
        LAC_TRY(read_pressed(&in, steps > 0 ? steps - 1 : 0, domain, err));
    } else {
        LAC_TRY(fail_other(&in, err));
    }
out:
    lac_input_close(&in);
    if (status != LAC_OK) {
        lac_domain_free(*domain);
        *domain = NULL;
    }
    return status;
}

lac_status lac_stored_cells_read(const char *path, const lac_snapshot_choice *choice,
                                 lac_stored_cells *out, lac_error *err)
{
    lac_input in;
    lac_status status = LAC_OK;
    *out = (lac_stored_cells){0};
    LAC_TRY(lac_input_open(&in, path, err));
    LAC_TRY(read_provenance(&in, out, err));
    if (is_run(&in)) {
        LAC_TRY(read_run(&in, choice, out, err));
    } else if (is_contact(&in)) {
        LAC_TRY(read_contact(&in, choice, out, err));
    } else {
        LAC_TRY(fail_other(&in, err));
    }
out:
    lac_input_close(&in);
    return status;
}
