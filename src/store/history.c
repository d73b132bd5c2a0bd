// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of a history in the file of a solved contact, written one by one.
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "data/describe.h"
#include "store/writer.h"

enum { CHUNK_STEPS = 256 };

// What is put out now; the rows below are laid on it.
typedef struct step {
    double number; // steps so far
    double area;   // nominal [m2]
    double friction;
    bool pressed;
    lac_history_record record;
    lac_history_maps maps;
} step;

struct lac_history_store {
    lac_nc file;
    lac_writer writer;
    lac_history_keep keep;
    step now;
};

#define STEP const step *s = of
#define SHEAR           \
    const step *s = of; \
    const lac_tangential_report *r = &s->record.shear
#define G(getter) .value = (getter)
#define S(kind, field) LAC_HELD(kind, step, field)

LAC_GETTER(double, normal_force, STEP, s->record.pressure * s->area)
LAC_GETTER(double, shear_force_x, SHEAR, r->traction[0] * s->area)
LAC_GETTER(double, shear_force_y, SHEAR, r->traction[1] * s->area)
LAC_GETTER(double, cycle_start, STEP,
           s->record.cycle_start != SIZE_MAX ? (double)s->record.cycle_start : NAN)
LAC_GETTER(double, highest_ratio, SHEAR, isnan(s->record.highest[0]) ? NAN : r->highest_ratio)
LAC_GETTER(bool, is_pressed, STEP, s->pressed)
LAC_TEXT_GETTER(method, (void)of, "direct")
LAC_TEXT_GETTER(running, (void)of, "running")

#define WHOLE .flags = LAC_WHOLE
#define MISSING .flags = LAC_MISSING

static const lac_variable of_history[] = {
    {.name = "friction_coefficient", S(REAL, friction)},
    {.name = "history_method", .text = method},
    {.name = "status", .text = running},
};

static const lac_variable of_step[] = {
    LAC_ROW("step", NULL, "1", "number of the step, increments counted", S(REAL, number), WHOLE,
            .comment = "from 1; 0 is the start, which is not written"),
    LAC_ROW("normal_force", NULL, "N", "normal force on the interface", G(normal_force)),
    LAC_ROW("shear_force_x", NULL, "N", "shear force on the interface along x", G(shear_force_x)),
    LAC_ROW("shear_force_y", NULL, "N", "shear force on the interface along y", G(shear_force_y)),
    LAC_ROW("shift_x", NULL, "m", "shift of one body against the other along x, far away",
            S(REAL, record.shear.shift[0])),
    LAC_ROW("shift_y", NULL, "m", "shift of one body against the other along y, far away",
            S(REAL, record.shear.shift[1])),
    LAC_ROW("stick_cells", NULL, "1", "contact cells that stick",
            S(COUNT, record.shear.stick_cells), WHOLE),
    LAC_ROW("slip_cells", NULL, "1", "contact cells that slip", S(COUNT, record.shear.slip_cells),
            WHOLE),
    LAC_ROW("dissipation", NULL, "J", "frictional work of the step",
            S(REAL, record.shear.dissipation)),
    LAC_ROW("cumulative_dissipation", NULL, "J", "frictional work since the start",
            S(REAL, record.dissipated)),
    LAC_ROW("cycle_start", NULL, "1", "earlier step to whose loads this one comes back",
            G(cycle_start), .flags = LAC_WHOLE | LAC_MISSING,
            .comment = "missing where it comes back to none; 0: the start"),
    LAC_ROW("cycle_dissipation", NULL, "J", "frictional work since that step",
            S(REAL, record.cycle_dissipation), MISSING,
            .comment = "missing where the step ends no cycle"),
    LAC_ROW("cycle_shift", NULL, "m", "shift left over since that step",
            S(REAL, record.cycle_shift), MISSING,
            .comment = "0: a closed loop; missing where the step ends no cycle"),
    LAC_ROW("highest_ratio", NULL, "1", "highest q/(f p) of the cells that stick", G(highest_ratio),
            MISSING, .comment = "missing where none does"),
    LAC_ROW("highest_x", NULL, "m", "where it is along x", S(REAL, record.highest[0]), MISSING),
    LAC_ROW("highest_y", NULL, "m", "where it is along y", S(REAL, record.highest[1]), MISSING),
    LAC_ROW("shear_iterations", NULL, "1", "iterations of the shear solver",
            S(INT64, record.shear.iterations), WHOLE),
    LAC_ROW("shear_products", NULL, "1", "applications of the elastic operator",
            S(INT64, record.shear.products), WHOLE),
    LAC_ROW("shear_residual", NULL, "1", "how far the conditions of the solution are from holding",
            S(REAL, record.shear.residual)),
    LAC_ROW("contact_iterations", NULL, "1", "iterations of the normal contact solver",
            S(INT64, record.contact_iterations), WHOLE,
            .comment = "0 where the pressure did not change"),
};

#define MAP(kind, field) S(kind, maps.field), .flags = LAC_CELLS | LAC_LATE
static const lac_variable of_maps[] = {
    LAC_ROW("traction_x", NULL, "Pa", "shear traction along x", MAP(REALS, traction[0])),
    LAC_ROW("traction_y", NULL, "Pa", "shear traction along y", MAP(REALS, traction[1])),
    LAC_ROW("slip_x", NULL, "m", "slip along x since the start", MAP(REALS, slip[0])),
    LAC_ROW("slip_y", NULL, "m", "slip along y since the start", MAP(REALS, slip[1])),
    LAC_ROW("state", NULL, "1", "whether a cell is open, sticks or slips", MAP(BYTES, state),
            .meanings = "open stick slip"),
    LAC_ROW("step_pressure", NULL, "Pa", "normal contact pressure of the step",
            MAP(REALS, pressure), .has = is_pressed, .comment = "`pressure` is that of the start"),
};

static lac_status describe(const lac_history_store_def *def, const step *now, lac_error *err)
{
    const lac_extent dim = {"step", LAC_GROWS};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_history, "", 0), now},
        {LAC_VARIABLES(of_step, "step", 0), now},
        {LAC_VARIABLES(of_maps, def->keep == LAC_KEEP_ALL ? "step y x" : "y x", 0), now}};
    lac_status status = lac_dataset_dims(def->contact, &dim, 1, err);
    return status == LAC_OK
               ? lac_dataset_add(def->contact, laid, def->keep == LAC_KEEP_NONE ? 2 : 3, err)
               : status;
}

static lac_status begin_file(lac_history_store *s, const lac_history_store_def *def, lac_error *err)
{
    lac_status status;
    LAC_TRY(lac_nc_create(&s->file, def->path, def->force, err));
    LAC_TRY(lac_nc_provenance(&s->file, &def->provenance,
                              "Contact of a rough rock joint through a history of normal and shear "
                              "load: forces, shifts and frictional work of each step, and which "
                              "cells stick or slip.",
                              err));
    LAC_TRY(lac_writer_begin(&s->writer, err));
    LAC_TRY(lac_nc_sync(&s->file, err));
    LAC_TRY(lac_nc_keep_journal(&s->file, err));
    LAC_TRY(lac_nc_publish(&s->file, err));
out:
    return status;
}

lac_status lac_history_store_create(const lac_history_store_def *def, lac_history_store **out,
                                    lac_error *err)
{
    lac_status status;
    *out = NULL;
    lac_history_store *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return lac_fail_memory(err);
    }
    s->keep = def->keep;
    s->now = (step){
        .area = lac_grid_area(def->grid), .friction = def->friction, .pressed = def->pressed};
    s->writer = (lac_writer){
        .file = &s->file, .dataset = def->contact, .deflate = 1, .chunk = CHUNK_STEPS, .batch = 1};
    LAC_TRY(describe(def, &s->now, err));
    LAC_TRY(begin_file(s, def, err));
    *out = s;
    s = NULL;
out:
    lac_history_store_free(s);
    return status;
}

static lac_status put(lac_history_store *store, lac_error *err)
{
    lac_status status = lac_writer_put(&store->writer, "step", err);
    return status == LAC_OK ? lac_writer_sync(&store->writer, err) : status;
}

// Where its maps come next both are written together: no step without its maps is left by a kill.
lac_status lac_history_store_step(lac_history_store *store, const lac_history_record *record,
                                  lac_error *err)
{
    store->now.record = *record;
    store->now.number++;
    return store->keep != LAC_KEEP_ALL ? put(store, err) : LAC_OK;
}

lac_status lac_history_store_maps(lac_history_store *store, const lac_history_maps *maps,
                                  lac_error *err)
{
    assert(store->keep != LAC_KEEP_NONE && store->now.number > 0);
    store->now.maps = *maps;
    if (store->keep == LAC_KEEP_ALL) {
        return put(store, err);
    }
    lac_status status = lac_writer_put_late(&store->writer, err);
    return status == LAC_OK ? lac_writer_sync(&store->writer, err) : status;
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
        lac_writer_clear(&store->writer);
        lac_nc_clear(&store->file);
        free(store);
    }
}
