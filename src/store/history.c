// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of a history in the file of a solved contact, written one by one.
#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "store/nc.h"

enum {
    CHUNK_CELLS = 1 << 18, // of a map: whole rows, about 2 MB
    CHUNK_STEPS = 256,     // of a series
};

#define SERIES(n, u, text) .name = (n), .unit = (u), .long_name = (text), .appended = true
#define MAP(n, u, text) .name = (n), .unit = (u), .long_name = (text)

enum {
    STEP = 0,
    NORMAL_FORCE,
    SHEAR_FORCE_X,
    SHEAR_FORCE_Y,
    SHIFT_X,
    SHIFT_Y,
    STICK_CELLS,
    SLIP_CELLS,
    DISSIPATION,
    CUMULATIVE_DISSIPATION,
    CYCLE_START,
    CYCLE_DISSIPATION,
    CYCLE_SHIFT,
    HIGHEST_RATIO,
    HIGHEST_X,
    HIGHEST_Y,
    SHEAR_ITERATIONS,
    SHEAR_PRODUCTS,
    SHEAR_RESIDUAL,
    CONTACT_ITERATIONS,
    SERIES_COUNT,
};

static const lac_nc_var series[SERIES_COUNT] = {
    [STEP] = {SERIES("step", "1", "number of the step, increments counted"),
              .comment = "from 1; 0 is the start, which is not written", .type = NC_INT},
    [NORMAL_FORCE] = {SERIES("normal_force", "N", "normal force on the interface"),
                      .type = NC_DOUBLE},
    [SHEAR_FORCE_X] = {SERIES("shear_force_x", "N", "shear force on the interface along x"),
                       .type = NC_DOUBLE},
    [SHEAR_FORCE_Y] = {SERIES("shear_force_y", "N", "shear force on the interface along y"),
                       .type = NC_DOUBLE},
    [SHIFT_X] = {SERIES("shift_x", "m", "shift of one body against the other along x, far away"),
                 .type = NC_DOUBLE},
    [SHIFT_Y] = {SERIES("shift_y", "m", "shift of one body against the other along y, far away"),
                 .type = NC_DOUBLE},
    [STICK_CELLS] = {SERIES("stick_cells", "1", "contact cells that stick"), .type = NC_INT},
    [SLIP_CELLS] = {SERIES("slip_cells", "1", "contact cells that slip"), .type = NC_INT},
    [DISSIPATION] = {SERIES("dissipation", "J", "frictional work of the step"), .type = NC_DOUBLE},
    [CUMULATIVE_DISSIPATION] = {SERIES("cumulative_dissipation", "J",
                                       "frictional work since the start"),
                                .type = NC_DOUBLE},
    [CYCLE_START] = {SERIES("cycle_start", "1", "earlier step to whose loads this one comes back"),
                     .comment = "missing where it comes back to none; 0: the start", .type = NC_INT,
                     .fill = true},
    [CYCLE_DISSIPATION] = {SERIES("cycle_dissipation", "J", "frictional work since that step"),
                           .comment = "missing where the step ends no cycle", .type = NC_DOUBLE,
                           .fill = true},
    [CYCLE_SHIFT] = {SERIES("cycle_shift", "m", "shift left over since that step"),
                     .comment = "0: a closed loop; missing where the step ends no cycle",
                     .type = NC_DOUBLE, .fill = true},
    [HIGHEST_RATIO] = {SERIES("highest_ratio", "1", "highest q/(f p) of the cells that stick"),
                       .comment = "missing where none does", .type = NC_DOUBLE, .fill = true},
    [HIGHEST_X] = {SERIES("highest_x", "m", "where it is along x"), .type = NC_DOUBLE,
                   .fill = true},
    [HIGHEST_Y] = {SERIES("highest_y", "m", "where it is along y"), .type = NC_DOUBLE,
                   .fill = true},
    [SHEAR_ITERATIONS] = {SERIES("shear_iterations", "1", "iterations of the shear solver"),
                          .type = NC_INT},
    [SHEAR_PRODUCTS] = {SERIES("shear_products", "1", "applications of the elastic operator"),
                        .type = NC_INT},
    [SHEAR_RESIDUAL] = {SERIES("shear_residual", "1",
                               "how far the conditions of the solution are from holding"),
                        .type = NC_DOUBLE},
    [CONTACT_ITERATIONS] = {SERIES("contact_iterations", "1",
                                   "iterations of the normal contact solver"),
                            .comment = "0 where the pressure did not change", .type = NC_INT},
};

enum { TRACTION_X, TRACTION_Y, SLIP_X, SLIP_Y, STATE, PRESSURE, MAP_COUNT };

static const lac_nc_var map_vars[MAP_COUNT] = {
    [TRACTION_X] = {MAP("traction_x", "Pa", "shear traction along x"), .type = NC_DOUBLE},
    [TRACTION_Y] = {MAP("traction_y", "Pa", "shear traction along y"), .type = NC_DOUBLE},
    [SLIP_X] = {MAP("slip_x", "m", "slip along x since the start"), .type = NC_DOUBLE},
    [SLIP_Y] = {MAP("slip_y", "m", "slip along y since the start"), .type = NC_DOUBLE},
    [STATE] = {MAP("state", "1", "whether a cell is open, sticks or slips"), .type = NC_BYTE},
    [PRESSURE] = {MAP("step_pressure", "Pa", "normal contact pressure of the step"),
                  .comment = "`pressure` is that of the start", .type = NC_DOUBLE},
};

struct lac_history_store {
    lac_nc file;
    double area; // nominal [m2]
    size_t nx, ny, steps;
    lac_history_keep keep;
    bool pressed;
    int series[SERIES_COUNT], maps[MAP_COUNT];
};

static lac_status define_series(lac_history_store *s, int dim, lac_error *err)
{
    const size_t chunk = CHUNK_STEPS;
    lac_status status = LAC_OK;
    for (int i = 0; i < SERIES_COUNT; i++) {
        LAC_TRY(lac_nc_define(&s->file, &series[i], 1, &dim, &chunk, 0, &s->series[i], err));
    }
out:
    return status;
}

// CF's way to say what the numbers of a map stand for.
static lac_status put_flags(const lac_history_store *s, lac_error *err)
{
    const signed char values[] = {LAC_CELL_OPEN, LAC_CELL_STICK, LAC_CELL_SLIP};
    int code =
        nc_put_att_schar(s->file.id, s->maps[STATE], "flag_values", NC_BYTE, sizeof values, values);
    lac_status status = lac_nc_check(s->file.path, code, err, "write the attribute", "flag_values");
    return status == LAC_OK
               ? lac_nc_text(&s->file, s->maps[STATE], "flag_meanings", "open stick slip", err)
               : status;
}

static bool has_map(const lac_history_store *s, int map) { return map != PRESSURE || s->pressed; }

// With `step` in front where every step is kept.
static lac_status define_maps(lac_history_store *s, int step, lac_error *err)
{
    int dims[3] = {step, 0, 0};
    size_t rows = CHUNK_CELLS / s->nx;
    rows = rows < 1 ? 1 : rows;
    const size_t chunk[3] = {1, rows < s->ny ? rows : s->ny,
                             s->nx < CHUNK_CELLS ? s->nx : CHUNK_CELLS};
    const int skip = s->keep == LAC_KEEP_LAST;
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_check(s->file.path, nc_inq_dimid(s->file.id, "y", &dims[1]), err, "find", "y"));
    LAC_TRY(lac_nc_check(s->file.path, nc_inq_dimid(s->file.id, "x", &dims[2]), err, "find", "x"));
    for (int i = 0; i < MAP_COUNT; i++) {
        if (has_map(s, i)) {
            LAC_TRY(lac_nc_define(&s->file, &map_vars[i], 3 - skip, dims + skip, chunk + skip, 1,
                                  &s->maps[i], err));
        }
    }
    LAC_TRY(put_flags(s, err));
out:
    return status;
}

static lac_status define(lac_history_store *s, const lac_history_store_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    int step = 0;
    LAC_TRY(lac_nc_provenance(&s->file, &def->provenance,
                              "Contact of a rough rock joint through a history of normal and shear "
                              "load: forces, shifts and frictional work of each step, and which "
                              "cells stick or slip.",
                              err));
    LAC_TRY(lac_nc_dataset(&s->file, def->contact, err));
    LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "friction_coefficient", def->friction, err));
    LAC_TRY(lac_nc_text(&s->file, NC_GLOBAL, "history_method", "direct", err));
    LAC_TRY(lac_nc_dim(&s->file, "step", NC_UNLIMITED, &step, err));
    LAC_TRY(define_series(s, step, err));
    if (s->keep != LAC_KEEP_NONE) {
        LAC_TRY(define_maps(s, step, err));
    }
    LAC_TRY(lac_nc_text(&s->file, NC_GLOBAL, "status", "running", err));
out:
    return status;
}

lac_status lac_history_store_create(const lac_history_store_def *def, lac_history_store **out,
                                    lac_error *err)
{
    lac_status status = LAC_OK;
    const lac_grid *grid = def->grid;
    *out = NULL;
    lac_history_store *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return lac_fail_memory(err);
    }
    s->area = lac_grid_area(grid);
    s->nx = grid->nx;
    s->ny = grid->ny;
    s->keep = def->keep;
    s->pressed = def->pressed;
    LAC_TRY(lac_nc_create(&s->file, def->path, def->force, err));
    LAC_TRY(define(s, def, err));
    LAC_TRY(lac_nc_sync(&s->file, err));
    LAC_TRY(lac_nc_keep_journal(&s->file, err));
    LAC_TRY(lac_nc_publish(&s->file, err));
    *out = s;
    s = NULL;
out:
    lac_history_store_free(s);
    return status;
}

lac_status lac_history_store_step(lac_history_store *store, const lac_history_record *record,
                                  lac_error *err)
{
    const lac_tangential_report *shear = &record->shear;
    const double values[SERIES_COUNT] = {
        [STEP] = (double)store->steps + 1,
        [NORMAL_FORCE] = record->pressure * store->area,
        [SHEAR_FORCE_X] = shear->traction[0] * store->area,
        [SHEAR_FORCE_Y] = shear->traction[1] * store->area,
        [SHIFT_X] = shear->shift[0],
        [SHIFT_Y] = shear->shift[1],
        [STICK_CELLS] = (double)shear->stick_cells,
        [SLIP_CELLS] = (double)shear->slip_cells,
        [DISSIPATION] = shear->dissipation,
        [CUMULATIVE_DISSIPATION] = record->dissipated,
        [CYCLE_START] = record->cycle_start == SIZE_MAX ? NAN : (double)record->cycle_start,
        [CYCLE_DISSIPATION] = record->cycle_dissipation,
        [CYCLE_SHIFT] = record->cycle_shift,
        [HIGHEST_RATIO] = isnan(record->highest[0]) ? NAN : shear->highest_ratio,
        [HIGHEST_X] = record->highest[0],
        [HIGHEST_Y] = record->highest[1],
        [SHEAR_ITERATIONS] = (double)shear->iterations,
        [SHEAR_PRODUCTS] = (double)shear->products,
        [SHEAR_RESIDUAL] = shear->residual,
        [CONTACT_ITERATIONS] = (double)record->contact_iterations,
    };
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_reserve(&store->file, sizeof values + SERIES_COUNT * CHUNK_STEPS * 8, err));
    const size_t one = 1;
    for (int i = 0; i < SERIES_COUNT; i++) {
        const double missing = series[i].type == NC_INT ? NC_FILL_INT : NC_FILL_DOUBLE;
        const double value = isnan(values[i]) ? missing : values[i];
        errno = 0;
        LAC_TRY(lac_nc_check(
            store->file.path,
            lac_nc_append(&store->file, NC_DOUBLE, store->series[i], &store->steps, &one, &value),
            err, "write", series[i].name));
    }
    store->steps++;
    // Where its maps come next, one sync brings both: no step without its maps is left by a kill.
    if (store->keep != LAC_KEEP_ALL) {
        LAC_TRY(lac_nc_sync(&store->file, err));
    }
out:
    return status;
}

lac_status lac_history_store_maps(lac_history_store *store, const lac_history_maps *maps,
                                  lac_error *err)
{
    assert(store->keep != LAC_KEEP_NONE && store->steps > 0);
    const int skip = store->keep == LAC_KEEP_LAST;
    const size_t start[3] = {store->steps - 1, 0, 0};
    const size_t count[3] = {1, store->ny, store->nx};
    const double *const values[MAP_COUNT] = {[TRACTION_X] = maps->traction[0],
                                             [TRACTION_Y] = maps->traction[1],
                                             [SLIP_X] = maps->slip[0],
                                             [SLIP_Y] = maps->slip[1],
                                             [PRESSURE] = maps->pressure};
    lac_status status = LAC_OK;
    // Incompressible at worst.
    LAC_TRY(lac_nc_reserve(&store->file, MAP_COUNT * store->nx * store->ny * (sizeof(double) + 1),
                           err));
    for (int i = 0; i < MAP_COUNT; i++) {
        int id = store->maps[i];
        int code = NC_NOERR;
        errno = 0;
        if (i == STATE) {
            code =
                lac_nc_append(&store->file, NC_UBYTE, id, start + skip, count + skip, maps->state);
        } else if (has_map(store, i)) {
            code =
                lac_nc_append(&store->file, NC_DOUBLE, id, start + skip, count + skip, values[i]);
        }
        LAC_TRY(lac_nc_check(store->file.path, code, err, "write", map_vars[i].name));
    }
    LAC_TRY(lac_nc_sync(&store->file, err));
out:
    return status;
}

lac_status lac_history_store_number(lac_history_store *store, const char *name, double value,
                                    lac_error *err)
{
    return isnan(value) ? LAC_OK : lac_nc_real(&store->file, NC_GLOBAL, name, value, err);
}

lac_status lac_history_store_finish(lac_history_store *store, const char *status, lac_error *err)
{
    assert(store->file.open);
    lac_status first = lac_nc_text(&store->file, NC_GLOBAL, "status", status, err);
    lac_status second = lac_nc_close(&store->file, first == LAC_OK ? err : NULL);
    return first != LAC_OK ? first : second;
}

void lac_history_store_free(lac_history_store *store)
{
    if (store != NULL) {
        lac_nc_clear(&store->file);
        free(store);
    }
}
