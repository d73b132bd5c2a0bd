// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a run's file: dimensions, variables, and the values that do not change.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "store/internal.h"

enum {
    RECORD_CHUNK = 512,      // records a chunk: 4 kB, what a sync rewrites of each variable
    CELL_CHUNK_MAX = 1 << 20 // cells a chunk: 8 MB, within netCDF's cache
};

static const lac_nc_var cell_x = {.name = "x",
                                  .unit = "m",
                                  .long_name = "position of the cell's centre along x",
                                  .comment = "slip is along x; contact cells stand in hierarchy "
                                             "(Morton) order",
                                  .type = NC_DOUBLE};
static const lac_nc_var cell_y = {.name = "y",
                                  .unit = "m",
                                  .long_name = "position of the cell's centre along y",
                                  .type = NC_DOUBLE};
static const lac_nc_var cell_pressure = {.name = "pressure",
                                         .unit = "Pa",
                                         .long_name = "normal pressure on each contact cell",
                                         .comment = "of the contact before pore pressure",
                                         .coordinates = "x y",
                                         .type = NC_DOUBLE};
static const lac_nc_var cell_area = {.name = "cell_area",
                                     .unit = "m2",
                                     .long_name = "area of each contact cell",
                                     .standard_name = "cell_area",
                                     .coordinates = "x y",
                                     .type = NC_DOUBLE};
static const lac_nc_var level_var = {.name = "level",
                                     .unit = "1",
                                     .long_name = "level of the hierarchy",
                                     .comment = "0: the contact cells; each level up doubles the "
                                                "side of a block; the last one holds everything",
                                     .type = NC_INT};
static const lac_nc_var level_size = {.name = "block_size",
                                      .unit = "m",
                                      .long_name = "side of a block of this level along x",
                                      .type = NC_DOUBLE};
static const lac_nc_var level_width = {.name = "block_width",
                                       .unit = "m",
                                       .long_name = "side of a block of this level along y",
                                       .type = NC_DOUBLE};
static const lac_nc_var level_total = {.name = "n_tot",
                                       .unit = "1",
                                       .long_name = "blocks of this level that hold a contact cell",
                                       .coordinates = "block_size",
                                       .type = NC_INT64};

static const lac_nc_var level_stiffness = {
    .name = "hierarchy_stiffness",
    .unit = "Pa m-1",
    .long_name = "stiffness k_l of the hierarchy at this level",
    .comment =
        "what slip takes off a cell: sum over l of k_l (P_l - P_l+1) slip, P_l the mean over "
        "the contact cells of a block; missing for the block that holds all",
    .coordinates = "block_size",
    .type = NC_DOUBLE,
    .fill = true};

static lac_status put_real(const lac_store *s, int id, const char *name, const double *values,
                           lac_error *err)
{
    return lac_nc_check(s->file.path, nc_put_var_double(s->file.id, id, values), err, "write",
                        name);
}

typedef double cell_value(const lac_domain *domain, size_t cell);

static double value_x(const lac_domain *domain, size_t cell)
{
    return ((double)(domain->index[cell] % domain->grid.nx) + 0.5) * domain->grid.dx;
}

static double value_y(const lac_domain *domain, size_t cell)
{
    size_t row = domain->index[cell] / domain->grid.nx;
    return ((double)row + 0.5) * domain->grid.dy;
}

static double value_pressure(const lac_domain *domain, size_t cell)
{
    return domain->pressure[cell];
}

static double value_area(const lac_domain *domain, size_t cell)
{
    (void)cell;
    return lac_grid_cell_area(&domain->grid);
}

static const struct {
    const lac_nc_var *var;
    cell_value *value;
} cell_vars[] = {{&cell_x, value_x},
                 {&cell_y, value_y},
                 {&cell_pressure, value_pressure},
                 {&cell_area, value_area}};

static const lac_nc_var *const level_vars[] = {&level_var, &level_size, &level_width, &level_total};

enum {
    CELL_VARS = sizeof cell_vars / sizeof cell_vars[0],
    LEVEL_VARS = sizeof level_vars / sizeof level_vars[0]
};

// Variables that are written once.
typedef struct fixed {
    int cells[CELL_VARS];
    int levels[LEVEL_VARS];
    int stiffness;
} fixed;

// Whether what is taken off the cells follows from one number a level.
static bool has_stiffness(const lac_store_def *def)
{
    return def->transfer != NULL && def->transfer->kind->blocks != NULL;
}

static lac_status define_cells(const lac_store *s, int dim, fixed *ids, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < CELL_VARS; i++) {
        LAC_TRY(
            lac_nc_define(&s->file, cell_vars[i].var, 1, &dim, &s->cells, 1, &ids->cells[i], err));
    }
out:
    return status;
}

static lac_status put_cells(const lac_store *s, const lac_domain *domain, const fixed *ids,
                            lac_error *err)
{
    double *values = malloc(domain->n * sizeof *values);
    if (values == NULL) {
        return lac_fail_memory(err);
    }
    lac_status status = LAC_OK;
    for (size_t i = 0; i < CELL_VARS; i++) {
        for (size_t c = 0; c < domain->n; c++) {
            values[c] = cell_vars[i].value(domain, c);
        }
        LAC_TRY(put_real(s, ids->cells[i], cell_vars[i].var->name, values, err));
    }
out:
    free(values);
    return status;
}

static lac_status put_grid(const lac_store *s, const lac_grid *grid, lac_error *err)
{
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_integer(&s->file, NC_GLOBAL, "grid_nx", (long long)grid->nx, err));
    LAC_TRY(lac_nc_integer(&s->file, NC_GLOBAL, "grid_ny", (long long)grid->ny, err));
    LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "grid_dx_m", grid->dx, err));
    LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "grid_dy_m", grid->dy, err));
    LAC_TRY(
        lac_nc_text(&s->file, NC_GLOBAL, "boundary", grid->periodic ? "periodic" : "free", err));
out:
    return status;
}

static lac_status define_levels(const lac_store *s, const lac_store_def *def, fixed *ids,
                                lac_error *err)
{
    lac_status status = LAC_OK;
    int dim = 0;
    LAC_TRY(lac_nc_dim(&s->file, "level", lac_hierarchy_levels(def->hierarchy) + 1, &dim, err));
    for (size_t i = 0; i < LEVEL_VARS; i++) {
        LAC_TRY(lac_nc_define(&s->file, level_vars[i], 1, &dim, NULL, 0, &ids->levels[i], err));
    }
    if (has_stiffness(def)) {
        LAC_TRY(lac_nc_define(&s->file, &level_stiffness, 1, &dim, NULL, 0, &ids->stiffness, err));
    }
out:
    return status;
}

static lac_status put_stiffness(const lac_store *s, const lac_store_def *def, int id,
                                lac_error *err)
{
    const lac_transfer *transfer = def->transfer;
    int code = NC_NOERR;
    for (size_t l = 0; l < lac_hierarchy_levels(def->hierarchy) && code == NC_NOERR; l++) {
        const double k = transfer->kind->stiffness(transfer->state, l);
        code = nc_put_var1_double(s->file.id, id, &l, &k);
    }
    return lac_nc_check(s->file.path, code, err, "write", level_stiffness.name);
}

static lac_status put_levels(const lac_store *s, const lac_hierarchy *h, const lac_grid *grid,
                             const fixed *ids, lac_error *err)
{
    lac_status status = LAC_OK;
    const int *id = ids->levels;
    for (size_t l = 0; l <= lac_hierarchy_levels(h); l++) {
        // Blocks of a line or a single row are as wide as the row.
        const double side = ldexp(grid->dx, (int)l);
        const double across = grid->ny > 1 ? ldexp(grid->dy, (int)l) : grid->dy;
        const long long name = (long long)l;
        const long long blocks = (long long)lac_hierarchy_blocks(h, l);
        int code = nc_put_var1_longlong(s->file.id, id[0], &l, &name);
        code = code == NC_NOERR ? nc_put_var1_double(s->file.id, id[1], &l, &side) : code;
        code = code == NC_NOERR ? nc_put_var1_double(s->file.id, id[2], &l, &across) : code;
        code = code == NC_NOERR ? nc_put_var1_longlong(s->file.id, id[3], &l, &blocks) : code;
        LAC_TRY(lac_nc_check(s->file.path, code, err, "write the levels", ""));
    }
out:
    return status;
}

static lac_status define_columns(lac_store *s, const lac_store_def *def, lac_error *err)
{
    const size_t chunk = RECORD_CHUNK;
    lac_status status = LAC_OK;
    int dim = 0;
    LAC_TRY(lac_nc_dim(&s->file, "time", NC_UNLIMITED, &dim, err));
    for (size_t c = 0; c < LAC_COLUMNS; c++) {
        lac_nc_var var = lac_columns[c].var;
        if (c == LAC_COLUMN_TIME) {
            var.unit = s->time_unit;
            // CF's `time` is a date; seconds since an undated start have no standard name.
            var.standard_name = s->dated ? "time" : NULL;
        }
        if (def->single && var.type == NC_DOUBLE && strncmp(var.name, "time", 4) != 0) {
            var.type = NC_FLOAT;
        }
        LAC_TRY(lac_nc_define(&s->file, &var, 1, &dim, &chunk, 0, &s->columns[c], err));
    }
    if (s->dated) {
        LAC_TRY(lac_nc_text(&s->file, s->columns[LAC_COLUMN_TIME], "calendar",
                            "proleptic_gregorian", err));
    }
    LAC_TRY(lac_nc_text(&s->file, s->columns[LAC_COLUMN_TIME], "axis", s->dated ? "T" : NULL, err));
out:
    return status;
}

static lac_status define_fields(lac_store *s, const lac_store_def *def, int cell_dim,
                                lac_error *err)
{
    const lac_nc_var time = {.name = "snapshot_time",
                             .unit = s->time_unit,
                             .long_name = "time of the snapshot since the start of the run",
                             .standard_name = s->dated ? "time" : NULL,
                             .type = NC_DOUBLE,
                             .appended = true};
    const size_t time_chunk = RECORD_CHUNK;
    const size_t chunk[2] = {1, s->cells < CELL_CHUNK_MAX ? s->cells : CELL_CHUNK_MAX};
    lac_status status = LAC_OK;
    int dims[2] = {0, cell_dim};
    LAC_TRY(lac_nc_dim(&s->file, "snapshot", NC_UNLIMITED, &dims[0], err));
    LAC_TRY(lac_nc_define(&s->file, &time, 1, dims, &time_chunk, 0, &s->snapshot_time, err));
    if (s->dated) {
        LAC_TRY(lac_nc_text(&s->file, s->snapshot_time, "calendar", "proleptic_gregorian", err));
    }
    for (size_t f = 0; f < LAC_FIELDS; f++) {
        if ((s->fields & lac_fields[f].flag) == 0) {
            continue;
        }
        lac_nc_var var = lac_fields[f].var;
        var.type = def->single ? NC_FLOAT : NC_DOUBLE;
        LAC_TRY(lac_nc_define(&s->file, &var, 2, dims, chunk, (int)def->compression,
                              &s->field_ids[f], err));
        LAC_TRY(lac_nc_text(&s->file, s->field_ids[f], "cell_measures", "area: cell_area", err));
    }
out:
    return status;
}

static lac_status put_coverage(const lac_store *s, lac_error *err)
{
    char date[32];
    return !s->dated ? LAC_OK
                     : lac_nc_text(&s->file, NC_GLOBAL, "time_coverage_start",
                                   lac_date_format(s->start_date, date, sizeof date), err);
}

lac_status lac_store_define(lac_store *s, const lac_store_def *def, lac_error *err)
{
    static const char *const summary =
        "Creep of a rough rock joint under rate-and-state friction: means over its contact cells "
        "against time, one record per line of the time series; fields of every cell where "
        "snapshots were asked for. The attribute `case` is the whole input; `status` says whether "
        "the file is whole.";
    const bool levels = def->hierarchy != NULL && def->domain != NULL;
    fixed ids;
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_provenance(&s->file, &def->provenance, summary, err));
    LAC_TRY(lac_nc_text(&s->file, NC_GLOBAL, "status", "running", err));
    LAC_TRY(put_coverage(s, err));
    LAC_TRY(define_columns(s, def, err));
    if (def->domain != NULL) {
        int dim = 0;
        LAC_TRY(put_grid(s, &def->domain->grid, err));
        LAC_TRY(lac_nc_dim(&s->file, "cell", s->cells, &dim, err));
        LAC_TRY(define_cells(s, dim, &ids, err));
        if (s->fields != 0) {
            LAC_TRY(define_fields(s, def, dim, err));
        }
    }
    if (levels) {
        LAC_TRY(define_levels(s, def, &ids, err));
    }
    LAC_TRY(lac_store_define_extras(s, err));
    if (s->events != NULL) {
        LAC_TRY(lac_store_define_events(s, err));
    }
    // All is defined before a value is written: going back to defining flushes the file.
    if (def->domain != NULL) {
        LAC_TRY(put_cells(s, def->domain, &ids, err));
    }
    if (levels) {
        LAC_TRY(put_levels(s, def->hierarchy, &def->domain->grid, &ids, err));
        LAC_TRY(has_stiffness(def) ? put_stiffness(s, def, ids.stiffness, err) : LAC_OK);
    }
out:
    return status;
}
